"""Options that say how the nodes of a boundary are placed."""

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from meshonet.geometry.spacing.laws import LAWS
from meshonet_cli.options.groups import SAMPLING, bad_value, option_of, values_of

if TYPE_CHECKING:
    from meshonet.geometry.spacing.sampling import Sampling

    SpacingName: TypeAlias = str
else:
    SpacingName = Literal[tuple(LAWS)]
# the library's choices, repeated because its module loads numpy; a test holds them equal
TopologyName = Literal["auto", "quad", "o", "c"]
_option = option_of(SAMPLING)

# fmt: off
Resolution = Annotated[str | None, _option(
    "--res", metavar="N|NIxNJ[xNK]",
    help="Nodes: N along every direction, or NI along xi (around a body) by NJ along eta (away from it), and "
    "NK along zeta of a volume. [default: the nodes of the input, or 200x100 around a curve]",
)]


@dataclass(frozen=True, kw_only=True)
class SamplingOptions:
    """How the nodes of a boundary are placed."""

    res: Resolution = None
    topology: Annotated[TopologyName, _option(
        "--topology", metavar="auto|quad|o|c", show_default=True,
        help="Kind of grid: four-sided (quad), O around a body, or C around an airfoil and its wake (NI "
        "counts both sides of the wake). auto takes C when a first cell is given and the edge is sharp.",
    )] = "auto"
    spacing: Annotated[SpacingName, _option(
        "--spacing", metavar="|".join(LAWS), show_default=True,
        help="Spacing of the nodes along walls.",
    )] = "auto"
    le_spacing: Annotated[float | None, _option(
        "--le-spacing", metavar="H", help="Length of the wall cell at the leading edge, in chords.",
    )] = None
    te_spacing: Annotated[float | None, _option(
        "--te-spacing", metavar="H", help="Length of the wall cell at the trailing edge, in chords.",
    )] = None
    te: Annotated[Literal["auto", "exact", "round", "wedge"], _option(
        "--te", metavar="auto|exact|round|wedge", show_default=True,
        help="Blunt trailing edges: exact keeps them, round rounds their two corners (grid angles there "
        "then deviate from 90 degrees by at most 10, not 45), wedge closes them by a wedge up to four "
        "base heights long. auto is exact, but wedge for C grids that are not marched, or have no first "
        "cell and a base of at most 0.005 chords.",
    )] = "auto"
    far_field: Annotated[float | None, _option(
        "--far-field", metavar="R",
        help="Least distance of the far field from the middle of the body, in chords; off a surface in "
        "space, in its unit. For lift and drag 100 chords or more. [default: 15; of a surface, 15 times its "
        "largest extent]",
    )] = None
    wake: Annotated[float | None, _option(
        "--wake", metavar="L",
        help="Length of a C grid's wake, in chords. [default: the distance of the far field]",
    )] = None
    wake_nodes: Annotated[int | None, _option(
        "--wake-nodes", metavar="N",
        help="Nodes of a C grid's wake, the trailing edge included; its cells grow by a constant ratio. "
        "[default: about a fifth of NI]",
    )] = None
    base_nodes: Annotated[int | None, _option(
        "--base-nodes", metavar="N",
        help="Nodes of a blunt trailing edge's base, its corners included; odd in an O grid, which begins in "
        "the middle of it. [default: by the cells beside it and its width]",
    )] = None
    smooth: Annotated[float | None, _option(
        "--smooth", metavar="TOL",
        help="Smooth an airfoil whose coordinates ripple, by splines within TOL chords of its points, say "
        "1e-4; its corners stay, and the report says what changed. Needs SciPy.",
    )] = None
    corners: Annotated[str, _option(
        "--corners", metavar="auto|I,J,K,L", show_default=True,
        help="Points of an outline, counted from 0, that become the corners of a four-sided grid, "
        "south-west first.",
    )] = "auto"
    normalise: Annotated[bool, _option(
        "--normalise", help="Move the leading edge to (0, 0) and the trailing edge to (1, 0).",
    )] = False

    def placed(self) -> "Sampling":
        """Return them for the library; raise InputError for what cannot be read or is out of range."""
        from meshonet.geometry.spacing.sampling import Sampling

        ni, nj, nk = (None, None, None) if self.res is None else resolution(self.res)
        given = values_of(SamplingOptions, self)
        del given["res"]
        corners = None if self.corners == "auto" else four_corners(self.corners)
        return Sampling(ni, nj, nk=nk, **given | {"corners": corners})
# fmt: on


def resolution(text: str) -> tuple[int, int, int | None]:
    """Return the node counts (ni, nj, nk) of ``N``, ``NIxNJ`` or ``NIxNJxNK``, or raise InputError.

    >>> resolution("200"), resolution("400x100"), resolution("33x33x65")
    ((200, 200, None), (400, 100, None), (33, 33, 65))
    """
    count = r"\s*(\d{1,9})\s*"
    match = re.fullmatch(rf"{count}(?:[xX]{count}(?:[xX]{count})?)?", text, re.ASCII)
    if match is None:
        remedy = "use N, NIxNJ or NIxNJxNK, e.g. 200 or 400x100"
        raise bad_value(text, "a number of nodes", remedy, "res")
    ni = int(match[1])
    return ni, int(match[2] or ni), int(match[3]) if match[3] else None


def four_corners(text: str) -> tuple[int, int, int, int]:
    """Return the four indices of ``I,J,K,L``, or raise InputError.

    >>> four_corners("0,10,20,30")
    (0, 10, 20, 30)
    """
    words = text.split(",")
    if len(words) != 4 or not all(re.fullmatch(r"\s*\d{1,9}\s*", word, re.ASCII) for word in words):
        raise bad_value(text, "four points", "use auto or I,J,K,L, e.g. 0,40,60,100", "corners")
    a, b, c, d = (int(word) for word in words)
    return a, b, c, d
