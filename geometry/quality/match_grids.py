"""Pairs of grids of one set with those of a reference set."""

from collections.abc import Iterator
from itertools import repeat
from typing import Literal, TypeAlias

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

Pairing: TypeAlias = Literal["auto", "name", "order"]


class GridMatcher:
    """Finds, for each grid, the grid of a reference set with which it is compared.

    Pairing is by ``name`` or by ``order``. With ``auto``, a single reference serves all grids. Several are
    paired by name if the first two references differ in name and any reference has the name of the first
    grid, else by order. `references` is read only as far as needed.
    """

    def __init__(self, references: Iterator[Grid], pairing: Pairing = "auto") -> None:
        self._grids = references
        self._pairing = pairing
        self._passed: list[Grid] = []

    def match(self, name: str) -> Grid:
        """Return the reference for the next grid, whose name is `name`. Raises InputError: there is none."""
        if self._pairing == "auto":
            self._pairing = self._decided(name)
        if self._pairing == "name":
            grid = self._named(name)
        else:
            grid = self._passed.pop(0) if self._passed else next(self._grids, None)
        if grid is None:
            remedy = "compare with one grid, or with as many"
            if self._pairing == "name":
                remedy = f"compare with one that is called {name!r}, or use {{pair}} order"
            raise InputError("there is no grid to compare it with", remedy)
        return grid

    def _decided(self, name: str) -> Pairing:
        self._passed = [grid for _, grid in zip(range(2), self._grids, strict=False)]
        names = [grid.name for grid in self._passed]
        if len(names) == 1:
            self._grids = repeat(self._passed.pop())
            return "order"
        if not all(names) or names[0] == names[1]:
            return "order"
        match = self._named(name)
        if match is None:
            return "order"
        self._passed.insert(0, match)
        return "name"

    def _named(self, name: str) -> Grid | None:
        for k, grid in enumerate(self._passed):
            if grid.name == name:
                return self._passed.pop(k)
        for grid in self._grids:
            if grid.name == name:
                return grid
            self._passed.append(grid)
        return None
