"""One member of a batch, with the names that messages and files have for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from meshonet.formats.source import printable


class Named(Protocol):
    """What inputs hold: shapes and grids have names."""

    @property
    def name(self) -> str:
        """What the input calls it."""
        ...


@dataclass(frozen=True)
class Name:
    """A name that stands for the thing."""

    name: str


@dataclass(frozen=True)
class Unreadable:
    """Stands for a member that cannot be read."""

    error: Exception
    name: str = ""


T = TypeVar("T", bound=Named)
NO_NUMBER = -1
"""Index of a member of a shard, of which it is not known how many members come before it."""


@dataclass(frozen=True)
class Item(Generic[T]):
    """One member of a batch."""

    index: int  # counted from 0 over all inputs, or NO_NUMBER
    source: str  # the input as the user wrote it
    what: T  # the shape or grid
    seconds: float  # spent on reading it
    only: bool = True  # whether its source holds nothing else
    called: str = ""  # its stem, where it comes from several files

    def without_content(self) -> Item[Name]:
        """Return the same member with nothing but the name of what it holds."""
        return Item(self.index, self.source, Name(self.what.name), self.seconds, self.only, self.called)

    @property
    def label(self) -> str:
        """How messages call it."""
        source = "stdin" if self.source == "-" else printable(self.source)
        return source if self.only else f"{source}[{self.what.name or self.index}]"

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
