"""Inputs expanded one by one: folders, zip archives, lists ``@FILE`` (docs/guide/datasets.md)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from meshonet.formats.archive import member_names
from meshonet.formats.registry import is_designation, names_many
from meshonet.formats.source import printable
from meshonet.formats.table import TABLE
from meshonet.geometry.errors import InputError, in_source

if TYPE_CHECKING:
    from meshonet.formats.inputs import Inputs

MOST_NESTED = 8  # largest depth of lists that name lists
LONGEST_LINE = 8192  # largest length of a line of a list, in bytes; a path has at most 4096
_WITH_FOLDER = (".h5", ".hdf5", ".vtm")  # extensions of files to which a folder of the same name belongs


def _readable_suffixes(*, grids_only: bool = False) -> frozenset[str]:
    """Return the extensions of files that are taken from folders and archives; pictures are not."""
    suffixes: set[str] = set()
    for record in TABLE.values():
        shapes = record.read_shapes is not None and not grids_only and record.name != "svg"
        if record.read_grids is not None or shapes:
            suffixes.update(record.suffixes)
    return frozenset(suffixes)


class Walk:
    """A search for files in the folders, archives and lists of files that a user named.

    In lists, empty lines and lines that begin with ``#`` are ignored. In folders, names that begin with a dot
    or ``__`` are ignored, and so is a folder such as ``out/`` beside a file ``out.h5``.
    """

    def __init__(self, inputs: Inputs) -> None:
        self._inputs, self._patterns = inputs, list(map(str.lower, inputs.pick))
        self._suffixes = inputs.suffixes or _readable_suffixes(grids_only=inputs.grids_only)
        self._seen = self._taken = 0
        self._example = ""

    def files(self) -> Iterator[str | InputError]:
        """Yield files, and errors for invalid inputs; if no file is picked, an error at the end says so."""
        yield from self._of(self._inputs.words)
        if self._patterns and not self._taken:
            pattern = " or ".join(map(printable, self._inputs.pick))
            files = f"{self._seen} files" if self._seen > 1 else "1 file"
            like = f"names are like {printable(self._example)!r}"
            remedy = f"{like}; quote the pattern, so that the shell leaves it"
            yield InputError(f"{pattern!r} matches none of {files}", remedy, parameter="pick")

    def _of(self, words: Iterable[str], lists: tuple[str, ...] = ()) -> Iterator[str | InputError]:
        for word in words:
            file = bool(lists) and _split(word)[1] in self._suffixes  # by its ending, in a list
            try:
                if word.startswith("@"):
                    yield from self._of_list(word[1:], lists)
                elif not file and names_many(word):
                    before = self._seen
                    yield from self._below(word, "") if Path(word).is_dir() else self._of_archive(word)
                    if self._seen == before:
                        known = " ".join(sorted(self._suffixes))
                        problem, place = "holds no file that can be read", printable(word)
                        raise InputError(problem, f"endings are {known}", source=place)
                elif not lists or self._takes(word.replace(":", "") if is_designation(word) else word):
                    yield word
            except InputError as error:
                yield error

    def _of_list(self, name: str, lists: tuple[str, ...]) -> Iterator[str | InputError]:
        if not name:
            raise InputError("names no list", "name a file: @list.txt", source="@")
        if name in lists or len(lists) == MOST_NESTED:
            raise InputError("lists name each other", "name files in them", source=f"@{printable(name)}")
        empty = True
        for entry in self._of(self._lines(name), (*lists, name)):
            empty = False
            yield entry
        if empty and not self._patterns:
            raise InputError("holds no inputs", "write one a line", source=f"@{printable(name)}")

    def _lines(self, name: str) -> Iterator[str]:
        if name == "-":
            yield from _lines(self._inputs.stdin.splitlines(keepends=True), name)
            return
        try:
            with Path(name).open("rb") as stream:
                yield from _lines(iter(lambda: stream.readline(LONGEST_LINE), b""), name)
        except OSError as error:
            raise _unreadable(name, error, "check the path of the list") from error

    def _below(self, folder: str, inside: str) -> Iterator[str | InputError]:
        """Yield the files of `folder` and its folders; `inside` is its path below the one that was named."""
        try:
            entries = self._entries(folder, inside)
        except OSError as error:
            yield _unreadable(folder, error, "check its permissions")
            return
        for name in entries:
            if name.endswith("/"):
                yield from self._below(str(Path(folder, name)), f"{inside}{name}")
            else:
                yield str(Path(folder, name))

    def _entries(self, folder: str, inside: str) -> list[str]:
        """Return the names of files to take and, with a slash behind them, of folders to look into."""
        names: list[str] = []
        owners: set[str] = set()
        with os.scandir(folder) as entries:
            for entry in entries:
                stem, suffix = _split(entry.name)
                if _is_hidden(entry.name):
                    continue
                if entry.is_dir(follow_symlinks=False):
                    names.append(f"{entry.name}/")
                elif suffix in self._suffixes and entry.is_file():
                    if suffix in _WITH_FOLDER:
                        owners.add(f"{stem}/")
                    if self._takes(f"{inside}{entry.name}"):
                        names.append(entry.name)
        return sorted(name for name in names if name not in owners)

    def _of_archive(self, path: str) -> Iterator[str]:
        with in_source(printable(path)):
            names = member_names(path)
        for name in names:
            hidden = any(map(_is_hidden, name.split("/")))
            if not hidden and _split(name)[1] in self._suffixes and self._takes(name):
                yield f"{path}/{name}"

    def _takes(self, path: str) -> bool:
        """Note a file of a folder, an archive or a list, and return whether it is picked."""
        self._seen += 1
        name = path.rpartition("/")[2]
        stem = _split(name)[0]
        self._example = self._example or stem
        taken = not self._patterns or any(
            fnmatchcase(text.lower(), pattern)
            for pattern in self._patterns
            for text in ((path, _split(path)[0]) if "/" in pattern else (stem, name))
        )
        self._taken += taken
        return taken


def _split(path: str) -> tuple[str, str]:
    """Return a path without its ending, and the ending in lower case."""
    suffix = PurePath(path).suffix
    return path.removesuffix(suffix), suffix.lower()


def _is_hidden(name: str) -> bool:
    return name.startswith((".", "__"))


def _lines(lines: Iterable[bytes], name: str) -> Iterator[str]:
    for number, line in enumerate(lines, start=1):
        if len(line) >= LONGEST_LINE or b"\0" in line:
            remedy = "a list is text, one input a line"
            raise InputError(
                "is no list of inputs", remedy, source=f"@{printable(name)}", place=f"line {number}"
            )
        text = os.fsdecode(line.removeprefix(b"\xef\xbb\xbf") if number == 1 else line).strip()
        if text and not text.startswith("#"):
            yield text


def _unreadable(name: str, error: OSError, remedy: str) -> InputError:
    return InputError(f"cannot be read ({error.strerror or error})", remedy, source=printable(name))
