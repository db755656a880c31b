"""Thresholds of quality that others use: what OpenFOAM, Pointwise, Verdict and boundary layers ask for.

=========  =================================================================================================
openfoam   checkMesh: folded cells, non-orthogonality (warns beyond 70 degrees, an error from 90), skewness at
           most 4; its aspect ratio, which boundary layers often exceed, warns beyond 1000
pointwise  equiangle skewness: good below 0.8, acceptable below 0.9
verdict    scaled Jacobian from 0.3 to 1; the largest angle to 135 and the least from 45 degrees warn
viscous    Drag Prediction Workshop guidelines: growth away from walls below 1.25; at least 2 equal cells at
           the wall and a far field at 100 chords, or it warns; angles from 18 degrees (ICEM practice), or it
           warns
=========  =================================================================================================

All of them fail a grid with folded cells. Sources: OpenFOAM primitiveMeshCheck.C; Pointwise user manual,
Equiangle Skewness; C. J. Stimpson et al., SAND2007-1751 (2007); J. C. Vassberg et al., Gridding Guidelines of
the AIAA Drag Prediction Workshops.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.blocks import BlockFigures, block_figures
from meshonet.geometry.quality.checkmesh import Faces, faces
from meshonet.geometry.quality.gates import COMPARE
from meshonet.geometry.quality.growth import Extreme, Growth, growth
from meshonet.geometry.quality.summary import Quality
from meshonet.geometry.quality.walls import WallRow, wall_rows

Level = Literal["warn", "fail"]
Verdict = Literal["pass", "warn", "fail", "none"]


@dataclass(frozen=True)
class Limit:
    """A condition that a figure must not fulfil, and what follows when it does."""

    level: Level
    compare: Literal[">", ">=", "<"]
    value: float

    def broken(self, value: float) -> bool:
        """Say whether `value` fulfils the condition; what is not a number does."""
        return bool(COMPARE[self.compare](value, self.value)) or value != value


@dataclass(frozen=True)
class Check:
    """A figure and its limits."""

    figure: str
    limits: tuple[Limit, ...]


@dataclass(frozen=True)
class CheckResult:
    """The outcome of a check: the figure (None: this grid has none), its node or cell, the verdict."""

    check: Check
    value: float | None
    at: tuple[int, ...] | None
    verdict: Verdict


@dataclass(frozen=True)
class ProfileReport:
    """The results of a profile's checks on one grid."""

    name: str
    results: tuple[CheckResult, ...]

    @property
    def passed(self) -> bool:
        """Whether no check failed; warnings pass."""
        return all(result.verdict != "fail" for result in self.results)

    def beyond(self) -> list[str]:
        """Return in short which limits are exceeded, those that warn too: ``face_skewness 5.2 > 4``."""
        return [_in_short(result) for result in self.results if result.verdict in ("warn", "fail")]

    def failures(self) -> list[str]:
        """Return a line for each check that failed."""
        return [
            f"profile {self.name}: {result.check.figure} is {result.value:.6g}, and it must "
            + " nor ".join(
                f"not be {x.compare} {x.value:g}" for x in result.check.limits if x.level == "fail"
            )
            for result in self.results
            if result.verdict == "fail" and result.value is not None
        ]


def _in_short(result: CheckResult) -> str:
    """Return which limit a figure is beyond, the one that fails it where it is beyond several."""
    value = result.value or 0.0
    limit = max((x for x in result.check.limits if x.broken(value)), key=lambda x: x.level == "fail")
    return f"{result.check.figure} {value:.4g} {limit.compare} {limit.value:g}"


def _check(figure: str, *limits: tuple[Level, Literal[">", ">=", "<"], float]) -> Check:
    return Check(figure, tuple(Limit(*limit) for limit in limits))


_FOLDED = _check("folded", ("fail", ">", 0))
PROFILES: dict[str, tuple[Check, ...]] = {
    "openfoam": (
        _FOLDED,
        _check("non_orthogonality", ("warn", ">", 70), ("fail", ">=", 90)),
        _check("face_skewness", ("fail", ">", 4)),
        _check("box_ratio", ("warn", ">", 1000)),
    ),
    "pointwise": (_FOLDED, _check("skewness", ("warn", ">=", 0.8), ("fail", ">=", 0.9))),
    "verdict": (
        _FOLDED,
        _check("scaled_jacobian", ("fail", "<", 0.3)),
        _check("max_angle", ("warn", ">", 135)),
        _check("min_angle", ("warn", "<", 45)),
    ),
    "viscous": (
        _FOLDED,
        _check("wall_growth", ("fail", ">=", 1.25)),
        _check("equal_wall_cells", ("warn", "<", 2)),
        _check("far_field", ("warn", "<", 100)),
        _check("min_angle", ("warn", "<", 18)),
    ),
}


