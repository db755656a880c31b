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
    """Return a deformed grid and the derivative of its nodes with respect to the nodes of its walls.

    Parameters
    ----------
    grid : Grid, str or Path
        A planar grid, or a file with one.
    wall : str, Path, Grid, Boundary, Motion or array, or dict of these by name
        New shape of the walls, as for `meshonet.deform`.

    Returns
    -------
    DeformationDerivative
        ``grid`` is the deformed grid, ``walls`` has the node numbers of each wall by name. ``along(moves)``
        returns the displacements of all nodes for displacements (n, 2) of the nodes of each wall by name.
        ``transposed(pull)`` returns the derivative of a functional by the wall nodes, from its derivative
        (ni, nj, 2) by all nodes.

    Raises
    ------
    InputError
        As for `meshonet.deform`; also if the grid is a volume.
    NoValidGridError
        The deformation folds cells if it is applied in one step.

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
    """Return the derivative of a variational or Winslow grid with respect to its boundary nodes.

    Parameters
    ----------
    grid : Grid, str or Path
        A four-sided grid of one block that is close to the solution by `method`, or a file with such a grid.
        The boundary nodes are not moved.
    method : str, optional
        ``variational`` or ``winslow``.
    weights : Weights, optional
        Weights of the variational functional; None: the weights of `meshonet.solve_pde`.

    Returns
    -------
    OptimumDerivative
        ``grid`` is the grid, solved to rounding. ``along(moves)`` returns the displacements (ni, nj, 2) of
        all nodes for displacements (ni, nj, 2) of the boundary nodes. ``transposed(pull)`` returns the
        derivative of a functional by the boundary nodes, from its derivative (ni, nj, 2) by all nodes. Each
        call solves one linear system, whose factors are stored.

    Raises
    ------
    InputError
        The grid is an O grid, a volume, or has several blocks; the method is unknown.
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
