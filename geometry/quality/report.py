"""The quality report of a grid: metrics, walls, profiles, and the distance from a reference grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import spelled
from meshonet.geometry.quality.bad_cell import BadCell, centre_of
from meshonet.geometry.quality.blocks import extreme_dict
from meshonet.geometry.quality.compare import Difference, compare
from meshonet.geometry.quality.figures import Figure, Figures
from meshonet.geometry.quality.gates import Gate, Judgement, beyond, parse_gate
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.measure import measure, worst_cells_of
from meshonet.geometry.quality.profiles import CheckResult, ProfileReport, profile_report
from meshonet.geometry.quality.wall_y_plus import Flow, YPlus, y_plus_at
from meshonet.geometry.quality.walls import Spread, WallRow, skewness_at
from meshonet.geometry.summary import Quality

if TYPE_CHECKING:
    from meshonet.geometry.quality.periodic import Period

COMPARED = (
    "relative_l2", "near_wall", "max", "boundary", "folded_other", "max_angle_ratio", "mean_angle_ratio",
)  # fmt: skip
"""Names of the figures of a comparison, which gates may use."""
Y_PLUS = "y_plus"  # name of the largest y+ at all walls, which gates may use if a flow is given
Gates: TypeAlias = str | Sequence[str | Gate]  # gates, or their texts as in `parse_gate`


@dataclass(frozen=True)
class Comparison:
    """Distances of nodes from a reference grid's nodes, and ratios of angles to the reference's angles."""

    difference: Difference
    folded: int  # number of folded cells of the reference
    max_angle_ratio: float
    mean_angle_ratio: float

    def figures(self) -> dict[str, float]:
        """Return the figures by their names in `COMPARED`."""
        d = self.difference
        ratios = (self.folded, self.max_angle_ratio, self.mean_angle_ratio)
        return dict(zip(COMPARED, (d.relative_l2, d.near_wall, d.max, d.boundary, *ratios), strict=True))


@dataclass(frozen=True, eq=False)
class QualityReport:
    """The quality of a grid; if requested, verdicts of profiles (sets of limits) and a comparison.

    For each metric, such as ``report.quality["max_angle"]``, there are ``min``, ``mean``, ``max``, ``p01``,
    ``p99`` and ``worst``, the worst cell. ``report.quality.folded`` is the number of folded cells.
    ``report.figures.wall_rows`` has heights and angles of first cells. ``report.figures.growth`` has growth
    ratios. ``report.profile.passed`` is the verdict of the profiles. ``report.as_dict()`` has all that
    ``meshonet quality --json`` prints.

    Parameters
    ----------
    grid : Grid
        The grid that was measured.
    quality : Quality
        Statistics of every metric, with percentiles.
    worst : tuple of BadCell
        The folded cells, at most ten of them.
    figures : Figures
        Values for walls, growth ratios and blocks.
    profile : ProfileReport, optional
        The verdicts of profiles.
    comparison : Comparison, optional
        The comparison with a reference grid.
    flow : Flow, optional
        The flow for which y+ at the walls is reported.
    """

    grid: Grid
    quality: Quality
    worst: tuple[BadCell, ...]
    figures: Figures
    profile: ProfileReport | None = None
    comparison: Comparison | None = None
    flow: Flow | None = None

    @cached_property
    def y_plus(self) -> dict[str, YPlus]:
        """The y+ at each wall, by the name of the wall; empty without a flow."""
        return y_plus_at(self.grid, self.figures.walls, self.flow) if self.flow else {}

    @cached_property
    def wall_skewness(self) -> dict[str, Extreme]:
        """Skewness of the cells at each wall of a volume, by the name of the wall."""
        return skewness_at(self.grid, self.figures.walls) if self.grid.form == "volume" else {}

    @cached_property
    def periods(self) -> tuple[Period, ...]:
        """The distinct translations or rotations between periodic sides of the grid."""
        if all(connection.transform is None for connection in self.grid.connections):
            return ()
        from meshonet.geometry.quality.periodic import periods

        return periods(self.grid)

    def __repr__(self) -> str:
        angle = self.quality["max_angle"].max if "max_angle" in self.quality.metrics else None
        parts = [f"{self.quality.cells} cells", f"{self.quality.folded} folded"]
        parts += [] if angle is None else [f"max angle {angle:.1f}"]
        parts += (
            [f"{self.profile.name} {'passed' if self.profile.passed else 'failed'}"] if self.profile else []
        )
        return f"<QualityReport: {', '.join(parts)}>"

    def under(self, gates: Gates) -> QualityReport:
        """Return the report with the user's limits `gates` in place of the limits in its quality profile."""
        return replace(self, profile=self.profile.under(_parsed(gates))) if self.profile else self

    def broken(self, gates: Gates = ()) -> list[str]:
        """Return a message for each broken limit in `gates` and for each failed check of the quality profile.

        `gates` is one text or several, such as ``max_angle>170`` or ``scaled_jacobian.p01<0.2``: conditions
        that must not hold. A message gives the value, its place and the limit.

        Raises InputError: a text that is no such condition; a metric that this grid does not have.
        """
        return [spelled(line, lambda _: "the gate") for line in self._broken(_parsed(gates))]

    def _broken(self, gates: Sequence[Gate]) -> list[str]:
        more = self._compared()
        lines = [line for gate in gates if (line := gate.broken(self.figures, more))]
        return lines + (self.profile.under(gates).failures() if self.profile else [])

    def judgement(self, gates: Gates) -> Judgement:
        """Return whether the grid keeps the user's limits `gates` and those of its quality profile."""
        gates = _parsed(gates)
        beyond = [gate.in_short(figure) for gate, figure, broken in self.judged(gates) if broken]
        profile = self.profile.under(gates) if self.profile else None
        beyond += profile.beyond() if profile else []
        replaced = profile.replaced() if profile else []
        return Judgement(tuple(self._broken(gates)), tuple(dict.fromkeys(beyond)), tuple(replaced), profile)

    def judged(self, gates: Gates) -> list[tuple[Gate, Figure, bool]]:
        """Return each limit of the user, the value that it limits, and whether the value is beyond it."""
        more, gates = self._compared(), _parsed(gates)
        figures = [gate.figure(self.figures, more) for gate in gates]
        pairs = zip(gates, figures, strict=True)
        return [(gate, figure, beyond(figure.value, gate.compare, gate.limit)) for gate, figure in pairs]

    def _compared(self) -> dict[str, Figure]:
        values = self.comparison.figures() if self.comparison else {}
        values |= {Y_PLUS: max(each.max for each in self.y_plus.values())} if self.y_plus else {}
        return {name: Figure(value) for name, value in values.items()}

    def _at_wall(self, name: str) -> dict[str, Any]:
        facts: dict[str, Any] = {Y_PLUS: vars(self.y_plus[name])} if name in self.y_plus else {}
        skewness = self.wall_skewness.get(name)
        return facts | ({"skewness": extreme_dict(skewness)} if skewness else {})

    def _metrics(self) -> dict[str, Any]:
        facts = quality_dict(self.quality)
        for name, summary in self.quality.metrics.items():
            facts[name]["worst_centre"] = centre_of(self.grid, summary.worst).tolist()
        return facts

    def as_dict(self) -> dict[str, Any]:
        """Return the report as a dict that JSON can hold."""
        grid, growth = self.grid, self.figures.growth
        many = grid.topology == "blocks"
        facts: dict[str, Any] = {
            **({"cells": self.quality.cells} if many else {"ni": grid.ni, "nj": grid.nj}),
            "topology": grid.topology,
            **(self.figures.blocks.as_dict() if many else {}),
            "form": grid.form,
            **_folded(self.quality),
            "worst_cells": [_set_fields(cell) for cell in self.worst],
            "quality": self._metrics(),
            "walls": [_wall(row) | self._at_wall(row.name) for row in self.figures.wall_rows],
        }
        along = {"xi": growth.xi, "eta": growth.eta} | growth.families()
        if self.periods:
            facts["periodic"] = [vars(period) for period in self.periods]
        facts["growth"] = {name: extreme_dict(extreme) for name, extreme in along.items()}
        if self.profile:
            facts["profile"] = profile_dict(self.profile)
        if self.comparison:
            d = self.comparison.difference
            facts["compare"] = {"max": d.max, "mean": d.mean, "at": list(d.at), **self.comparison.figures()}
        return facts


