"""Options that say how the nodes of a boundary are placed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from meshonet_cli.options.groups import SAMPLING, option_of

if TYPE_CHECKING:
    from meshonet.geometry.spacing.sampling import Sampling

# the library's own choices, repeated here because its modules load numpy; a test holds them equal
TopologyName = Literal["auto", "quad", "o", "c"]
SpacingName = Literal["auto", "conformal", "uniform", "cosine", "tanh", "curvature"]
_option = option_of(SAMPLING)

# fmt: off
Resolution = Annotated[str | None, _option(
    "--res", metavar="N|NIxNJ",
    help="Nodes: N x N, or NI along xi (around a body) by NJ along eta (away from it). [default: the nodes "
    "of the input, or 200x100 around a curve]",
)]
TopologyOption = Annotated[TopologyName, _option(
    "--topology", metavar="auto|quad|o|c", show_default=True,
    help="Kind of grid: four-sided (quad), O around a body, or C around an airfoil and its wake (NI counts "
    "both sides of the wake). auto takes C when a first cell is given and the edge is sharp.",
)]
SpacingOption = Annotated[SpacingName, _option(
    "--spacing", metavar="auto|conformal|uniform|cosine|tanh|curvature", show_default=True,
    help="Spacing of the nodes along walls.",
)]
LeSpacing = Annotated[float | None, _option(
    "--le-spacing", metavar="H",
    help="Length of the wall cell at the leading edge, in chords.",
)]
TeSpacing = Annotated[float | None, _option(
    "--te-spacing", metavar="H",
    help="Length of the wall cell at the trailing edge, in chords.",
)]
TrailingEdge = Annotated[Literal["auto", "exact", "round", "wedge"], _option(
    "--te", metavar="auto|exact|round|wedge", show_default=True,
    help="Blunt trailing edges: exact keeps them, round rounds their two corners (grid angles there then "
    "deviate from 90 degrees by at most 10, not 45), wedge closes them by a wedge up to four base "
    "heights long. auto is wedge for a C grid, else exact.",
)]
FarField = Annotated[float | None, _option(
    "--far-field", metavar="R",
    help="Distance of the far field, in chords. [default: 15]",
)]
Wake = Annotated[float | None, _option(
    "--wake", metavar="L",
    help="Length of a C grid's wake, in chords. [default: the distance of the far field]",
)]
WakeNodes = Annotated[int | None, _option(
    "--wake-nodes", metavar="N",
    help="Nodes of a C grid's wake, the trailing edge included; its cells grow by a constant ratio. "
    "[default: about a fifth of NI]",
)]
Corners = Annotated[str, _option(
    "--corners", metavar="auto|I,J,K,L", show_default=True,
    help="Points of an outline, counted from 0, that become the corners of a four-sided grid, south-west "
    "first.",
)]
Normalise = Annotated[bool, _option(
    "--normalise",
    help="Move the leading edge to (0, 0) and the trailing edge to (1, 0).",
)]
# fmt: on


@dataclass(frozen=True)
class SamplingOptions:
    """How the nodes of a boundary are placed."""

    res: Resolution = None
    topology: TopologyOption = "auto"
    spacing: SpacingOption = "auto"
    le_spacing: LeSpacing = None
    te_spacing: TeSpacing = None
    te: TrailingEdge = "auto"
    far_field: FarField = None
    wake: Wake = None
    wake_nodes: WakeNodes = None
    corners: Corners = "auto"
    normalise: Normalise = False

    def settings(self, **changes: Any) -> Sampling:
        """Return them for the library, with `changes`.

        Raises InputError: a value that cannot be read or is out of range.
        """
        words = vars(self) | changes
        return sampling(**words)


def sampling(
    res: str | None, topology: TopologyName, spacing: SpacingName, corners: str, **rest: Any
) -> Sampling:
    """Return the sampling settings that the options describe; `rest` goes to `Sampling` as it is.

    Raises InputError: a value that cannot be read or is out of range.
    """
    from meshonet.geometry.spacing.sampling import Sampling

    ni, nj = (None, None) if res is None else resolution(res)
    return Sampling(ni, nj, topology=topology, spacing=spacing, corners=four_corners(corners), **rest)


def resolution(text: str) -> tuple[int, int]:
    """Return the node counts (ni, nj) of ``N`` or ``NIxNJ``.

    Raises InputError: `text` is neither.

    >>> resolution("200"), resolution("400x100")
    ((200, 200), (400, 100))
    """
    match = re.fullmatch(r"\s*(\d{1,9})\s*(?:[xX]\s*(\d{1,9})\s*)?", text, re.ASCII)
    if match is None:
        from meshonet.geometry.errors import InputError

        remedy = "use N or NIxNJ, e.g. 200 or 400x100"
        raise InputError(f"{text!r} is not a number of nodes", remedy, parameter="res")
    ni = int(match[1])
    return ni, int(match[2] or ni)


def four_corners(text: str) -> tuple[int, int, int, int] | None:
    """Return the four indices of ``I,J,K,L``, or None for ``auto``.

    Raises InputError: `text` is neither.

    >>> four_corners("0,10,20,30"), four_corners("auto")
    ((0, 10, 20, 30), None)
    """
    if text == "auto":
        return None
    words = text.split(",")
    if len(words) != 4 or not all(re.fullmatch(r"\s*\d{1,9}\s*", word, re.ASCII) for word in words):
        from meshonet.geometry.errors import InputError

        remedy = "use auto or I,J,K,L, e.g. 0,40,60,100"
        raise InputError(f"{text!r} is not four points", remedy, parameter="corners")
    a, b, c, d = (int(word) for word in words)
    return a, b, c, d
