"""Inputs as the user named them, which may be files, designations, or words that stand for many files."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple

from meshonet.formats.registry import names_many
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.formats.hdf5.read import DatasetSamples

_BEGINNING = 10_001  # number of inputs at which counting before the work ends
_IS_DATASET = re.compile(r"\.(?:h5|hdf5)(?:#[a-z0-9,:]+)?$", re.IGNORECASE)


class Numbered(NamedTuple):
    """An input, and the numbers of its members (shapes or grids) among the members of all inputs.

    `first` is the number of its first member; None: members are numbered as they are read. `step` is the
    difference between successive numbers, 0 for a single member.
    """

    text: str | InputError
    first: int | None = None
    step: int = 1


@dataclass(frozen=True)
class Inputs:
    """Inputs as the user named them; iteration yields the files they stand for, or InputError objects.

    Parameters
    ----------
    words : files, folders, zip archives, lists (``@FILE``), shapes (``naca:2412``); ``-``: standard input.
    suffixes : extensions of files taken from folders and archives; empty: all that can be read.
    pick : patterns (``naca*``) for file names in folders, archives and lists; upper and lower case are equal
        and the extension may be left out. A pattern with a ``/`` is compared with the whole path.
    shard : (k, n): share k of n of the work. The method `own` yields inputs k, k + n, k + 2 n, ...; `parts`
        yields every n-th group of inputs. Iteration yields all inputs.
    grids_only : whether only files with grids are taken from folders and archives.

    Raises InputError if standard input occurs twice or is a terminal, if the shard is invalid, or if patterns
    are given without a folder, archive or list.
    """

    words: tuple[str, ...]
    suffixes: frozenset[str] = frozenset()
    pick: tuple[str, ...] = ()
    shard: tuple[int, int] = (1, 1)
    grids_only: bool = False

    def __post_init__(self) -> None:
        streams = list(filter(("-", "@-").__contains__, self.words))
        if len(streams) > 1:
            raise InputError("standard input is named twice", "name - once", source="-")
        if streams and sys.stdin.isatty():
            what = "a list of inputs" if streams == ["@-"] else "a boundary or a grid"
            raise InputError("standard input is the terminal", f"pipe {what} into it", source=streams[0])

        if self.pick and not any(map(names_many, self.words)):
            remedy = "name a folder, a .zip file or a list, or leave it out"
            raise InputError("there is nothing to pick from", remedy, parameter="pick")
        k, n = self.shard
        if not 1 <= k <= n:
            raise InputError(f"there is no shard {k} of {n}", "use K/N with K from 1 to N", parameter="shard")

    def __iter__(self) -> Iterator[str | InputError]:
        if not any(map(names_many, self.words)):
            yield from self.words
            return
        from meshonet.formats.walk import Walk  # which inputs that are files do not need

        yield from Walk(self).files()

    def own(self) -> Iterator[Numbered]:
        """Yield the inputs of the shard (each n-th input); each sample of a dataset counts as an input."""
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
        """Yield number and inputs of each part of the shard; `size` inputs or dataset samples form a part.

        Parts of all inputs are numbered, and shard k of n has every n-th part: shards do not change parts.
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
        """Return whether there are more than `count` inputs."""
        return (self._begun if count < _BEGINNING else sum(1 for _ in islice(self, count + 1))) > count

    @cached_property
    def _begun(self) -> int:
        """Number of inputs; counting stops at 10001."""
        return len(list(islice(self, _BEGINNING)))

    def count(self) -> int | None:
        """Return the number of all inputs, divided by n of `shard` and rounded up; None with standard input.

        Each sample of a dataset counts as an input.
        """
        if any(word in ("-", "@-") for word in self.words):
            return None
        return -(-sum(count for _, _, count in self._counted()) // self.shard[1])

    def _counted(self) -> Iterator[tuple[str | InputError, DatasetSamples | None, int]]:
        """Yield each input with its samples, if it is a dataset, and how many members it has."""
        for entry in self:
            samples = samples_in(entry)
            yield entry, samples, 1 if samples is None else len(samples)

    def first(self) -> str:
        """Return the first input. Raises InputError if it is invalid."""
        first = next(iter(self))
        if isinstance(first, InputError):
            raise first
        return first

    @cached_property
    def stdin(self) -> bytes:
        """Content of standard input, which is read only once."""
        return sys.stdin.buffer.read()


def is_dataset(entry: str) -> bool:
    """Return whether an input is, by its name, a dataset or samples of a dataset.

    >>> is_dataset("wings.h5#0:3"), is_dataset("wing.dat")
    (True, False)
    """
    return _IS_DATASET.search(entry) is not None


def samples_in(entry: str | InputError) -> DatasetSamples | None:
    """Return the samples of an input that is a dataset; None if it is something else or unreadable."""
    if isinstance(entry, InputError) or not is_dataset(entry):
        return None
    from meshonet.formats.hdf5.read import samples_of

    try:
        return samples_of(entry)
    except InputError:  # which is said when it is read
        return None