def _parsed(gates: Gates) -> list[Gate]:
    every = [gates] if isinstance(gates, str) else gates
    return [parse_gate(each, (*COMPARED, Y_PLUS)) if isinstance(each, str) else each for each in every]


def quality_report(
    grid: Grid, profile: str | Sequence[str] = (), reference: Grid | None = None, flow: Flow | None = None
) -> QualityReport:
    """Measure `grid`, judge it by profiles, and compare it with a `reference` of the same node counts.

    A `flow` adds y+ at the walls. Raises InputError: an unknown profile; other node counts of the reference.
    """
    profiles = (profile,) if isinstance(profile, str) else profile
    quality = measure(grid, percentiles=True)
    figures = Figures(grid, quality, grid.walls())
    return QualityReport(
        grid,
        quality,
        tuple(worst_cells_of(grid)) if quality.folded else (),
        figures,
        profile_report(figures, *profiles) if profiles else None,
        None if reference is None else _comparison(grid, quality, reference),
        flow,
    )


def quality_dict(quality: Quality) -> dict[str, Any]:
    """Return the metrics as a dict that JSON can hold, with percentiles if they were computed."""
    facts: dict[str, Any] = {"cells": quality.cells, **_folded(quality)}
    for name, summary in quality.metrics.items():
        row: dict[str, Any] = {"min": summary.min, "mean": summary.mean, "max": summary.max}
        if summary.p01 is not None:
            row |= {"p01": summary.p01, "p99": summary.p99}
        facts[name] = row | {"worst": list(summary.worst)}
    return facts


