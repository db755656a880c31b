"""Requirements of a user on a grid: gates, and the limits of profiles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meshonet.geometry.blocks.grid import Grid
    from meshonet.geometry.quality.gates import Gate, Judgement
    from meshonet.geometry.summary import Quality


@dataclass(frozen=True)
class Criteria:
    """Limits by which grids pass or fail; there must be a gate or a profile.

    `gates` are conditions under which a grid fails. `profiles` are names of sets of limits, the keys of
    `meshonet.geometry.quality.profiles.PROFILES`. With `leave_out`, grids that fail are not written.
    """

    gates: tuple[Gate, ...] = ()
    profiles: tuple[str, ...] = ()
    leave_out: bool = False

    @property
    def percentiles(self) -> bool:
        """Whether one of the limits is on a percentile of a metric."""
        return any(gate.statistic in ("p01", "p99") for gate in self.gates)

    def judge(self, grid: Grid, quality: Quality) -> Judgement:
        """Return the judgement of `grid`. Raises InputError if a limit is on a quantity that `grid` lacks."""
        from meshonet.geometry.quality.figures import Figures
        from meshonet.geometry.quality.profiles import profile_report
        from meshonet.geometry.quality.report import QualityReport

        figures = Figures(grid, quality, grid.walls())
        profile = profile_report(figures, *self.profiles) if self.profiles else None
        return QualityReport(grid, quality, (), figures, profile).judgement(self.gates)
