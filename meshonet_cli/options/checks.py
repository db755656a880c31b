"""Options that say what a grid must be to be written, and what ends the program with 1."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Annotated

from meshonet_cli.options.groups import CHECKS, option_of

if TYPE_CHECKING:
    from meshonet.geometry.quality.criteria import Criteria

_option = option_of(CHECKS)


class Profile(Enum):
    """Profiles of `meshonet.geometry.quality.profiles`; typer repeats choices of an enumeration only."""

    openfoam = "openfoam"
    pointwise = "pointwise"
    verdict = "verdict"
    viscous = "viscous"


# fmt: off
AllowInvalid = Annotated[bool, _option(
    "--allow-invalid", help="Write the grid even when cells are folded.",
)]


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """What a grid must be."""

    repair: Annotated[bool | None, _option(
        "--repair/--no-repair",
        help="Unfold folded cells, or refuse grids that have any. [default: solve-pde and infer unfold, tfi "
        "refuses]",
    )] = None
    allow_invalid: AllowInvalid = False


@dataclass(frozen=True, kw_only=True)
class GateOptions:
    """What a grid must be to pass."""

    fail_on: Annotated[list[str] | None, _option(
        "--fail-on", metavar="GATE",
        help="Exit with 1 when this holds, e.g. 'max_angle>170', 'skewness.p99>0.8', 'folded>0'; repeatable. "
        "Names: folded; max_angle, skewness and the other metrics; growth, wall_growth, equal_wall_cells, "
        "far_field; non_orthogonality, face_skewness, box_ratio; of blocks irregular and more (the page on "
        "quality in the documentation has all). Replaces the limit that a --profile has for the same figure. "
        "Of several grids a table says which pass.",
    )] = None
    profile: Annotated[list[Profile] | None, _option(
        "--profile", metavar="openfoam|pointwise|verdict|viscous",
        help="Judge by the thresholds of other programs as by gates: pass, warn or FAIL, and exit with 1 "
        "when one fails; repeatable. The page on quality in the documentation lists them.",
    )] = None

    def criteria(self, more: Sequence[str] = ()) -> "Criteria":
        """Return gates and profiles; gates may name figures of `more` too.

        Raises InputError: a gate that is none.
        """
        from meshonet.geometry.quality.criteria import Criteria

        if not (self.fail_on or self.profile):
            return Criteria()
        from meshonet.geometry.quality.gates import parse_gates

        return Criteria(
            parse_gates(self.fail_on or (), more), tuple(profile.value for profile in self.profile or ())
        )
# fmt: on
