"""Which grid of one set belongs to which of another."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

Pairing = Literal["auto", "name", "order"]


class Partners:
    """The grids of a reference set, handed out one by one.

    Parameters
    ----------
    grids : the set, read as far as is needed: a set in the same order as its partners passes through without
        being kept.
    pairing : by ``name``, by ``order``, or ``auto``: the only grid of a set goes with each; grids with names
        of their own are paired by name when the first partner's is among them; all others by order.
    """

    def __init__(self, grids: Iterator[Grid], pairing: Pairing = "auto") -> None:
        self._grids = grids
        self._pairing = pairing
        self._passed: list[Grid] = []

    def of(self, name: str) -> Grid:
        """Return the partner of the grid called `name`.

        Raises
        ------
        InputError
            there is none.
        """
        if self._pairing == "auto":
            self._pairing = self._decided(name)
        found = self._named(name) if self._pairing == "name" else self._following()
        if found is None:
            remedy = "compare with one grid, or with as many"
            if self._pairing == "name":
                remedy = f"compare with one that is called {name!r}, or use --pair order"
            raise InputError("there is no grid to compare it with", remedy)
        return found

    def _decided(self, name: str) -> Pairing:
        self._passed = [grid for _, grid in zip(range(2), self._grids, strict=False)]
        names = [grid.name for grid in self._passed]
        if len(names) == 1:
            self._grids = _again(self._passed.pop())
            return "order"
        if not all(names) or names[0] == names[1]:
            return "order"
        found = self._named(name)
        if found is None:
            return "order"
        self._passed.insert(0, found)
        return "name"

    def _following(self) -> Grid | None:
        return self._passed.pop(0) if self._passed else next(self._grids, None)

    def _named(self, name: str) -> Grid | None:
        for k, grid in enumerate(self._passed):
            if grid.name == name:
                return self._passed.pop(k)
        for grid in self._grids:
            if grid.name == name:
                return grid
            self._passed.append(grid)
        return None


def _again(grid: Grid) -> Iterator[Grid]:
    while True:
        yield grid
