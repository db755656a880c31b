"""Options for the boundary nodes."""

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from meshonet.geometry.spacing.laws import LAWS
from meshonet_cli.options.groups import SAMPLING, bad_value, option_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from meshonet.geometry.spacing.sampling import Sampling
    from meshonet.solvers.pipeline.uses import Counts

    SpacingName: TypeAlias = str
else:
    SpacingName = Literal[tuple(LAWS)]
# the library's choices, repeated because its module loads numpy; a test holds them equal
TopologyName = Literal["auto", "quad", "o", "c"]
_option = option_of(SAMPLING)

# fmt: off
Resolution = Annotated[str | None, _option(
    "--res", metavar="N|NIxNJ[xNK]",
    help="Number of nodes along each direction: N for all directions, or NI along xi (around a body), NJ "
    "along eta (away from it) and NK along zeta (volumes). If --growth determines the number of rows, N is "
    "NI. For multi-block grids, number of cells along the longest extent. [default: the nodes of the input, "
    "or 200x100 for curves]",
)]


@dataclass(frozen=True, kw_only=True)
class SamplingOptions:
    """Distribution of the boundary nodes."""

    res: Resolution = None
    topology: Annotated[TopologyName, _option(
        "--topology", metavar="auto|quad|o|c", show_default=True,
        help="Topology of the grid: quad is four-sided, o surrounds a body, and c surrounds an airfoil and "
        "its wake (NI then includes both sides of the wake). auto selects c if a first cell is given and "
        "the trailing edge is sharp, else quad or o according to the input.",
    )] = "auto"
    spacing: Annotated[SpacingName, _option(
        "--spacing", metavar="|".join(LAWS), show_default=True,
        help="Distribution of the nodes along walls. conformal: equal steps on the circle to which a "
        "conformal map takes the body. uniform: equal steps along the wall. cosine: small cells at both "
        "ends. tanh: small cells of prescribed length at both ends. curvature: small cells at the ends and "
        "where the wall bends. auto: conformal around airfoils and smooth bodies, tanh around airfoils if "
        "--le-spacing or --te-spacing is given, curvature with a first cell, else uniform.",
    )] = "auto"
    le_spacing: Annotated[float | None, _option(
        "--le-spacing", metavar="H", help="Length of the wall cells at the leading edge, in chords.",
    )] = None
    te_spacing: Annotated[float | None, _option(
        "--te-spacing", metavar="H", help="Length of the wall cells at the trailing edge, in chords.",
    )] = None
    te: Annotated[Literal["auto", "exact", "round", "wedge"], _option(
        "--te", metavar="auto|exact|round|wedge", show_default=True,
        help="Treatment of blunt trailing edges: exact keeps their shape, round rounds the two corners, and "
        "wedge closes the base by a wedge of up to four base heights. At the corners, grid angles deviate "
        "from 90 degrees by about 45 with exact and by at most 10 with round. auto is wedge for a C grid "
        "that is not marched, or that has no first cell and a base of at most 0.005 chords; otherwise it is "
        "exact.",
    )] = "auto"
    far_field: Annotated[float | None, _option(
        "--far-field", metavar="R",
        help="Smallest distance of the far field from the middle of the body, in chords. For lift and drag "
        "use 100 or more. For a volume marched from a surface, the marching distance in the unit of the "
        "surface. [default: 15 chords, or 15 times the largest extent of the surface]",
    )] = None
    wake: Annotated[float | None, _option(
        "--wake", metavar="L",
        help="Length of the wake of a C grid, in chords. [default: the far-field distance]",
    )] = None
    wake_nodes: Annotated[int | None, _option(
        "--wake-nodes", metavar="N",
        help="Number of nodes along the wake of a C grid, including the trailing edge. The cells grow by a "
        "constant ratio. [default: about a fifth of NI]",
    )] = None
    base: Annotated[float | None, _option(
        "--base", metavar="T",
        help="Open trailing edges that are thinner than T chords to a base of this thickness, by moving both "
        "sides apart in proportion to the distance from the leading edge. --te then applies to this base.",
    )] = None
    base_nodes: Annotated[int | None, _option(
        "--base-nodes", metavar="N",
        help="Number of nodes on the base of a blunt trailing edge, including its two corners. It must be "
        "odd for an O grid, which starts in the middle of the base. [default: derived from the width of the "
        "base and the cells next to it]",
    )] = None
    smooth: Annotated[float | None, _option(
        "--smooth", metavar="TOL",
        help="Smooth an airfoil with noisy or rounded coordinates by splines, which deviate from the points "
        "by at most TOL chords. Choose about 3 times the standard deviation of the noise, or the unit of the "
        "last digit: 6e-4 for noise of 2e-4, 1e-4 for four decimals. A corner is kept if it is more than 2 "
        "TOL chords away from the straight line between the third point before it and the third point after "
        "it. A base lower than TOL chords is closed. The report gives the changes. Needs SciPy.",
    )] = None
    corners: Annotated[str, _option(
        "--corners", metavar="auto|I,J,K,L", show_default=True,
        help="Indices, from 0, of the four points of an outline that become the corners of a four-sided "
        "grid, starting in the south-west.",
    )] = "auto"
    normalise: Annotated[bool, _option(
        "--normalise", help="Move the leading edge to (0, 0) and the trailing edge to (1, 0).",
    )] = False

    def placed(self, layers: "Mapping[str, Any] | None" = None) -> "Sampling":
        """Return the options, with those of `layers`, as `Sampling`. Raises InputError: an invalid value."""
        from meshonet.geometry.spacing.sampling import Sampling
        from meshonet.solvers.pipeline.uses import counted

        fields = dict(vars(self))
        res = fields.pop("res")
        fields["corners"] = None if self.corners == "auto" else four_corners(self.corners)
        return Sampling(**fields, **counted(None if res is None else resolution(res), layers or {}))
# fmt: on


def resolution(text: str) -> "Counts":
    """Return the node counts of ``N``, ``NIxNJ`` or ``NIxNJxNK``. Raises InputError: other text.

    >>> resolution("200"), resolution("400x100"), resolution("33x33x65")
    (200, (400, 100), (33, 33, 65))
    """
    count = r"\s*(\d{1,9})\s*"
    match = re.fullmatch(rf"{count}(?:[xX]{count}(?:[xX]{count})?)?", text, re.ASCII)
    if match is None:
        remedy = "use N, NIxNJ or NIxNJxNK, e.g. 200 or 400x100"
        raise bad_value(text, "a number of nodes", remedy, "res")
    counts = tuple(map(int, filter(None, match.groups())))
    return counts if len(counts) > 1 else counts[0]  # type: ignore[return-value] # two or three


def four_corners(text: str) -> tuple[int, int, int, int]:
    """Return the four indices of ``I,J,K,L``. Raises InputError: other text.

    >>> four_corners("0,10,20,30")
    (0, 10, 20, 30)
    """
    words = text.split(",")
    if len(words) != 4 or not all(re.fullmatch(r"\s*\d{1,9}\s*", word, re.ASCII) for word in words):
        raise bad_value(text, "four points", "use auto or I,J,K,L, e.g. 0,40,60,100", "corners")
    a, b, c, d = (int(word) for word in words)
    return a, b, c, d
