"""The figures of a grid by name, with their places, as gates and profiles judge them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of, norms
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.quality.blocks import BlockFigures, block_figures
from meshonet.geometry.quality.checkmesh import FaceMeasures, faces
from meshonet.geometry.quality.growth import Extreme, Growth, growth, growth_off_walls, most_of
from meshonet.geometry.quality.metrics import FACE_NAMES, metrics_of
from meshonet.geometry.quality.walls import WallRow, wall_rows
from meshonet.geometry.summary import Quality, named

COUNTS = ("folded", "bezier_folded")
"""Names of the counts of folded cells: by corner Jacobians, and by the Bezier test of volumes."""
FIGURES: Mapping[str, str] = MappingProxyType({
    "growth": "greatest ratio of neighbouring steps along all directions of grid lines, sides of blocks too",
    "wall_growth": "the same along the lines that leave walls",
    "equal_wall_cells": "fewest equal cells at a wall",
    "far_field": "least distance of the far field from the middle of the walls, in chords",
    "non_orthogonality": "greatest of checkMesh's, degrees",
    "face_skewness": "greatest of checkMesh's",
    "box_ratio": "checkMesh's aspect ratio, the greatest",
    "irregular": "irregular vertices",
    "deviation_mean": "deviation of corner angles from 90 degrees, mean",
    "deviation_p99": "its 99th percentile",
    "growth_across": "growth across sides of blocks",
    "bend_across": "bend across sides of blocks, degrees",
})  # fmt: skip
"""Names of the figures other than metrics and counts, with a description of each."""


@dataclass(frozen=True)
class Figure:
    """A value, the indices ([block,] i, j[, k]) of its node or cell, and the direction of its grid line."""

    value: float
    at: tuple[int, ...] | None = None
    along: str | None = None

    @property
    def where(self) -> str:
        """Direction and place as text for users, empty if unknown.

        >>> Figure(1.4, (12, 0), "xi").where, Figure(3.0).where
        (' along xi at i=12, j=0', '')
        """
        return (f" along {self.along}" if self.along else "") + (f" at {named(self.at)}" if self.at else "")


_SAME = 1e-9  # largest distance of the ends of a closed line, divided by its extent: rounding


@dataclass(frozen=True, eq=False)
class Figures:
    """Figures (values with names) of a grid; each group of figures is measured at its first use."""

    grid: Grid
    quality: Quality
    walls: Sequence[Patch]

    @cached_property
    def faces(self) -> FaceMeasures:
        """The measures of faces that checkMesh uses."""
        return faces(self.grid)

    @cached_property
    def growth(self) -> Growth:
        """Growth ratios of neighbouring cells."""
        return self.blocks.lines.growth if self.grid.topology == "blocks" else growth(self.grid)

    @cached_property
    def blocks(self) -> BlockFigures:
        """Numbers of blocks and irregular vertices, corner angles, growth and turning of grid lines."""
        return block_figures(self.grid, self.quality)

    @cached_property
    def wall_rows(self) -> tuple[WallRow, ...]:
        """Heights and angles of the first cells at the walls."""
        by_wall = self.blocks.lines.by_wall if self.walls and self.grid.topology == "blocks" else {}
        return wall_rows(self.grid, self.walls, by_wall)

    def __call__(self, name: str, statistic: str = "max") -> Figure | None:
        """Return a figure, `statistic` of a metric, or None. Raises InputError: checkMesh of a surface."""
        if name in COUNTS:
            count = getattr(self.quality, name)
            return None if count is None else Figure(float(count))
        if name in self.quality.metrics:
            summary = self.quality[name]
            value = getattr(summary, statistic)
            end = next(metric.worst for metric in metrics_of(self.grid) if metric.name == name)
            at = summary.worst if statistic == end else None
            return None if value is None else Figure(float(value), at)
        if name in FACE_NAMES:
            return _figure(getattr(self.faces, name))
        if name == "growth":
            return _figure(most_of(self.growth.families().values())) or Figure(1.0)
        if name == "wall_growth":
            many = self.grid.topology == "blocks"
            return _figure(self.blocks.lines.leaving if many else growth_off_walls(self.growth, self.walls))
        if name == "equal_wall_cells":
            equal = [row.equal_cells for row in self.wall_rows]
            return Figure(float(min(equal))) if equal else None
        if name == "far_field":
            return self._far_field()
        return self._of_blocks(name) if name in FIGURES else None

    def _of_blocks(self, name: str) -> Figure | None:
        blocks = self.blocks
        if name == "irregular":
            return None if blocks.irregular is None else Figure(float(len(blocks.irregular)))
        if name in ("growth_across", "bend_across"):
            # no line runs across any side: steps are equal there, and there is no bend
            return _figure(getattr(blocks.lines, name)) or Figure(1.0 if name == "growth_across" else 0.0)
        value = blocks.deviation.mean if name == "deviation_mean" else blocks.deviation.p99
        return None if value is None else Figure(value)

    def _far_field(self) -> Figure | None:
        grid = self.grid
        far = [_points(grid, patch) for patch in grid.patches if patch.kind == "farfield"]
        if not self.walls or not (grid.around_body or (grid.topology == "blocks" and far)):
            return None
        wall = np.concatenate([_points(grid, patch) for patch in self.walls])
        beyond = grid.nodes[:, -1] if grid.around_body else np.concatenate(far)
        low, high = wall.min(axis=0), wall.max(axis=0)
        middles, chord = [0.5 * (low + high)], extent_of(wall)
        if grid.form == "volume":
            chord = max(self._chords(), default=0.0) or _longest(wall[:, None])
        elif wall.shape[1] == 2:
            middles.append(np.clip(_centre(beyond), low, high))
            if grid.around_body:  # a chord ends in the middle of a base, where the lines around a body begin
                chord = min(chord, float(norms(wall - wall[0]).max()))
        distance = max(float(norms(beyond - middle).min()) for middle in middles)
        return Figure((1.0 + _SAME) * distance / chord)

    def _chords(self) -> list[float]:
        """Return the longest extents of closed lines on walls of a volume."""
        walls = [self.grid.at(patch) for patch in self.walls]
        lines = [each for wall in walls for each in (wall, wall.swapaxes(0, 1)) if _closed(each)]
        return [_longest(each) for each in lines]


def _figure(extreme: Extreme | None) -> Figure | None:
    return None if extreme is None else Figure(extreme.max, extreme.at, extreme.along)


def _centre(ring: Floats) -> Floats:
    """Return the least-squares centre (2,) of a circle through points (n, 2)."""
    middle = ring.mean(axis=0)
    size = float(np.abs(ring - middle).max())
    x, y = (ring - middle).T / size
    square = x * x + y * y
    a, b, c = float((x * x).sum()), float((x * y).sum()), float((y * y).sum())
    p, q = 0.5 * float((square * x).sum()), 0.5 * float((square * y).sum())
    det = a * c - b * b
    if not det > 0.0:
        return middle
    return np.asarray(middle + size * np.array([c * p - b * q, a * q - b * p]) / det)


def _closed(lines: Floats) -> bool:
    """Return whether lines (n, m, 3) along the first axis end where they begin."""
    return bool((norms(lines[-1] - lines[0]) <= _SAME * norms(np.ptp(lines, axis=0))).all())


def _longest(lines: Floats) -> float:
    """Return the longest extent of lines (n, m, d) along the first axis, from the end of each."""
    middle = 0.5 * (lines.min(axis=0) + lines.max(axis=0))
    farthest = np.argmax(norms(lines - middle), axis=0)
    start = lines[farthest, np.arange(lines.shape[1])]
    return float(norms(lines - start).max())


def _points(grid: Grid, patch: Patch) -> Floats:
    nodes = grid.at(patch)
    return nodes.reshape(-1, nodes.shape[-1])
