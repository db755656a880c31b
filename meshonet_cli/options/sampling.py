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
    "--res", metavar="N|NIxNJ[xNK]", help="Number of nodes: N along every direction, or NI along xi (around "
    "a body), NJ along eta (away from it) and NK along zeta (volumes). With --growth, N is NI only. In "
    "a multi-block grid N is the number of cells along its largest extent. [default: the nodes of the input; "
    "200x100 for airfoils and outlines]",
)]


@dataclass(frozen=True, kw_only=True)
class SamplingOptions:
    """Options for the distribution of boundary nodes."""

    res: Resolution = None
    topology: TopologyName = _option(
        default="auto", help="Topology of the grid. quad: four-sided. o: around a body. c: around an airfoil "
        "and its wake; NI includes both sides of the wake. auto: o around airfoils, but c if the trailing "
        "edge is sharp and a first-cell height is given (not in meshonet tfi); o around outlines with "
        "fewer than four convex corners; else quad.",
    )
    spacing: SpacingName = _option(
        default="auto", help="Distribution of the nodes along walls. uniform: equal cells. cosine, tanh: "
        "smaller cells at both ends of a side, or at leading and trailing edge. curvature: smaller cells "
        "also at bends. conformal: equal steps on the circle to which a conformal map takes the body. auto: "
        "curvature in C grids and, except in meshonet tfi, if a first-cell height is given; else conformal "
        "around airfoils and smooth bodies; else uniform.",
    )
    le_spacing: float | None = _option(
        metavar="H", help="Length of the wall cells at the leading edge, in chords. [default: set by "
        "--spacing]",
    )
    te_spacing: float | None = _option(
        metavar="H", help="Length of the wall cells at the trailing edge, in chords. [default: set by "
        "--spacing]",
    )
    te: Literal["auto", "exact", "round", "wedge"] = _option(
        default="auto", help="Shape of a blunt trailing edge. exact: unchanged. round: corners rounded. "
        "wedge: closed by a wedge. auto: exact in O grids, and in marched C grids if the base is higher "
        "than 0.005 chords or 10 first cells; else wedge.",
    )
    far_field: float | None = _option(
        metavar="R", help="Smallest distance of the far field from the middle of the body, in chords of a "
        "single airfoil, else in largest extents of all bodies together; for a marched volume in "
        "the unit of its surface. For lift and drag use 100 or more. [default: 15; for a volume 15 times the "
        "largest extent of its surface]",
    )
    wake: float | None = _option(
        metavar="L", help="Length of the wake of a C grid, from the trailing edge, in chords. [default: as "
        "--far-field]",
    )
    wake_nodes: int | None = _option(
        metavar="N", help="Number of nodes along the wake of a C grid, including the trailing edge. "
        "[default: about a fifth of NI]",
    )
    base: float | None = _option(
        metavar="T", help="Open a trailing edge thinner than T chords to this thickness. --te applies to the "
        "opened base. [default: unchanged]",
    )
    base_nodes: int | None = _option(
        metavar="N", help="Number of nodes on the base of a blunt trailing edge, including its two corners; "
        "odd for an O grid. [default: from the base height and the cells next to it]",
    )
    smooth: float | None = _option(
        metavar="TOL", help="Replace noisy or rounded airfoil coordinates by splines within TOL chords of "
        "the points. Give three standard deviations of the noise, or one unit of the last digit: 1e-4 for "
        "four decimals. A base lower than TOL is closed. Needs SciPy. [default: off]",
    )
    corners: str = _option(
        default="auto", metavar="auto|I,J,K,L", help="Indices, from 0, of the four points of an outline that "
        "become the corners of a four-sided grid, the south-west corner first. auto: the four sharpest "
        "corners.",
    )
    normalise: bool = _option(
        default=False, help="Scale, turn and move the airfoil: leading edge to (0, 0), trailing edge to (1, "
        "0).",
    )

    def placed(self, layers: "Mapping[str, Any] | None" = None) -> "Sampling":
        """Return these options as `Sampling`. If `layers` has a growth ratio, ``--res N`` sets only `ni`."""
        from meshonet.geometry.spacing.sampling import Sampling
        from meshonet.solvers.pipeline.uses import counted

        fields = dict(vars(self))
        res = fields.pop("res")
        fields["corners"] = None if self.corners == "auto" else four_corners(self.corners)
        return Sampling(**fields, **counted(None if res is None else resolution(res), layers or {}))
# fmt: on


def resolution(text: str) -> "Counts":
    """Return the node counts in ``N``, ``NIxNJ`` or ``NIxNJxNK``. Raises InputError: other text.

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
    """Return the four node indices in ``I,J,K,L``. Raises InputError: other text.

    >>> four_corners("0,10,20,30")
    (0, 10, 20, 30)
    """
    words = text.split(",")
    if len(words) != 4 or not all(re.fullmatch(r"\s*\d{1,9}\s*", word, re.ASCII) for word in words):
        raise bad_value(text, "four points", "use auto or I,J,K,L, e.g. 0,40,60,100", "corners")
    a, b, c, d = (int(word) for word in words)
    return a, b, c, d
