"""Functions from the four sides of a batch of domains to the nodes of its grids, with gradients."""

from collections.abc import Callable
from functools import partial

from torch import Tensor

from meshonet.solvers.algebraic.resample.grids import check_coarse
from meshonet.solvers.neural.differentiable.arguments import batched, check_corners, check_sides
from meshonet.solvers.neural.differentiable.implicit import Converged, Equations
from meshonet.solvers.neural.differentiable.members import Failed, check_failed
from meshonet.solvers.neural.differentiable.recorded import recorded
from meshonet.solvers.neural.differentiable.resample import Sides, arc_lengths, between, interpolated, refined
from meshonet.solvers.neural.differentiable.variational import Optimum
from meshonet.solvers.neural.differentiable.winslow import Winslow


def transfinite(south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
    """Return the nodes (..., ni, nj, 2) of transfinite interpolation with arc lengths as parameters.

    Parameters
    ----------
    south, north : (..., ni, 2) nodes along xi, from west to east.
    west, east : (..., nj, 2) nodes along eta, from south to north; all sides include the corners.

    Raises
    ------
    InputError
        Tensors of wrong shape or of different dtypes, or opposite sides with unequal node counts.
        Sides that do not meet at the corners (not checked under `vmap`).
    """
    return _four_sided(lambda sides: interpolated(sides, arc_lengths(sides)), south, north, west, east)


def winslow(
    south: Tensor, north: Tensor, west: Tensor, east: Tensor, *, coarse: int | None = None,
    failed: Failed = "raise",
) -> Tensor:  # fmt: skip
    """Return the nodes (..., ni, nj, 2) that solve Winslow's equations up to rounding errors.

    Gradients are derivatives of the converged solution; each backward pass solves one linear system.

    Parameters
    ----------
    south, north, west, east : as in `transfinite`.
    coarse : int, optional
        Greatest number of nodes per direction to solve for; the solution is then interpolated to all nodes.
    failed : {"raise", "nan"}
        With "nan", grids of the batch that have no solution get NaN nodes in place of SolverError. NaN nodes
        have no gradients.

    Raises
    ------
    InputError
        As for `transfinite`; also `coarse` below 9.
    SolverError
        The equations of a grid do not converge, or one of its coordinates is not finite. The message and the
        attribute ``members`` list the indices of such grids in the batch.
    """
    return _solved(Winslow(), coarse, failed, south, north, west, east)


def variational(
    south: Tensor, north: Tensor, west: Tensor, east: Tensor, *, coarse: int | None = None,
    failed: Failed = "raise",
) -> Tensor:  # fmt: skip
    """Return the nodes (..., ni, nj, 2) at the optimum of the variational functional, up to rounding errors.

    The compiled solver computes the initial grids on the CPU. Gradients are derivatives of the optimum; each
    backward pass solves one linear system. The weights of the functional count as constants.

    Parameters
    ----------
    south, north, west, east : as in `transfinite`.
    coarse : int, optional
        Greatest number of nodes per direction to optimise. The result is interpolated to all nodes, and is
        then not exactly optimal.
    failed : {"raise", "nan"}
        With "nan", members of the batch without an optimum get NaN nodes in place of SolverError.

    Raises
    ------
    InputError
        As for `winslow`; also more than about 400 x 400 nodes to solve for, which need too much memory.
    SolverError
        No grid without folded cells was found for a member of the batch, or one of its coordinates is not
        finite. The message and the attribute ``members`` list the indices of such members.
    """
    return _solved(Optimum(), coarse, failed, south, north, west, east)


def _solved(equations: Equations, coarse: int | None, failed: Failed, *four: Tensor) -> Tensor:
    check_failed(failed)
    if coarse is not None:
        check_coarse(coarse)

    def make(sides: Sides) -> Tensor:
        counts = [min(coarse or n, n) for n in (side.shape[-1] for side in sides)]
        few = tuple(between(side, n) for side, n in zip(sides, counts, strict=True))
        start = interpolated(few, arc_lengths(few))
        nodes: Tensor = Converged.apply(equations, start)[0]  # type: ignore[no-untyped-call]
        whole = coarse is None or coarse >= max(side.shape[-1] for side in sides)
        return nodes if whole else refined(nodes, sides)

    return _four_sided(make, *four, decides=coarse is not None or failed == "nan", failed=failed)


def _four_sided(
    make: Callable[[Sides], Tensor], south: Tensor, north: Tensor, west: Tensor, east: Tensor, *,
    decides: bool = False, failed: Failed = "raise",
) -> Tensor:  # fmt: skip
    """Return nodes (..., ni, nj, 2) by `make`, from sides (batch, 2, n); `decides`: by values of tensors."""
    check_sides(3, south=south, north=north, west=west, east=east)
    check_corners(south, north, west, east)

    def nodes(*sides: Tensor) -> Tensor:
        return make(tuple(side.movedim(-1, 1) for side in sides)).movedim(1, -1)

    counts = (south.shape[-2], west.shape[-2]) if failed == "nan" else None
    make_all = partial(recorded, nodes, counts=counts) if decides else nodes
    return batched(make_all, (south, north, west, east))
