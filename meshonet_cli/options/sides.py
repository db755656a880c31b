"""Options for first cells at single sides, of the commands that take four-sided domains."""

from dataclasses import dataclass
from typing import Annotated

from meshonet_cli.options.groups import BOUNDARY_LAYER, option_of

_option = option_of(BOUNDARY_LAYER)


# fmt: off
@dataclass(frozen=True, kw_only=True)
class SideOptions:
    """First cells at single sides of four-sided domains."""

    spacing_south: Annotated[float | None, _option(
        "--spacing-south", metavar="H",
        help="Height of the first cell at the south side of a four-sided domain, in the unit of the input. "
        "[default: the height that --first-cell gives]",
    )] = None
    spacing_north: Annotated[float | None, _option(
        "--spacing-north", metavar="H", help="The same for the north side.",
    )] = None
    spacing_west: Annotated[float | None, _option(
        "--spacing-west", metavar="H", help="The same for the west side.",
    )] = None
    spacing_east: Annotated[float | None, _option(
        "--spacing-east", metavar="H", help="The same for the east side.",
    )] = None
# fmt: on