@dataclass(frozen=True, eq=False)
class Figures:
    """The figures of a grid by name, each group of them measured when it is first asked for."""

    grid: Grid
    quality: Quality
    walls: Sequence[Patch]

    @cached_property
    def faces(self) -> Faces:
        """What checkMesh says of its faces."""
        return faces(self.grid)

    @cached_property
    def growth(self) -> Growth:
        """How fast its cells grow."""
        return self.blocks.lines.growth if self.grid.topology == "blocks" else growth(self.grid)

    @cached_property
    def blocks(self) -> BlockFigures:
        """Its blocks, their vertices and how lines run through them."""
        return block_figures(self.grid, self.quality)

    @cached_property
    def wall_rows(self) -> tuple[WallRow, ...]:
        """The cells at its walls."""
        by_wall = self.blocks.lines.by_wall if self.walls and self.grid.topology == "blocks" else {}
        return wall_rows(self.grid, self.walls, by_wall)

    def value(self, name: str, *, low: bool) -> tuple[float, tuple[int, ...] | None] | None:
        """Return figure `name` and its place: the least of a metric when `low`, otherwise the greatest.

        ``wall_growth`` is the growth along the lines that leave the walls, ``far_field`` the least distance
        of the far field from the middle of the walls in chords, where there is one.
        """
        if name == "folded":
            return float(self.quality.folded), None
        if name in self.quality.metrics:
            summary = self.quality[name]
            return (summary.min if low else summary.max), summary.worst
        if name == "equal_wall_cells":
            return (float(min(row.equal_cells for row in self.wall_rows)), None) if self.wall_rows else None
        if name == "far_field":
            return self._far_field()
        figure = self._wall_growth() if name == "wall_growth" else getattr(self.faces, name)
        return None if figure is None else (figure.max, figure.at)

    def _wall_growth(self) -> Extreme | None:
        if self.grid.topology == "blocks":
            return self.blocks.lines.leaving
        sides = {patch.side for patch in self.walls}
        families = (self.growth.eta, {"south", "north"}), (self.growth.xi, {"west", "east"})
        leaving = [extreme for extreme, ends in families if extreme and sides & ends]
        return max(leaving, key=lambda extreme: extreme.max, default=None)

    def _far_field(self) -> tuple[float, None] | None:
        grid = self.grid
        far = [_nodes(grid, patch) for patch in grid.patches if patch.kind == "farfield"]
        if not self.walls or not (grid.around_body or (grid.topology == "blocks" and far)):
            return None
        wall = np.concatenate([_nodes(grid, patch) for patch in self.walls])
        beyond = grid.nodes[:, -1] if grid.around_body else np.concatenate(far)
        middle = 0.5 * (wall.min(axis=0) + wall.max(axis=0))
        start = wall[np.argmax(norms(wall - middle))]
        chord = float(norms(wall - start).max())
        return float(norms(beyond - middle).min()) / chord, None


def _nodes(grid: Grid, patch: Patch) -> Floats:
    face = grid.face(patch.block, patch.side)
    spans = patch.range(face.shape[:-1])
    return face[tuple(slice(first, last + 1) for first, last in spans)].reshape(-1, face.shape[-1])


def profile_report(figures: Figures, profile: str) -> ProfileReport:
    """Return the results of `profile` for a grid; raise InputError unless it is one of `PROFILES`."""
    if profile not in PROFILES:
        known = "use one of " + ", ".join(PROFILES)
        raise InputError(f"profile {profile!r} is not known", known, parameter="profile")
    return ProfileReport(profile, tuple(_result(check, figures) for check in PROFILES[profile]))


def _result(check: Check, figures: Figures) -> CheckResult:
    figure = figures.value(check.figure, low=check.limits[0].compare == "<")
    if figure is None:
        return CheckResult(check, None, None, "none")
    broken = [limit.level for limit in check.limits if limit.broken(figure[0])]
    return CheckResult(check, *figure, "fail" if "fail" in broken else "warn" if broken else "pass")
