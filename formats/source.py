"""Sources of bytes: a file, standard input or memory, with the name that the user gave."""

import io
import itertools
import mmap
import re
import stat
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, BinaryIO

from meshonet.geometry.errors import InputError, in_source, meant

HEAD_BYTES = 65536  # number of bytes by which a format recognises its files
_SELECTION = re.compile(
    r"(?P<split>train|test)|(?:(?P<kind>train|test),)?(?:(?P<number>\d{1,15})|(?P<range>\d{0,15}:\d{0,15}(?::[1-9]\d{0,14})?))"
)
"""Text after ``#``: a split, a number, a range, or a split with one of these."""
_MOST_NAMES = 10_000  # largest number of file names that are compared to suggest one
_LIKENESS = 0.75  # smallest similarity of a suggested file name; names share their extensions
_MAPPED = 1 << 24  # size in bytes above which a file is mapped into memory instead of read
_MOST_TEXT = 1 << 24  # largest text file in bytes; more is a mistake, such as an outline of a million points
_MOST_PIPED = 1 << 31  # largest stream in bytes, which is kept in memory
LARGEST = 1e150  # bound of coordinates in files, so that areas and their sums are finite


@dataclass(frozen=True)
class Source:
    """A named file or sequence of bytes; either `path` or `data` is set.

    Parameters
    ----------
    name : printable name for messages.
    path : path of a regular file.
    data : the bytes themselves, for standard input, pipes and tests.
    split : split of a dataset to read, ``train`` or ``test``; empty for all samples.
    rows : selection among the samples of the split; None for all.
    """

    name: str
    path: Path | None = None
    data: bytes | None = None
    split: str = ""
    rows: slice | None = None

    @property
    def stem(self) -> str:
        """File name without folder and extension; also the name of a shape that has none in the file."""
        if self.path:
            return printable(self.path.stem)
        return "stdin" if self.name == "-" else Path(self.name).stem

    @property
    def suffix(self) -> str:
        """Extension in lower case with its dot; empty if there is none."""
        return (self.path or Path(self.name)).suffix.lower()

    @property
    def size(self) -> int:
        """Length in bytes."""
        with self.open() as stream:
            return stream.seek(0, io.SEEK_END)

    def read_bytes(self) -> bytes:
        """Return all bytes."""
        return self.data if self.data is not None else self.head(-1)

    def bytes_below(self, most: int, kind: str) -> bytes:
        """Return all bytes. Raises InputError, with the `kind` of file, if there are more than `most`."""
        if self.size > most:
            problem = f"{self.size >> 20} MB are too much for {kind}"
            raise InputError(problem, f"give a file below {most >> 20} MB", source=self.name)
        return self.read_bytes()

    def text_bytes(self) -> bytes:
        """Return all bytes of a text file. Raises InputError if it is larger than 16 MB."""
        data = self.head(_MOST_TEXT + 1)
        if len(data) > _MOST_TEXT:
            problem = f"{self.size >> 20} MB are too much for a text of points"
            raise InputError(problem, f"give a file below {_MOST_TEXT >> 20} MB", source=self.name)
        return data

    def buffer(self) -> bytes | mmap.mmap:
        """Return all bytes; a large file is mapped into memory instead of being read."""
        if self.data is not None or self.size < _MAPPED:
            return self.read_bytes()
        with self.open() as stream:
            return mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)

    def open(self) -> BinaryIO:
        """Return a seekable binary stream, which the caller must close."""
        if self.data is not None:
            return io.BytesIO(self.data)
        if self.path is None:
            raise InputError("has neither a path nor data", "give one of them", source=self.name)
        return self.path.open("rb")

    def head(self, count: int = HEAD_BYTES) -> bytes:
        """Return the first `count` bytes, or all bytes if `count` is negative."""
        with self.open() as stream:
            return stream.read(count)


