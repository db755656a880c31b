"""One member of a batch, with the names that messages and files have for it, and what comes of it."""

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
NO_NUMBER = -1
"""Index of a member of a shard, of which it is not known how many members come before it."""


@dataclass(frozen=True)
class Item(Generic[T]):
    """One member of a batch."""

    index: int  # counted from 0 over all inputs, or NO_NUMBER
    source: str  # the input as the user wrote it
    what: T  # the shape or grid, or the error that stands for one that cannot be read
    seconds: float  # spent on reading it
    name: str = ""  # what the input calls it
    only: bool = True  # whether its source holds nothing else
    called: str = ""  # its stem, where it comes from several files
    path: str = ""  # of its own file, where it has one

    def without_content(self) -> Item[None]:
        """Return the same member without what it holds, to be sent to another process."""
        return replace(self, what=None)  # type: ignore[arg-type, return-value]

    @property
    def label(self) -> str:
        """How messages call it."""
        source = "stdin" if self.source == "-" else printable(self.source)
        return source if self.only else f"{source}[{self.name or self.index}]"

    @property
    def stem(self) -> str:
        """The input's file name without folder and ending."""
        return self.called or stem_of(self.source)


def stem_of(source: str) -> str:
    """Return the file name of an input without folder and ending.

    >>> stem_of("wings/root.dat"), stem_of("naca:2412"), stem_of("wings.zip/root.dat")
    ('root', 'naca2412', 'root')
    """
    return "stdin" if source == "-" else Path(source).stem.replace(":", "")


Outcome: TypeAlias = "tuple[Any, Timed] | Exception"
"""What to write of a member and its report, or the error that it ended in."""
Pair: TypeAlias = tuple[Item[Any], Outcome]
"""A member and what comes of it."""
Make: TypeAlias = Callable[[Iterable[Item[Any]]], Iterator[Pair]]
"""Makes members in order; what other processes are to do can be pickled."""


def attempted(make: Callable[[T], V], each: Iterable[T]) -> Iterator[tuple[T, V | Exception]]:
    """Yield each with what `make` makes of it, or the error that it ended in."""
    for one in each:
        try:
            yield one, make(one)
        except Exception as error:
            yield one, error


def made(outcome: V | Exception) -> V:
    """Return what was made, or raise the error that it ended in."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome
