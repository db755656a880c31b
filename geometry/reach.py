"""The largest grids that a request can ask for; beyond, it is refused before any work is done."""

from meshonet.geometry.errors import InputError

MOST_CELLS = 20_000_000
"""Cells of a grid where nobody says how many there are to be."""
MOST_REFINED = 200_000_000
"""Cells of one block in the plane whose cells are halved: 3 GB of nodes."""


def check_reach(
    count: float, things: str, cause: str, remedy: str, *, most: float = MOST_CELLS, parameter: str = ""
) -> None:
    """Raise InputError if what is asked for, the `cause`, takes a `count` of `things` above `most`.

    `parameter` is the Python name of the parameter that asks for it.
    """
    if not count <= most:
        problem = f"{cause} takes {count:.3g} {things}, more than {most:.3g}"
        raise InputError(problem, remedy, parameter=parameter)
