"""Options for the validity of grids, and for quality limits that set the exit code."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

from meshonet_cli.options.groups import CHECKS, option_of

if TYPE_CHECKING:
    from meshonet.geometry.quality.criteria import Criteria

_option = option_of(CHECKS)


Profile = StrEnum("Profile", "openfoam pointwise verdict viscous")
"""Profiles of `meshonet.geometry.quality.profiles`; typer allows repeated options only for enumerations."""

# fmt: off
AllowInvalid = Annotated[bool, _option(help="Write the grid even if it has folded cells.")]


LeaveOutFailed = Annotated[bool, _option(
    help="Do not write grids that fail a --fail-on or --profile. The exit code is still 1.",
)]


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """Options for folded cells and their repair."""

    repair: bool | None = _option(
        "--repair/--no-repair", help="Repair folded cells. With --no-repair a grid with folded cells is an "
        "error. [default: --no-repair for tfi, else --repair]",
    )
    allow_invalid: AllowInvalid = False


@dataclass(frozen=True, kw_only=True)
class GateOptions:
    """Options for quality limits of grids."""

    fail_on: list[str] | None = _option(
        metavar="GATE", help="Exit with code 1 if this condition holds, e.g. 'max_angle>170', "
        "'skewness.p99>0.8' (99th percentile) or 'folded>0'. It replaces the --profile limit of the same "
        "metric. The documentation's page on quality lists all metrics. Repeatable.",
    )
    profile: list[Profile] | None = _option(
        metavar="openfoam|pointwise|verdict|viscous", help="Check the grid against the limits of another "
        "program or guideline, which the documentation's page on quality lists. Each limit gives pass, warn "
        "or FAIL; FAIL exits with code 1. Repeatable.",
    )

    def criteria(self, leave_out: bool = False, *, more: Sequence[str] = ()) -> "Criteria | None":
        """Return the quality limits, or None without any; `more` are quantities that can also be limited.

        Raises InputError if a limit is invalid, or if grids are to be left out although there are no limits.
        """
        if not (self.fail_on or self.profile):
            if leave_out:
                from meshonet.geometry.errors import InputError

                problem = "there is nothing that a grid could fail"
                raise InputError(problem, "give {fail_on} or {profile} too", parameter="leave_out_failed")
            return None
        from meshonet.geometry.quality.criteria import Criteria
        from meshonet.geometry.quality.gates import parse_gates

        profiles = tuple(profile.value for profile in self.profile or ())
        return Criteria(parse_gates(self.fail_on or (), more), profiles, leave_out)

# fmt: on
