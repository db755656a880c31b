"""Compares a smoothed volume grid with the given one."""

from dataclasses import dataclass
from typing import Self

from meshonet.geometry.arrays import Bools
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.volumes import measure_volumes, solid_metric
from meshonet.geometry.volume.hex_mesh import HexMesh

_SLACK = 1e-9  # tolerance for rounding in degrees
_NOTHING = 0.05  # mean deviation below which differences are ignored
_GOOD, _PART = 0.7, 0.98
"""Scaled Jacobian above which differences are ignored, and the fraction of a smaller one that must remain."""


@dataclass(frozen=True)
class VolumeMeasures:
    """Quality measures of a volume grid that must not become worse."""

    folded: int
    mean: float  # mean over all cells of the deviation of their angles from 90 degrees
    least: float  # smallest scaled Jacobian of a corner

    def no_worse(self, than: Self) -> bool:
        """Return whether no measure is worse than the same measure in `than`, except negligibly."""
        if than.folded or self.folded:
            return self.folded < than.folded
        return self.mean <= max(than.mean + _SLACK, _NOTHING) and self.least >= than.bound

    @property
    def bound(self) -> float:
        """Scaled Jacobian below which another mesh counts as worse than this mesh."""
        return min(_PART * self.least, _GOOD)


def measures(mesh: HexMesh) -> VolumeMeasures:
    """Return the quality measures of a mesh."""
    quality = measure_volumes(_grid(mesh))
    metrics = quality.metrics
    return VolumeMeasures(quality.folded, metrics["deviation"].mean, metrics["scaled_jacobian"].min)


def cells_below(mesh: HexMesh, bound: float) -> list[Bools]:
    """Return for each block a mask of cells whose scaled Jacobian is below `bound`; 0 finds folded cells."""
    scaled = solid_metric(_grid(mesh), "scaled_jacobian")
    return [least < bound if bound > 0 else least <= 0.0 for least in scaled]


def _grid(mesh: HexMesh) -> Grid:
    return Grid(tuple(Block(mesh.nodes[block], finite=True) for block in mesh.blocks))
