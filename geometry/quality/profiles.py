"""Quality thresholds of others (docs/reference/quality.md); all fail a grid with folded cells.

Sources: OpenFOAM primitiveMeshCheck.C; Pointwise user manual, Equiangle Skewness; C. J. Stimpson et al.,
SAND2007-1751 (2007); J. C. Vassberg et al., Gridding Guidelines of the AIAA Drag Prediction Workshops.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.bad_cell import centre_of
from meshonet.geometry.quality.figures import Figure, Figures
from meshonet.geometry.quality.gates import Gate, beyond, end_of, in_short

Level = Literal["warn", "fail"]
Verdict = Literal["pass", "warn", "fail", "none"]


@dataclass(frozen=True)
class Limit:
    """A comparison with `value`; a grid for which it is true gets a warning or fails, as `level` says."""

    level: Level
    compare: str  # one of `COMPARE`
    value: float


@dataclass(frozen=True)
class Check:
    """The name of a measure of grid quality, such as ``max_angle``, and the limits on its value."""

    figure: str
    limits: tuple[Limit, ...]


@dataclass(frozen=True)
class CheckResult:
    """The outcome of one check of a quality profile; `figure` is the checked value, None if there is none.

    `profile` is the name of the profile. `centre` (2 or 3,) is the centre of the cell with this value. If
    `gated`, the limits are the user's, not the limits of the profile.
    """

    check: Check
    figure: Figure | None
    profile: str
    centre: tuple[float, ...] | None = None
    gated: bool = False

    @property
    def value(self) -> float | None:
        """The checked value, None if there is none."""
        return self.figure.value if self.figure else None

    @property
    def at(self) -> tuple[int, ...] | None:
        """Indices of the node or cell at which the value was found."""
        return self.figure.at if self.figure else None

    @property
    def verdict(self) -> Verdict:
        """The worst outcome of the limits."""
        if self.figure is None:
            return "none"
        return self.worst.level if self.worst else "pass"

    @property
    def worst(self) -> Limit | None:
        """The limit that the value exceeds; if there are several, a failure comes before a warning."""
        limits = self.check.limits if self.figure else ()
        broken = [x for x in limits if self.figure and beyond(self.figure.value, x.compare, x.value)]
        return max(broken, key=lambda limit: limit.level == "fail", default=None)

    def under(self, gates: Sequence[Gate]) -> "CheckResult":
        """Return the result with the user's limits `gates` on the same value, if any, in place of its own."""
        compare = self.check.limits[0].compare
        own = [gate for gate in gates if gate.replaces(self.check.figure, compare)]
        limits = tuple(Limit("fail", gate.compare, gate.limit) for gate in own)
        if not own or limits == self.check.limits:
            return self
        return replace(self, check=Check(self.check.figure, limits), gated=True)


@dataclass(frozen=True)
class ProfileReport:
    """Results of the checks of one or more quality profiles (sets of limits) on one grid."""

    names: tuple[str, ...]
    results: tuple[CheckResult, ...]

    @property
    def name(self) -> str:
        """Names of the quality profiles, as text."""
        return ", ".join(self.names)

    @property
    def passed(self) -> bool:
        """Whether no check failed; warnings do not count."""
        return all(result.verdict != "fail" for result in self.results)

    def under(self, gates: Sequence[Gate]) -> "ProfileReport":
        """Return the report with the user's limits `gates` in place of its own limits on the same values."""
        return replace(self, results=_once(result.under(gates) for result in self.results))

    def replaced(self) -> list[str]:
        """Return the user's limits that replace those of a profile, as texts such as ``box_ratio > 4000``."""
        return [
            f"{result.check.figure} {limit.compare} {limit.value:g}"
            for result in self.results
            if result.gated
            for limit in result.check.limits
        ]

    def beyond(self) -> list[str]:
        """Return a text, such as ``face_skewness 5.2 > 4``, for each exceeded limit, warnings included."""
        return [
            in_short(result.check.figure, result.figure, limit.compare, limit.value)
            for result in self.results
            if result.figure and (limit := result.worst)
        ]

    def failures(self) -> list[str]:
        """Return a line for each failed check, except checks that the user's own limits (gates) replace."""
        return [
            f"profile {result.profile}: {result.check.figure} is {result.value:.6g}{result.figure.where}, "
            "and it must "
            + " nor ".join(
                f"not be {x.compare} {x.value:g}" for x in result.check.limits if x.level == "fail"
            )
            for result in self.results
            if result.verdict == "fail" and result.figure and not result.gated
        ]


def _once(results: Iterable[CheckResult]) -> tuple[CheckResult, ...]:
    checks: dict[Check, CheckResult] = {}
    for result in results:
        checks.setdefault(result.check, result)
    return tuple(checks.values())


def _check(figure: str, *limits: tuple[Level, str, float]) -> Check:
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


def profile_report(figures: Figures, *profiles: str) -> ProfileReport:
    """Compare measures `figures` of a grid with the limits in `profiles`. Raises InputError: unknown name."""
    for profile in profiles:
        if profile not in PROFILES:
            known = "use one of " + ", ".join(PROFILES)
            raise InputError(f"profile {profile!r} is not known", known, parameter="profile")
    names = tuple(dict.fromkeys(profiles))
    return ProfileReport(
        names, _once(_result(figures, check, name) for name in names for check in PROFILES[name])
    )


def _result(figures: Figures, check: Check, profile: str) -> CheckResult:
    figure = figures(check.figure, end_of(check.limits[0].compare))
    centre = tuple(centre_of(figures.grid, figure.at).tolist()) if figure and figure.at else None
    return CheckResult(check, figure, profile, centre)
