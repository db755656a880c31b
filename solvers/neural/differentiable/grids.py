"""Functions from the four sides of a batch of domains to the nodes of its grids, with gradients."""

from collections.abc import Callable

import torch
from torch import Tensor

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.differentiable.implicit import Converged, Equations
from meshonet.solvers.neural.differentiable.transfinite import Sides, arc_lengths, interpolated
from meshonet.solvers.neural.differentiable.variational import Optimum
from meshonet.solvers.neural.differentiable.winslow import Winslow


def transfinite(south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
    """Return the nodes (..., ni, nj, 2) of transfinite interpolation, by arc length along the sides.

    Parameters
    ----------
    south, north : (..., ni, 2) nodes along xi, from west to east.
    west, east : (..., nj, 2) nodes along eta, from south to north; the corners are those of south and north.

    Raises
    ------
    InputError
        Tensors of other shapes, of unequal counts, of different dtypes or not of floating-point numbers.
    """
    return _batched(lambda sides: interpolated(sides, arc_lengths(sides)), south, north, west, east)


def winslow(south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
    """Return the nodes (..., ni, nj, 2) that solve Winslow's equations, to rounding.

    Gradients are those of the solution, by one linear system for each backward pass.

    Parameters
    ----------
    south, north, west, east : as in `transfinite`.

    Raises
    ------
    InputError
        As `transfinite`.
    SolverError
        The equations of a member of the batch did not converge, or it has a coordinate that is not
        finite; the message has its index.
    """
    return _solved(Winslow(), south, north, west, east)


def variational(south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
    """Return the nodes (..., ni, nj, 2) at the optimum of the variational functional, to rounding.

    The compiled solver computes the starts on the CPU. Gradients are those of the optimum, by one linear
    system for each backward pass; the weights that the solver chose are constant in them.

    Parameters
    ----------
    south, north, west, east : as in `transfinite`.

    Raises
    ------
    InputError
        As `transfinite`.
    SolverError
        No grid without folded cells was found for a member of the batch, or it has a coordinate that is
        not finite; the message has its index.
    """
    return _solved(Optimum(), south, north, west, east)


def _solved(equations: Equations, *given: Tensor) -> Tensor:
    def make(sides: Sides) -> Tensor:
        start = interpolated(sides, arc_lengths(sides))
        nodes: Tensor = Converged.apply(equations, start)[0]  # type: ignore[no-untyped-call]
        return nodes

    return _batched(make, *given)


def _batched(make: Callable[[Sides], Tensor], *given: Tensor) -> Tensor:
    """Return the nodes (..., ni, nj, 2); `make` takes sides (batch, 2, n) and returns (batch, 2, ni, nj)."""
    _check(*given)
    lead = torch.broadcast_shapes(*(side.shape[:-2] for side in given))
    wide = [side.expand(*lead, *side.shape[-2:]).reshape(-1, *side.shape[-2:]) for side in given]
    south, north, west, east = (side.double().movedim(-1, 1) for side in wide)
    nodes = make((south, north, west, east)).movedim(1, -1).to(given[0].dtype)
    return nodes.reshape(*lead, *nodes.shape[1:])


def _check(south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> None:
    """Raise InputError for sides that bound no batch of grids."""
    sides = {"south": south, "north": north, "west": west, "east": east}
    for name, side in sides.items():
        if side.ndim < 2 or side.shape[-1] != 2 or side.shape[-2] < 3 or not side.numel():
            raise InputError(f"{name} has shape {tuple(side.shape)}", "give (..., n, 2) with n at least 3")
        if not side.is_floating_point() or side.dtype != south.dtype or side.device != south.device:
            problem = f"{name} is {side.dtype} on {side.device} and south {south.dtype} on {south.device}"
            raise InputError(problem, "give floating-point numbers of one type on one device")
    for first, second in (("south", "north"), ("west", "east")):
        counts = [sides[name].shape[-2] for name in (first, second)]
        if counts[0] != counts[1]:
            problem = f"{first} has {counts[0]} nodes and {second} {counts[1]}"
            raise InputError(problem, "opposite sides need equal counts")
    try:
        torch.broadcast_shapes(*(side.shape[:-2] for side in sides.values()))
    except RuntimeError:
        shapes = ", ".join(str(tuple(side.shape[:-2])) for side in sides.values())
        raise InputError(f"the sides are of different batches: {shapes}", "give as many of each") from None
