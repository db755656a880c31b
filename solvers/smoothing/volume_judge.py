"""Whether a smoothed grid of volumes is no worse than the one that was given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.volumes import measure_volumes, solid_metric
from meshonet.geometry.volume.hex_mesh import HexMesh

_SLACK = 1e-9
"""Degrees that rounding may add."""
_NOTHING = 0.05
"""Mean deviation up to which one is as good as the other."""
_GOOD, _PART = 0.7, 0.98
"""Scaled Jacobian from which on one is as good as the other, and the part of a smaller one to be left."""


@dataclass(frozen=True)
class VolumeMeasures:
    """Folded cells and what must not become worse."""

    folded: int
    mean: float
    """Mean over all cells of the deviation of their angles from 90 degrees."""
    least: float
    """Least scaled Jacobian of a corner."""

    def no_worse(self, than: VolumeMeasures) -> bool:
        """Say whether no figure is worse."""
        if than.folded or self.folded:
            return self.folded < than.folded
        return self.mean <= max(than.mean + _SLACK, _NOTHING) and self.least >= than.bound

    @property
    def bound(self) -> float:
        """Scaled Jacobian that another mesh has to have at least to be no worse."""
        return min(_PART * self.least, _GOOD)


def measures(mesh: HexMesh) -> VolumeMeasures:
    """Return the measures of a mesh."""
    quality = measure_volumes(_grid(mesh))
    metrics = quality.metrics
    return VolumeMeasures(quality.folded, metrics["deviation"].mean, metrics["scaled_jacobian"].min)


def cells_below(mesh: HexMesh, bound: float) -> list[NDArray[np.bool_]]:
    """Say of each cell of each block whether its scaled Jacobian is below a bound; at 0, if it is folded."""
    scaled = solid_metric(_grid(mesh), "scaled_jacobian")
    return [least < bound if bound > 0 else least <= 0.0 for least in scaled]


def _grid(mesh: HexMesh) -> Grid:
    return Grid(tuple(Block(mesh.nodes[block], finite=True) for block in mesh.blocks))
