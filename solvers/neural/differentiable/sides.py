"""What differentiable operators take: nodes of sides in batches, and an operator by name or as an object."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.differentiable.quad_unet import QuadUNet
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.quad.operator import QuadOperator
from meshonet.solvers.neural.registry import load


def check_sides(dtype: torch.dtype, least: int, **sides: Tensor) -> None:
    """Raise InputError unless opposite sides are (batch, n, 2) alike, of `dtype`, n at least `least`.

    Parameters
    ----------
    sides : by name, each beside the one it is opposite to.
    """
    names = list(sides)
    for name, side in sides.items():
        shape = tuple(side.shape)
        if len(shape) != 3 or shape[2] != 2 or shape[1] < least or not shape[0]:
            raise InputError(f"{name} has shape {shape}", f"give (batch, n, 2) with n at least {least}")
        if side.dtype != dtype:
            raise InputError(f"{name} is {side.dtype}", f"give {dtype}")
    for first, second in zip(names[::2], names[1::2], strict=True):
        shapes = [tuple(sides[name].shape) for name in (first, second)]
        if shapes[0] != shapes[1]:
            problem = f"{first} has shape {shapes[0]} and {second} {shapes[1]}"
            raise InputError(problem, "opposite sides need equal counts")
    if len({side.shape[0] for side in sides.values()}) > 1:
        raise InputError("the sides are of different batches", "give as many of every side")


def check_levels(nj: int) -> None:
    """Raise InputError unless there is a wall and a far field."""
    if nj < 2:
        raise InputError(f"nj is {nj} nodes", "use at least 2")


def quad_network(
    model: str | Operator, topology: Topology, device: str, dtype: torch.dtype, remedy: str
) -> tuple[QuadUNet, int]:
    """Return the fixed network of a quad operator, and the number of its answer.

    Raises
    ------
    InputError
        no such model, or one that cannot be read; it makes grids of another topology, for which `remedy`.
    """
    operator = load(model) if isinstance(model, str) else model
    if not isinstance(operator, QuadOperator) or operator.topology != topology:
        raise InputError(f"model {operator.name} makes {operator.topology} grids", remedy)
    network = QuadUNet(operator.widths, operator.blocks, around=topology == "o")
    network.load_state_dict({name: torch.from_numpy(array) for name, array in operator.weights.items()})
    network.to(device=device, dtype=dtype).requires_grad_(False)
    return network, operator.head


def as_complex(planes: Tensor) -> Tensor:
    """Return planes (batch, 2, ...) of x and y as x + iy."""
    return torch.complex(planes[:, 0], planes[:, 1])


def as_numpy(values: Tensor) -> Any:
    """Return the values as an array of numpy, without gradients."""
    return values.detach().cpu().numpy()
