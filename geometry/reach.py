"""The largest grids that a request can ask for; beyond, it is refused before any work is done."""

from meshonet.geometry.errors import InputError

MOST_CELLS = 20_000_000  # largest number of cells of a grid if the request does not prescribe a number
MOST_REFINED = 200_000_000  # largest number of cells of a planar block after refinement: 3 GB of nodes


def check_reach(
    count: float, things: str, cause: str, remedy: str, *, most: float = MOST_CELLS, parameter: str = ""
) -> None:
    """Raise InputError if a request needs more than `most` cells, nodes or other things.

    Parameters
    ----------
    count, things : number that the request needs, and what is counted, such as cells.
    cause, remedy : texts of the error: what needs so many, and what to change.
    parameter : name of the Python argument that asks for so many, for the error; "" if there is none.
    """
    if not count <= most:
        problem = f"{cause} takes {count:.3g} {things}, more than {most:.3g}"
        raise InputError(problem, remedy, parameter=parameter)