def profile_dict(profile: ProfileReport) -> dict[str, Any]:
    """Return the results of checking a grid by quality profiles (sets of limits), as a dict for JSON."""
    checks = [_check(result) for result in profile.results]
    return {"name": profile.name, "passed": profile.passed, "checks": checks}


def _folded(quality: Quality) -> dict[str, int]:
    """Return the number of folded cells, in volumes by both tests."""
    more = {} if quality.bezier_folded is None else {"bezier_folded": quality.bezier_folded}
    return {"folded": quality.folded, **more}


def _comparison(grid: Grid, quality: Quality, reference: Grid) -> Comparison:
    difference = compare(grid, reference)
    own, other = quality["max_angle"], measure(reference)
    angle = other["max_angle"]
    return Comparison(difference, other.folded, own.max / angle.max, own.mean / angle.mean)


def _set_fields(of: BadCell | Spread) -> dict[str, Any]:
    return {name: value for name, value in vars(of).items() if value is not None}


def _wall(row: WallRow) -> dict[str, Any]:
    sizes = {"first_cell": _set_fields(row.height), "off_square": _set_fields(row.off_square)}
    growth = {} if row.growth is None else {"growth": extreme_dict(row.growth)}
    return {"name": row.name, "side": row.side, **sizes, "equal_cells": row.equal_cells, **growth}


def _check(result: CheckResult) -> dict[str, Any]:
    return {
        "profile": result.profile,
        "figure": result.check.figure,
        "value": result.value,
        "at": list(result.at) if result.at else None,
        "centre": list(result.centre) if result.centre else None,
        "limits": [{"level": x.level, "when": x.compare, "value": x.value} for x in result.check.limits],
        "gated": result.gated,
        "verdict": result.verdict,
    }


_BEYOND = "beyond the limits of OpenFOAM's checkMesh"


def with_checkmesh_notes(notes: tuple[str, ...], grid: object) -> tuple[str, ...]:
    """Return `notes`, and the `checkmesh_notes` of the grid unless `notes` has them already."""
    if not isinstance(grid, Grid) or any(note.startswith(_BEYOND) for note in notes):
        return notes
    return (*notes, *checkmesh_notes(grid))


def checkmesh_notes(grid: Grid, coarsened: int = 1) -> tuple[str, ...]:
    """Return a note on the limits of checkMesh that a grid exceeds, or nothing if there are none.

    If the grid was coarsened by the factor `coarsened`, the note says how this changed growth ratios.
    Surfaces get no note, because checkMesh does not judge them.
    """
    if grid.form == "surface":
        return ()
    judged = quality_report(grid, "openfoam").profile
    exceeded = judged.beyond() if judged else []
    if not exceeded:
        return ()
    cause = f"; growth ratios are those of the fine grid to the power {coarsened}" if coarsened > 1 else ""
    return (f"{_BEYOND}: {', '.join(exceeded)}{cause}",)
