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
    """Gates and profiles by which grids are judged, at least one of them.

    Parameters
    ----------
    gates : tuple of Gate, optional
        Conditions under which a grid fails.
    profiles : tuple of str, optional
        Names in `meshonet.geometry.quality.profiles.PROFILES`.
    leave_out : bool, optional
        Whether grids that fail are not written.
    """

    gates: tuple[Gate, ...] = ()
    profiles: tuple[str, ...] = ()
    leave_out: bool = False

    @property
    def percentiles(self) -> bool:
        """Whether a gate needs a percentile of the quality that is judged."""
        if not self.gates:
            return False
        from meshonet.geometry.quality.gates import need_percentiles

        return need_percentiles(self.gates)

    def judge(self, grid: Grid, quality: Quality) -> Judgement:
        """Return the judgement of a grid of this `quality`. Raises InputError: a figure that it lacks."""
        from meshonet.geometry.quality.figures import Figures
        from meshonet.geometry.quality.profiles import profile_report
        from meshonet.geometry.quality.report import QualityReport

        figures = Figures(grid, quality, grid.walls())
        profile = profile_report(figures, *self.profiles) if self.profiles else None
        return QualityReport(grid, quality, (), figures, profile).judgement(self.gates)
