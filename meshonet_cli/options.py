"""Options that several commands share, each said once."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

if TYPE_CHECKING:
    from meshonet.geometry.spacing.sampling import Sampling

# the library's own choices, repeated here because its modules load numpy; a test holds them equal
TopologyName = Literal["auto", "quad", "o", "c"]
SpacingName = Literal["auto", "conformal", "uniform", "cosine", "tanh", "curvature"]

# fmt: off
Boundaries = Annotated[
    list[str],
    typer.Argument(
        metavar="BOUNDARY", show_default=False,
        help="File with a boundary (airfoil, points, dataset, grid), naca:2412, or - for standard input.",
    ),
]
Grids = Annotated[
    list[str], typer.Argument(metavar="GRID", show_default=False, help="Grid file, or - for standard input.")
]
Output = Annotated[
    str,
    typer.Option(
        "-o", "--output", metavar="FILE", show_default=False,
        help="File to write, or - for standard output. For several inputs: 'dir/{stem}.vts' (also {name}, "
        "{index}) or one .h5.",
    ),
]
From = Annotated[
    str | None,
    typer.Option(
        "--from", metavar="FORMAT", show_default=False,
        help="Format of the input, when neither its ending nor its content says.",
    ),
]
To = Annotated[
    str | None,
    typer.Option(
        "--to", metavar="FORMAT", show_default=False,
        help="Format of the output, when its ending does not say. Standard output is hdf5 unless told.",
    ),
]
Resolution = Annotated[
    str | None,
    typer.Option(
        "--res", metavar="N|NIxNJ", show_default=False,
        help="Nodes: N x N, or NI along xi (around a body) by NJ along eta (away from it). "
        "[default: the nodes of the input, or 200x100 around a curve]",
    ),
]
TopologyOption = Annotated[
    TopologyName,
    typer.Option(
        "--topology", metavar="auto|quad|o|c",
        help="Kind of grid: four-sided (quad), O around a body, or C around an airfoil and its wake, NI "
        "counting both sides of the wake. auto takes C when a first cell is given and the edge is sharp.",
    ),
]
SpacingOption = Annotated[
    SpacingName,
    typer.Option(
        "--spacing",
        metavar="auto|conformal|uniform|cosine|tanh|curvature",
        help="Spacing of the nodes along walls.",
    ),
]
LeSpacing = Annotated[
    float | None,
    typer.Option(
        "--le-spacing", metavar="H", show_default=False, help="Wall cell at the leading edge, in chords."
    ),
]
TeSpacing = Annotated[
    float | None,
    typer.Option(
        "--te-spacing", metavar="H", show_default=False, help="Wall cell at the trailing edge, in chords."
    ),
]
FarField = Annotated[
    float | None,
    typer.Option(
        "--far-field", metavar="R", show_default=False,
        help="Distance of the far field, in chords. [default: 15]",
    ),
]
Wake = Annotated[
    float | None,
    typer.Option(
        "--wake", metavar="L", show_default=False,
        help="Length of a C grid's wake, in chords. [default: as far as the far field]",
    ),
]
WakeNodes = Annotated[
    int | None,
    typer.Option(
        "--wake-nodes", metavar="N", show_default=False,
        help="Nodes of a C grid's wake, the trailing edge included; its cells grow by one ratio from that "
        "at the edge. [default: about a fifth of NI]",
    ),
]
TrailingEdge = Annotated[
    Literal["auto", "exact", "round", "wedge"],
    typer.Option(
        "--te", metavar="auto|exact|round|wedge",
        help="Blunt trailing edges as they are (exact), with their two corners rounded (round), which brings "
        "the angles there from 45 to within 10 degrees of a right one, or closed by a wedge up to four bases "
        "long (wedge). auto is wedge for a C grid, and exact otherwise.",
    ),
]
Corners = Annotated[
    str,
    typer.Option(
        "--corners", metavar="auto|I,J,K,L",
        help="Points of an outline, counted from 0, that become the corners of a four-sided grid, "
        "south-west first.",
    ),
]
Normalise = Annotated[
    bool, typer.Option("--normalise", help="Move the leading edge to (0, 0) and the trailing edge to (1, 0).")
]
AllowInvalid = Annotated[
    bool, typer.Option("--allow-invalid", help="Write the grid even when cells are folded.")
]
FailOn = Annotated[
    list[str] | None,
    typer.Option(
        "--fail-on", metavar="GATE", show_default=False,
        help="Exit with 1 when this holds, e.g. 'max_angle>170', 'skewness.p99>0.8', 'folded>0'; repeatable.",
    ),
]
SkipExisting = Annotated[
    bool, typer.Option("--skip-existing", help="Pass over inputs whose output file is there already.")
]
Jobs = Annotated[
    int, typer.Option("--jobs", metavar="N", min=1, max=1024, help="Processes at work on a batch.")
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Print one JSON object on standard output for each result.")
]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="Print warnings and errors only.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of errors.")]
# fmt: on


def sampling(
    res: str | None, topology: TopologyName, spacing: SpacingName, corners: str, **rest: Any
) -> Sampling:
    """Return the sampling settings that the options describe; `rest` goes to `Sampling` as it is.

    Raises
    ------
    InputError
        a value that cannot be read or is out of range.
    """
    from meshonet.geometry.spacing.sampling import Sampling

    ni, nj = (None, None) if res is None else resolution(res)
    return Sampling(ni, nj, topology=topology, spacing=spacing, corners=four_corners(corners), **rest)


def resolution(text: str) -> tuple[int, int]:
    """Return the node counts (ni, nj) of ``N`` or ``NIxNJ``.

    Raises
    ------
    InputError
        `text` is neither.

    Examples
    --------
    >>> resolution("200"), resolution("400x100")
    ((200, 200), (400, 100))
    """
    found = re.fullmatch(r"\s*(\d{1,9})\s*(?:[xX]\s*(\d{1,9})\s*)?", text, re.ASCII)
    if found is None:
        from meshonet.geometry.errors import InputError

        raise InputError(
            f"{text!r} is not a number of nodes", "use N or NIxNJ, e.g. 200 or 400x100", source="--res"
        )
    ni = int(found[1])
    return ni, int(found[2] or ni)


def four_corners(text: str) -> tuple[int, int, int, int] | None:
    """Return the four indices of ``I,J,K,L``, or None for ``auto``.

    Raises
    ------
    InputError
        `text` is neither.

    Examples
    --------
    >>> four_corners("0,10,20,30"), four_corners("auto")
    ((0, 10, 20, 30), None)
    """
    if text == "auto":
        return None
    words = text.split(",")
    if len(words) != 4 or not all(re.fullmatch(r"\s*\d{1,9}\s*", word, re.ASCII) for word in words):
        from meshonet.geometry.errors import InputError

        problem = f"{text!r} is not four points"
        raise InputError(problem, "use auto or I,J,K,L, e.g. 0,40,60,100", source="--corners")
    a, b, c, d = (int(word) for word in words)
    return a, b, c, d


def polish_steps(text: str) -> Literal["auto", "off"] | int:
    """Return the steps of ``auto``, ``off`` or a number.

    Raises
    ------
    InputError
        `text` is none of them.

    Examples
    --------
    >>> polish_steps("off"), polish_steps("3")
    ('off', 3)
    """
    if text == "auto":
        return "auto"
    if text == "off":
        return "off"
    if not re.fullmatch(r"\d{1,3}", text, re.ASCII):
        from meshonet.geometry.errors import InputError

        raise InputError(f"{text!r} is not a number of steps", "use auto, off or e.g. 2", source="--polish")
    return int(text)


def coarse_nodes(text: str) -> Literal["auto"] | int | None:
    """Return the nodes of ``auto``, ``off`` (None; 0 is the same) or a number from 9 on.

    Raises
    ------
    InputError
        `text` is none of them.

    Examples
    --------
    >>> coarse_nodes("auto"), coarse_nodes("off"), coarse_nodes("65")
    ('auto', None, 65)
    """
    if text == "auto":
        return "auto"
    if text in ("off", "0"):
        return None
    if not re.fullmatch(r"[0-9]{1,6}", text) or int(text) < 9:
        from meshonet.geometry.errors import InputError

        raise InputError(
            f"{text!r} is not a number of nodes from 9 on", "use auto, off or e.g. 65", source="--coarse"
        )
    return int(text)


def tolerance(value: float | None) -> float | None:
    """Return `value`, which must be between 0 and 1 when it is given.

    Raises
    ------
    InputError
        it is not.
    """
    if value is not None and not 0 < value < 1:
        from meshonet.geometry.errors import InputError

        raise InputError(f"{value:g} is not between 0 and 1", "use e.g. 1e-8", source="--tol")
    return value


def either(sources: list[str] | None, family: str | None) -> None:
    """Raise InputError unless there are either sources or a family."""
    if bool(sources) == bool(family):
        from meshonet.geometry.errors import InputError

        problem = "both a source and --family" if sources else "neither a source nor --family"
        raise InputError(problem, "give one of them, see meshonet sample-boundary --help")


def only_with(needed: str, given: bool, **others: object) -> None:
    """Raise InputError when an option that needs another one is given (not None) without it.

    Parameters
    ----------
    needed : the other option.
    given : whether it is there.
    others : values by option, dashes as underscores.
    """
    if given:
        return
    for name, value in others.items():
        if value is not None:
            from meshonet.geometry.errors import InputError

            option = "--" + name.replace("_", "-")
            raise InputError(f"{option} without {needed}", f"give {needed} as well, or drop {option}")
