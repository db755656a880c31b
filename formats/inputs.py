"""Lazy expansion of inputs to files: those in folders, members of zip archives, lines of lists.

=============  =====================================================================================
input          stands for
=============  =====================================================================================
``@FILE``      the inputs in its lines, each as on the command line; ``@-`` reads standard input
a folder       all files with a recognised extension in it and its subfolders, sorted by name
``FILE.zip``   its files with a recognised extension, sorted by name: ``FILE.zip/wing/naca0012.dat``
anything else  itself
=============  =====================================================================================

Skipped are empty lines of lists and those that start with ``#``; in folders and archives, names that start
with a dot or ``__``, and folders that belong to a file next to them, as ``out/`` to ``out.h5``.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from itertools import islice
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, NamedTuple

from meshonet.formats.archive import is_archive, member_names
from meshonet.formats.registry import formats, is_designation
from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError, in_source

if TYPE_CHECKING:
    from meshonet.formats.hdf5.read import DatasetSamples

MOST_NESTED = 8
"""Largest depth of lists that name lists."""
LONGEST_LINE = 8192
"""Bytes; a path has at most 4096."""
_BEGINNING = 10_001
"""Inputs that are counted before work begins."""
_IS_DATASET = re.compile(r"\.(?:h5|hdf5)(?:#[a-z0-9,:]+)?$", re.IGNORECASE)
_WITH_FOLDER = (".h5", ".hdf5", ".vtm")
"""Extensions of files to which a folder of the same name belongs."""


def readable_suffixes(*, grids_only: bool = False) -> frozenset[str]:
    """Return the extensions of files that are taken from folders and archives; pictures are not."""
    suffixes: set[str] = set()
    for record in formats():
        shapes = record.read_shapes is not None and not grids_only and record.name != "svg"
        if record.read_grids is not None or shapes:
            suffixes.update(record.suffixes)
    return frozenset(suffixes)


class Numbered(NamedTuple):
    """An input, the number of its first member among those of all inputs, and the step between its members.

    Without a number the members are counted; a step of 0 stands for a single member.
    """

    text: str | InputError
    first: int | None = None
    step: int = 1


@dataclass(frozen=True)
class Inputs:
    """Inputs as the user named them; iterating yields the files that they stand for, or errors.

    Parameters
    ----------
    words : the inputs.
    suffixes : endings of files that are taken from folders and archives.
    pick : patterns (``naca*``). Files in folders, archives and lists are used only if their name, with or
        without extension, matches one of them; a pattern with a ``/`` is compared with the path. Case is
        ignored.
    shard : (k, n): `own` and `parts` yield only every n-th input, starting with the k-th, counted from 1.

    Raises InputError: standard input is named twice, or is a terminal; an invalid shard; patterns without a
    folder, archive or list to pick from.
    """

    words: tuple[str, ...]
    suffixes: frozenset[str] = frozenset()
    pick: tuple[str, ...] = ()
    shard: tuple[int, int] = (1, 1)

    def __post_init__(self) -> None:
        streams = list(filter(("-", "@-").__contains__, self.words))
        if len(streams) > 1:
            raise InputError("standard input is named twice", "name - once", source="-")
        if streams and sys.stdin.isatty():
            what = "a list of inputs" if streams == ["@-"] else "a boundary or a grid"
            raise InputError("standard input is the terminal", f"pipe {what} into it", source=streams[0])

        if self.pick and not any(map(_stands_for_many, self.words)):
            remedy = "name a folder, a .zip file or a list, or leave it out"
            raise InputError("there is nothing to pick from", remedy, parameter="pick")
        k, n = self.shard
        if not 1 <= k <= n:
            raise InputError(f"there is no shard {k} of {n}", "use K/N with K from 1 to N", parameter="shard")

    def __iter__(self) -> Iterator[str | InputError]:
        walk = _Walk(self)
        yield from walk.of(self.words)
        if self.pick and not walk.taken:
            pattern = " or ".join(printable(pattern) for pattern in self.pick)
            files = f"{walk.seen} files" if walk.seen > 1 else "1 file"
            like = f"names are like {printable(walk.example)!r}"
            remedy = f"{like}; quote the pattern, so that the shell leaves it"
            yield InputError(f"{pattern!r} matches none of {files}", remedy, parameter="pick")

    def own(self) -> Iterator[Numbered]:
        """Yield the inputs of the shard; of a dataset every n-th sample is taken."""
        k, n = self.shard
        if n == 1:
            yield from map(Numbered, self)
            return
        number = 0
        for entry, samples, count in self._counted():
            first = (k - 1 - number) % n
            if first < count and samples is None:
                yield Numbered(entry, number, 0)
            elif first < count and samples is not None:
                yield Numbered(samples.named(first, count, n), number + first, n)
            number += count

    def parts(self, size: int) -> Iterator[tuple[int, tuple[str | InputError, ...]]]:
        """Yield number and inputs of the parts of the shard, `size` inputs or samples of datasets each.

        Parts are the same whatever the shard: the k-th of n has every n-th part.
        """
        number, left = 0, size
        entries: list[str | InputError] = []
        k, n = self.shard

        for entry, samples, count in self._counted():
            start = 0
            while start < count:
                stop = min(start + left, count)
                entries.append(entry if samples is None else samples.named(start, stop))
                start, left = stop, left - (stop - start)
                if not left:
                    if number % n == k - 1:
                        yield number, tuple(entries)
                    number, left, entries = number + 1, size, []
        if entries and number % n == k - 1:
            yield number, tuple(entries)

    def more_than(self, count: int) -> bool:
        """Return whether there are more than `count` inputs; the search stops there."""
        return (self._begun if count < _BEGINNING else sum(1 for _ in islice(self, count + 1))) > count

    @cached_property
    def _begun(self) -> int:
        """Number of inputs; counting stops at `_BEGINNING`."""
        return len(list(islice(self, _BEGINNING)))

    def count(self) -> int | None:
        """Return the number of members of the shard; files count once, datasets by samples; None: a pipe."""
        if any(word in ("-", "@-") for word in self.words):
            return None
        return -(-sum(count for _, _, count in self._counted()) // self.shard[1])

    def _counted(self) -> Iterator[tuple[str | InputError, DatasetSamples | None, int]]:
        """Yield each input with its samples, if it is a dataset, and how many members it has."""
        for entry in self:
            samples = samples_in(entry)
            yield entry, samples, 1 if samples is None else len(samples)

    def first(self) -> str:
        """Return the first input. Raises InputError: there is none."""
        first = next(iter(self))
        if isinstance(first, InputError):
            raise first
        return first

    @cached_property
    def _stdin(self) -> bytes:
        return sys.stdin.buffer.read()

    def lines(self, name: str) -> Iterator[str]:
        """Yield the inputs in the lines of the list `name`; InputError where it is none."""
        if name == "-":
            yield from _lines(self._stdin.splitlines(keepends=True), name)
            return
        try:
            with Path(name).open("rb") as stream:
                yield from _lines(iter(lambda: stream.readline(LONGEST_LINE), b""), name)
        except OSError as error:
            raise _unreadable(name, error, "check the path of the list") from error


class _Walk:
    """One walk through inputs, with the counts of files found in folders, archives and lists, and picked."""

    def __init__(self, inputs: Inputs) -> None:
        self._inputs = inputs
        self._patterns = list(map(str.lower, inputs.pick))
        self.seen = self.taken = 0
        self.example = ""

    def of(self, words: Iterable[str], lists: tuple[str, ...] = ()) -> Iterator[str | InputError]:
        for word in words:
            file = bool(lists) and _split(word)[1] in self._inputs.suffixes  # by its ending, in a list
            try:
                if word.startswith("@"):
                    yield from self._of_list(word[1:], lists)
                elif not file and _stands_for_many(word):
                    before = self.seen
                    yield from self._of_archive(word) if is_archive(word) else self._below(word, "")
                    if self.seen == before:
                        known = " ".join(sorted(self._inputs.suffixes))
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
        for entry in self.of(self._inputs.lines(name), (*lists, name)):
            empty = False
            yield entry
        if empty and not self._patterns:
            raise InputError("holds no inputs", "write one a line", source=f"@{printable(name)}")

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
                elif suffix in self._inputs.suffixes and entry.is_file():
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
            if not hidden and _split(name)[1] in self._inputs.suffixes and self._takes(name):
                yield f"{path}/{name}"

    def _takes(self, path: str) -> bool:
        """Note a file of a folder, an archive or a list, and return whether it is picked."""
        self.seen += 1
        name = path.rpartition("/")[2]
        stem = _split(name)[0]
        self.example = self.example or stem
        taken = not self._patterns or any(
            fnmatchcase(text.lower(), pattern)
            for pattern in self._patterns
            for text in ((path, _split(path)[0]) if "/" in pattern else (stem, name))
        )
        self.taken += taken
        return taken


def samples_in(entry: str | InputError) -> DatasetSamples | None:
    """Return the samples of an input that is a dataset, None for any other and one that cannot be read."""
    if isinstance(entry, InputError) or not _IS_DATASET.search(entry):
        return None
    from meshonet.formats.hdf5.read import samples_of

    try:
        return samples_of(entry)
    except InputError:  # which is said when it is read
        return None


def _split(path: str) -> tuple[str, str]:
    """Return a path without its ending, and the ending in lower case."""
    suffix = PurePath(path).suffix
    return path.removesuffix(suffix), suffix.lower()


def _is_hidden(name: str) -> bool:
    return name.startswith((".", "__"))


def _stands_for_many(word: str) -> bool:
    return word.startswith("@") or is_archive(word) or (not is_designation(word) and Path(word).is_dir())


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
