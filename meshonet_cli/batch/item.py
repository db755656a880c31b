"""A member of a batch, its names in messages and files, and its result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar

from meshonet.formats.source import printable

if TYPE_CHECKING:
    from meshonet_cli.report.timed import Timed


T = TypeVar("T")
V = TypeVar("V")
NO_NUMBER = -1  # index of a member of a shard if the number of members before it is unknown


@dataclass(frozen=True)
class Item(Generic[T]):
    """A member of a batch: a shape, a grid, or the error of an unreadable one."""

    index: int  # counted from 0 over all inputs, or NO_NUMBER
    source: str  # the input as the user wrote it
    what: T  # the shape or grid, or the error that stands for one that cannot be read
    seconds: float  # spent on reading it
    name: str = ""  # what the input calls it
    only: bool = True  # whether its source holds nothing else
    called: str = ""  # its stem, where it comes from several files
    path: str = ""  # of its own file, where it has one

    def without_content(self) -> Item[None]:
        """Return this member without its shape or grid, to send it to another process."""
        return replace(self, what=None)  # type: ignore[arg-type, return-value]

    @property
    def label(self) -> str:
        """Name of this shape or grid in messages: its input, and its own name if the input has several."""
        source = "stdin" if self.source == "-" else printable(self.source)
        return source if self.only else f"{source}[{self.name or self.index}]"

    @property
    def stem(self) -> str:
        """File name of the input without folder and extension."""
        return self.called or stem_of(self.source)


def stem_of(source: str) -> str:
    """Return the file name of an input without folder and extension.

    >>> stem_of("wings/root.dat"), stem_of("naca:2412"), stem_of("wings.zip/root.dat")
    ('root', 'naca2412', 'root')
    """
    return "stdin" if source == "-" else Path(source).stem.replace(":", "")


Outcome: TypeAlias = "tuple[Any, Timed] | Exception"  # a result to write and its report, or an error
Pair: TypeAlias = tuple[Item[Any], Outcome]  # a member and its result
Make: TypeAlias = Callable[[Iterable[Item[Any]]], Iterator[Pair]]
"""Computes results of members in order; must be picklable to run in other processes."""


def attempted(make: Callable[[T], V], each: Iterable[T]) -> Iterator[tuple[T, V | Exception]]:
    """Yield each element with the result of `make` for it, or with its error."""
    for one in each:
        try:
            yield one, make(one)
        except Exception as error:
            yield one, error


def made(outcome: V | Exception) -> V:
    """Return a result; if it is an error, raise it."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome
