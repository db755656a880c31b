"""Gates: conditions on the quality of a grid that a user does not accept."""

import operator
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from meshonet.geometry.errors import InputError, meant
from meshonet.geometry.quality.metrics import ALL_NAMES
from meshonet.geometry.quality.summary import Quality

COMPARE = {">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt}
NO_MORE: Mapping[str, float] = MappingProxyType({})
COUNTS = ("folded", "bezier_folded")
"""Counts of cells that gates may name: by corners, and by the Bezier test of volumes."""
OF_PROFILES: Mapping[str, str] = MappingProxyType({
    "non_orthogonality": "openfoam", "face_skewness": "openfoam", "box_ratio": "openfoam",
    "wall_growth": "viscous", "equal_wall_cells": "viscous", "far_field": "viscous",
})  # fmt: skip
"""Figures that are no metrics of cells, so that only profiles of ``quality`` judge them."""
_STATISTICS = ("min", "mean", "max", "p01", "p99")
_GATE = re.compile(r"\s*(\w+)(?:\.(\w+))?\s*(>=|<=|>|<)\s*([-+.\w]+)\s*", re.ASCII)


@dataclass(frozen=True)
class Gate:
    """A condition that a grid must not fulfil, from a user's ``METRIC[.STATISTIC] OPERATOR VALUE``."""

    text: str
    metric: str
    """Of `meshonet.geometry.quality.metrics`, one of `COUNTS`, or a figure beside them."""
    statistic: str
    """Of the metric over all cells: min, mean, max, p01 or p99."""
    compare: str
    limit: float
    """In the metric's unit."""

    def figure(self, quality: Quality, more: Mapping[str, float] = NO_MORE) -> float:
        """Return what the gate looks at, of `quality` or a figure of `more`.

        Raises InputError: a metric or count that these cells do not have.
        """
        has_statistics = self.metric in ALL_NAMES
        counts = {"folded": quality.folded, "bezier_folded": quality.bezier_folded}
        if has_statistics and self.metric in quality.metrics:
            value = getattr(quality[self.metric], self.statistic)
        else:
            value = {**counts, **more}.get(self.metric)
        if value is None:
            known = ", ".join(name for name, figure in counts.items() if figure is not None)
            remedy = f"use {known}, " + ", ".join((*quality.metrics, *more))
            raise InputError(f"this grid has no {self.metric}", remedy, parameter="fail_on")
        return float(value)

    def beyond(self, value: float) -> bool:
        """Say whether a figure is beyond the limit."""
        return bool(COMPARE[self.compare](value, self.limit))

    def broken(self, quality: Quality, more: Mapping[str, float] = NO_MORE) -> str | None:
        """Return a line for the user if the `figure` is beyond the limit, else None.

        Raises InputError: a metric or count that these cells do not have.
        """
        value = self.figure(quality, more)
        if not self.beyond(value):
            return None
        return f"{self._what} is {value:.6g}, and {{fail_on}} '{self.text}'"

    def in_short(self, value: float) -> str:
        """Return a figure beyond the limit and the limit: ``max_angle.max 178.2 > 170``."""
        return f"{self._what} {value:.4g} {self.compare} {self.limit:g}"

    @property
    def _what(self) -> str:
        return f"{self.metric}.{self.statistic}" if self.metric in ALL_NAMES else self.metric


@dataclass(frozen=True)
class Judgement:
    """What came of gates and profile for one grid.

    Parameters
    ----------
    problems : tuple of str
        A line for each gate, and each check of the profile, that failed.
    beyond : tuple of str
        The same in short, warnings of the profile among them: ``max_angle 178.2 > 170``.
    """

    problems: tuple[str, ...] = ()
    beyond: tuple[str, ...] = ()

    @property
    def verdict(self) -> Literal["pass", "warn", "fail"]:
        """The worst that any gate or check says."""
        return "fail" if self.problems else "warn" if self.beyond else "pass"


def parse_gate(text: str, more: Sequence[str] = ()) -> Gate:
    """Return the gate that `text` describes; `more` are figures beside the metrics, without statistics.

    Without a statistic, ``>`` looks at the greatest cell and ``<`` at the least.

    Raises InputError: `text` is no gate, or names an unknown metric or statistic.

    >>> parse_gate("max_angle > 170").statistic, parse_gate("scaled_jacobian.p01<0.2").statistic
    ('max', 'p01')
    """
    match = _GATE.fullmatch(text)
    try:
        limit = float(match[4]) if match else None
    except ValueError:
        limit = None
    if match is None or limit is None or limit != limit:
        raise InputError(
            f"{text!r} is not a gate",
            "write METRIC>VALUE or METRIC<VALUE, e.g. 'max_angle>170'",
            parameter="fail_on",
        )
    metric, statistic, compare = match[1], match[2], match[3]
    if metric not in (*ALL_NAMES, *COUNTS, *more):
        if metric in OF_PROFILES:
            remedy = f"judge the grid by the profile: meshonet quality GRID --profile {OF_PROFILES[metric]}"
            raise InputError(f"{metric!r} is no metric of cells", remedy, parameter="fail_on")
        names = ("folded", *ALL_NAMES, "bezier_folded", *more)
        known = meant(metric, names) + "use one of " + ", ".join(names)
        raise InputError(f"metric {metric!r} is not known", known, parameter="fail_on")
    if statistic and (statistic not in _STATISTICS or metric not in ALL_NAMES):
        known = "one of " + ", ".join(_STATISTICS) if metric in ALL_NAMES else f"no statistic with {metric}"
        raise InputError(f"statistic {statistic!r} is not known", f"use {known}", parameter="fail_on")
    return Gate(text, metric, statistic or ("max" if compare in (">", ">=") else "min"), compare, limit)


def parse_gates(texts: Iterable[str] | None, more: Sequence[str] = ()) -> tuple[Gate, ...]:
    """Return the gates of all `texts`, which may name figures of `more` too."""
    return tuple(parse_gate(text, more) for text in texts or ())


def need_percentiles(gates: Iterable[Gate]) -> bool:
    """Say whether a gate looks at a percentile, which costs a sort of all cells."""
    return any(gate.statistic in ("p01", "p99") for gate in gates)
