"""Are tensors what the differentiable operators take: nodes of sides, in batches."""

from __future__ import annotations

import torch
from torch import Tensor

from meshonet.geometry.errors import InputError


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
    for one, other in zip(names[::2], names[1::2], strict=True):
        if sides[one].shape != sides[other].shape:
            told = f"{one} has shape {tuple(sides[one].shape)} and {other} {tuple(sides[other].shape)}"
            raise InputError(told, "opposite sides need equal counts")
    if len({side.shape[0] for side in sides.values()}) > 1:
        raise InputError("the sides are of different batches", "give as many of every side")
