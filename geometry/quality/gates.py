"""Gates: conditions on grid quality that must not hold, chosen by the user."""

import operator
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from meshonet.geometry.errors import InputError, meant
from meshonet.geometry.quality.figures import COUNTS, FIGURES, Figure
from meshonet.geometry.quality.metrics import ALL_NAMES

if TYPE_CHECKING:
    from meshonet.geometry.quality.figures import Figures
    from meshonet.geometry.quality.profiles import ProfileReport

COMPARE = {">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt}
NO_MORE: Mapping[str, Figure] = MappingProxyType({})
NEEDED = {"y_plus": "{reynolds}", "relative_l2": "{compare}", "near_wall": "{compare}"}
"""Parameters without which there are no such figures."""
_STATISTICS = ("min", "mean", "max", "p01", "p99")
_GATE = re.compile(r"\s*(\w+)(?:\.(\w+))?\s*(>=|<=|>|<)\s*([-+.\w]+)\s*", re.ASCII)


@dataclass(frozen=True)
class Gate:
    """A condition that makes a grid fail, written as ``METRIC[.STATISTIC] OPERATOR VALUE``."""

    text: str
    metric: str  # name of a metric, a count (`COUNTS`), one of `FIGURES`, or another that the caller allows
    statistic: str  # statistic of the metric over all cells: min, mean, max, p01 or p99
    compare: str
    limit: float  # limit, in the unit of the metric

    def figure(self, figures: "Figures", more: Mapping[str, Figure] = NO_MORE) -> Figure:
        """Return the value that the gate limits. Raises InputError if it is not in `figures` or `more`."""
        figure = more.get(self.metric) or figures(self.metric, self.statistic)
        if figure is None:
            known = [name for name in COUNTS if figures(name)]
            remedy = f"use {', '.join((*known, *figures.quality.metrics, *more))}"
            raise InputError(f"this grid has no {self.metric}", remedy, parameter="fail_on")
        return figure

    def broken(self, figures: "Figures", more: Mapping[str, Figure] = NO_MORE) -> str | None:
        """Return a message if the grid breaks the limit, else None. Raises InputError: unknown quantity."""
        figure = self.figure(figures, more)
        if not beyond(figure.value, self.compare, self.limit):
            return None
        return f"{self._what} is {figure.value:.6g}{figure.where}, which fails {{fail_on}} '{self.text}'"

    def in_short(self, figure: Figure) -> str:
        """Return a text that compares a figure with the limit: ``max_angle.max 178.2 > 170``."""
        return in_short(self._what, figure, self.compare, self.limit)

    def replaces(self, figure: str, compare: str) -> bool:
        """Return whether this limit of the user replaces a limit on the value `figure` in a quality profile.

        It does if both limit the same statistic in the same direction, upwards or downwards. `compare` is
        the comparison in the profile, such as ``<=``.
        """
        return (self.metric, self.compare[0], self.statistic) == (figure, compare[0], end_of(compare))

    @property
    def _what(self) -> str:
        return f"{self.metric}.{self.statistic}" if self.metric in ALL_NAMES else self.metric


def beyond(value: float, compare: str, limit: float) -> bool:
    """Return whether `value` is NaN or beyond the limit: if `compare` is ``<``, whether ``value < limit``."""
    return bool(COMPARE[compare](value, limit)) or value != value


def end_of(compare: str) -> str:
    """Return ``max`` for the comparisons ``>`` and ``>=``, ``min`` for others."""
    return "max" if compare in (">", ">=") else "min"


def in_short(name: str, figure: Figure, compare: str, limit: float) -> str:
    """Return a figure and its limit as text; growth and bend also with direction and place.

    The figure has four digits, or more if it would equal the limit otherwise.

    >>> in_short("growth", Figure(1.417, (12, 0), "xi"), ">", 1.3)
    'growth 1.417 > 1.3 along xi at i=12, j=0'
    >>> in_short("max_angle.max", Figure(178.0021), ">", 178)
    'max_angle.max 178.002 > 178'
    """
    digits = next((n for n in range(4, 17) if float(f"{figure.value:.{n}g}") != limit), 17)
    return f"{name} {figure.value:.{digits}g} {compare} {limit:g}{figure.where if figure.along else ''}"


@dataclass(frozen=True)
class Judgement:
    """The outcome of the user's limits (gates) and of quality profiles (sets of limits) for one grid.

    Parameters
    ----------
    problems : tuple of str
        A line for each limit by which the grid fails.
    beyond : tuple of str
        A short text for each problem and each warning, such as ``max_angle 178.2 > 170``.
    replaced : tuple of str
        The user's limits that replace limits of a profile, such as ``box_ratio > 4000``.
    profile : ProfileReport, optional
        The outcome of every check of the profiles.
    """

    problems: tuple[str, ...] = ()
    beyond: tuple[str, ...] = ()
    replaced: tuple[str, ...] = ()
    profile: "ProfileReport | None" = None

    @property
    def verdict(self) -> Literal["pass", "warn", "fail"]:
        """The worst outcome of all limits, of the user's and of those in quality profiles."""
        return "fail" if self.problems else "warn" if self.beyond else "pass"


def parse_gate(text: str, more: Sequence[str] = ()) -> Gate:
    """Return the condition `text`, such as ``max_angle > 170``, as an object; a grid fails if it is true.

    Without a statistic, ``>`` is for the largest value of all cells, ``<`` for the smallest. `more` has names
    of further values to compare. Raises InputError: no condition; an unknown metric or statistic.

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
    names = ("folded", *ALL_NAMES, "bezier_folded", *FIGURES, *more)
    if metric not in names and metric in NEEDED:
        needed = NEEDED[metric]
        raise InputError(f"{metric} needs {needed}", f"use quality {needed}", parameter="fail_on")
    if metric not in names:
        known = meant(metric, names) + "use one of " + ", ".join(("folded", *ALL_NAMES, *more))
        known += ", or another that the documentation's page on quality lists"
        raise InputError(f"metric {metric!r} is not known", known, parameter="fail_on")
    if statistic and (statistic not in _STATISTICS or metric not in ALL_NAMES):
        known = "one of " + ", ".join(_STATISTICS) if metric in ALL_NAMES else f"no statistic with {metric}"
        raise InputError(f"statistic {statistic!r} is not known", f"use {known}", parameter="fail_on")
    return Gate(text, metric, statistic or end_of(compare), compare, limit)


def parse_gates(texts: Iterable[str] | None, more: Sequence[str] = ()) -> tuple[Gate, ...]:
    """Return the conditions `texts` as objects (see `parse_gate`). None stands for no conditions."""
    return tuple(parse_gate(text, more) for text in texts or ())


VERDICTS = ("pass", "warn", "fail", "error")  # from best to worst; ``error``: there is no grid to judge


def verdict_word(verdict: str) -> str:
    """Return the word that users see for a verdict.

    >>> verdict_word("warn"), verdict_word("fail")
    ('warn', 'FAIL')
    """
    return verdict.upper() if verdict == "fail" else verdict