def open_source(text: str) -> Source:
    """Return the source called `text`: a path, ``-`` for standard input, or ``FILE.zip/MEMBER``.

    Of a dataset, ``FILE#test`` or ``FILE#train`` selects a split, ``FILE#7`` a sample (counted from 0),
    ``FILE#5:9`` or ``FILE#5::2`` a range, and ``FILE#test,0:9`` a range of a split. A file with the whole
    text as its name is preferred. Raises InputError if the file does not exist, is a folder, is unreadable or
    is empty.
    """
    split, rows = "", None
    if "#" in text:
        text, split, rows = _selected(text)
    try:
        source = replace(_opened(text), split=split, rows=rows)
    except FileNotFoundError:
        raise _missing(text) from None
    except PermissionError:
        raise InputError("may not be read", "check its permissions", source=printable(text)) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"cannot be opened ({reason})", "check the path", source=printable(text)) from None
    if source.data == b"" or (source.path and not source.path.stat().st_size):
        raise InputError("is empty", "give a file with a boundary or a grid in it", source=source.name)
    return source


def printable(text: str) -> str:
    r"""Return `text` with control characters and undecodable bytes replaced by escapes, safe for terminals.

    Examples
    --------
    >>> print(printable("a\x1b[31m.dat"))
    a\x1b[31m.dat
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def reason_of(error: Exception) -> str:
    """Return the first line of an error's message, or its type if there is none, safe for terminals."""
    return printable(str(error).split("\n")[0])[:100] or type(error).__name__


def _selected(text: str) -> tuple[str, str, slice | None]:
    name, mark, words = text.rpartition("#")
    match = _SELECTION.fullmatch(words)
    if not (mark and name and match) or Path(text).exists():
        return text, "", None
    rows: slice[Any, Any, Any] | None = None
    if match["number"]:
        rows = slice(int(match["number"]), int(match["number"]) + 1)
    elif match["range"]:
        rows = slice(*[int(word) if word else None for word in match["range"].split(":")])
    return name, match["split"] or match["kind"] or "", rows


def _missing(text: str) -> InputError:
    name, mark, kept = text.rpartition("#")
    if not (mark and Path(name).is_file()):
        return InputError("no such file", nearest(Path(text)) or "check the path", source=printable(text))
    problem = f"no such file, and of {printable(name)} there is only #train, #test, #7 or #5:9"
    return InputError(problem, f"leave #{printable(kept)} out", source=printable(text))


def nearest(path: Path) -> str:
    """Return ``did you mean ...?`` with the most similar file name in the folder, or an empty text."""
    try:
        names = [entry.name for entry in itertools.islice(path.parent.iterdir(), _MOST_NAMES)]
    except (OSError, ValueError):
        return ""
    return printable(meant(path.name, names, _LIKENESS).rstrip())


def _opened(text: str) -> Source:
    if text == "-":
        return Source("-", data=_piped(sys.stdin.buffer, "-"))
    path = Path(text)
    try:
        mode = path.stat().st_mode
    except NotADirectoryError:
        from meshonet.formats.archive import read_member, split_member  # which few files need

        member = split_member(text)
        if member is None:
            raise
        with in_source(printable(text)):
            return Source(printable(text), data=read_member(*member))
    if stat.S_ISDIR(mode):
        raise InputError("is a folder", "name a file in it", source=printable(text))
    if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
        raise InputError("is a device", "name a file, or - for standard input", source=printable(text))
    with path.open("rb") as stream:
        if stat.S_ISREG(mode):
            return Source(printable(text), path=path)
        return Source(printable(text), data=_piped(stream, printable(text)))


def _piped(stream: BinaryIO, name: str) -> bytes:
    data = stream.read(_MOST_PIPED + 1)
    if len(data) > _MOST_PIPED:
        problem = f"is a stream of more than {_MOST_PIPED >> 30} GB"
        raise InputError(problem, "write it to a file and name that", source=name)
    return data
