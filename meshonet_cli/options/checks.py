"""Options that say what a grid must be to be written, and what ends the program with 1."""

from dataclasses import dataclass
from typing import Annotated

from meshonet_cli.options.groups import CHECKS, option_of

_option = option_of(CHECKS)

# fmt: off
FailOn = Annotated[list[str] | None, _option(
    "--fail-on", metavar="GATE",
    help="Exit with 1 when this holds, e.g. 'max_angle>170', 'skewness.p99>0.8', 'folded>0'; repeatable.",
)]
AllowInvalid = Annotated[bool, _option(
    "--allow-invalid", help="Write the grid even when cells are folded.",
)]


@dataclass(frozen=True)
class CheckOptions:
    """What a grid must be."""

    repair: Annotated[bool | None, _option(
        "--repair/--no-repair",
        help="Unfold folded cells, or refuse grids that have any. [default: solve-pde and infer unfold, tfi "
        "refuses]",
    )] = None
    allow_invalid: AllowInvalid = False
    fail_on: FailOn = None
# fmt: on
