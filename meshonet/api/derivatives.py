"""`meshonet.deform_derivative` and `meshonet.optimum_derivative`."""

from collections.abc import Mapping
from pathlib import Path

from meshonet.api.deform import AnyWall, read_walls
from meshonet.api.quality import single_grid
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.derivatives.deformation import DeformationDerivative
from meshonet.solvers.derivatives.optimum import OptimumDerivative
from meshonet.solvers.energy.functional import Weights


def deform_derivative(
    grid: Grid | str | Path, wall: AnyWall | Mapping[str, AnyWall]
) -> DeformationDerivative:
    """Return the deformed grid with the derivative of its nodes by those of the walls.

    What is returned has the ``grid``; the numbers of the ``walls``' nodes by name; ``along(moves)``, the
    moves of all nodes when walls' make `moves` (n, 2) by name; and ``transposed(pull)``, the derivative of a
    functional by the walls' nodes from that by all nodes (ni, nj, 2).

    Parameters
    ----------
    grid : Grid, str or Path
        A planar grid, or a file that holds one.
    wall : str, Path, Grid, Boundary, Motion or array, or dict of these by name
        As of `meshonet.deform`.

    Returns
    -------
    DeformationDerivative

    Raises
    ------
    InputError
        As `meshonet.deform`, and a volume.
    NoValidGridError
        Cells fold in one step.

    Examples
    --------
    >>> import numpy as np, meshonet
    >>> start = meshonet.grid("naca:0012", res=(81, 31), te="wedge")
    >>> derivative = deform_derivative(start, "naca:1412")
    >>> by_wall = derivative.transposed(np.ones((81, 31, 2)))["wall"]
    >>> by_wall.shape
    (81, 2)
    """
    return DeformationDerivative(single_grid(grid), read_walls(wall))


def optimum_derivative(
    grid: Grid | str | Path, *, method: str = "variational", weights: Weights | None = None
) -> OptimumDerivative:
    """Return the derivative of a four-sided grid that solves equations by the nodes of its rim.

    What is returned has the ``grid``, the solution to rounding; ``along(moves)``, the moves (ni, nj, 2) of
    all nodes when those of the rim make `moves`; and ``transposed(pull)``, the derivative of a functional by
    the rim from that by all nodes. Each takes one solve with factors that are kept.

    Parameters
    ----------
    grid : Grid, str or Path
        One block with a fixed rim, near the solution by `method`, or a file that holds it.
    method : str, optional
        ``variational`` or ``winslow``.
    weights : Weights, optional
        Of the variational functional; None is what `meshonet.solve_pde` minimises.

    Returns
    -------
    OptimumDerivative

    Raises
    ------
    InputError
        An O grid, several blocks, a volume, an unknown method.
    SolverError
        The grid is far from the solution.

    Examples
    --------
    >>> import numpy as np, meshonet
    >>> x, y = np.meshgrid(np.linspace(0, 2, 17), np.linspace(0, 1, 9), indexing="ij")
    >>> duct = meshonet.solve_pde(Grid.from_nodes(np.stack([x, y], axis=-1)), res=(17, 9), method="winslow")
    >>> derivative = optimum_derivative(duct, method="winslow")
    >>> moves = np.zeros((17, 9, 2))
    >>> moves[:, -1, 1] = 1.0  # the roof is raised
    >>> float(derivative.along(moves)[8, 4, 1]) > 0.3
    True
    """
    return OptimumDerivative(single_grid(grid), method, weights)
