"""Arguments of the functions from sides to nodes: checks, batches, types."""

from collections.abc import Callable, Sequence
from typing import Any

import torch
from torch import Tensor

from meshonet.geometry.errors import InputError


def check_sides(least: int, nj: int = 2, **sides: Tensor) -> None:
    """Raise InputError unless `sides`, each a tensor (..., n, 2), can bound a batch of grids.

    Opposite sides follow each other: south, north, west, east. `least` is the least number of nodes of a
    side. `nj` is the number of nodes from wall to far field of grids around bodies.
    """
    names = list(sides)
    first = sides[names[0]]
    for name, side in sides.items():
        if not isinstance(side, Tensor):
            raise InputError(f"{name} is a {type(side).__name__}", "give tensors of torch")
        if side.ndim < 2 or side.shape[-1] != 2 or side.shape[-2] < least:
            problem = f"{name} has shape {tuple(side.shape)}"
            raise InputError(problem, f"give (..., n, 2) with n at least {least}")
        if not side.is_floating_point():
            raise InputError(f"{name} is {side.dtype}", "give floating-point numbers, float64 or float32")
        if side.dtype != first.dtype or side.device != first.device:
            problem = (
                f"{name} is {side.dtype} on {side.device} and {names[0]} {first.dtype} on {first.device}"
            )
            raise InputError(problem, "give floating-point numbers of one type on one device")
    for one, other in zip(names[::2], names[1::2], strict=True):
        counts = [sides[name].shape[-2] for name in (one, other)]
        if counts[0] != counts[1]:
            problem = f"{one} has {counts[0]} nodes and {other} {counts[1]}"
            raise InputError(problem, "opposite sides need equal counts")
    try:
        torch.broadcast_shapes(*(side.shape[:-2] for side in sides.values()))
    except RuntimeError:
        shapes = ", ".join(str(tuple(side.shape[:-2])) for side in sides.values())
        raise InputError(f"the sides are of different batches: {shapes}", "give as many of each") from None
    if nj < 2:
        raise InputError(f"nj is {nj} nodes", "use at least 2")


_CLOSE = 1e-5  # corners of two sides nearer than this fraction of the extent coincide


def check_corners(south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> None:
    """Raise InputError if sides of a grid do not meet at a corner; under `torch.vmap` nothing is checked."""
    pairs = {
        "south and west": (south[..., 0, :], west[..., 0, :]),
        "south and east": (south[..., -1, :], east[..., 0, :]),
        "north and west": (north[..., 0, :], west[..., -1, :]),
        "north and east": (north[..., -1, :], east[..., -1, :]),
    }
    extents = (side.amax(dim=-2) - side.amin(dim=-2) for side in (south, west))
    size = sum(extent.amax(dim=-1) for extent in extents)
    for words, (a, b) in pairs.items():
        apart = (a - b).abs().amax(dim=-1)
        wrong = (apart > _CLOSE * size).reshape(-1)
        try:
            if not wrong.any():
                continue
        except RuntimeError:
            return
        member = int(wrong.int().argmax())
        problem = f"{words} of member {member} end {float(apart.reshape(-1)[member]):.3g} apart"
        raise InputError(problem, "give sides with common corners")


def batched(
    make: Callable[..., Tensor], sides: Sequence[Tensor], nj: int | None = None,
    dtype: torch.dtype = torch.float64, device: str | torch.device | None = None,
) -> Tensor:  # fmt: skip
    """Return the nodes that `make` returns for `sides`, for any number of batch axes.

    Each of `sides` is a tensor (..., n, 2). `make` takes sides (batch, n, 2) of type `dtype` on `device`, and
    returns nodes (batch, ni, nj, 2). The result (..., ni, nj, 2) has the type and the device of `sides`. For
    grids around bodies, `nj` is the number of nodes from wall to far field.
    """
    if torch.is_inference_mode_enabled():  # solvers differentiate, which tensors of this mode do not allow
        with torch.inference_mode(False), torch.no_grad():
            return batched(make, [side.clone() for side in sides], nj, dtype, device)
    lead = torch.broadcast_shapes(*(side.shape[:-2] for side in sides))
    if 0 in lead:
        counts = sides[0].shape[-2], sides[2].shape[-2] if nj is None else nj
        return sum(side.sum() for side in sides) * sides[0].new_zeros(*lead, *counts, 2)
    wide = [side.expand(*lead, *side.shape[-2:]).reshape(-1, *side.shape[-2:]) for side in sides]
    nodes = make(*(side.to(device=device, dtype=dtype) for side in wide)).to(sides[0])
    return nodes.reshape(*lead, *nodes.shape[1:])


def unit_of(values: Tensor) -> Tensor:
    """Return a power of 2 near the range (maximum - minimum) of each batch member of `values` (batch, ...).

    The shape (batch, 1, ...) of the result broadcasts with `values`. Division by it is exact.
    """
    flat = values.detach().flatten(1)
    power = torch.frexp(flat.amax(1) - flat.amin(1)).exponent
    return torch.ldexp(torch.ones_like(flat[:, 0]), power).view(-1, *[1] * (values.ndim - 1))


def as_complex(planes: Tensor) -> Tensor:
    """Return the complex numbers x + iy (batch, ...) of coordinates `planes` (batch, 2, ...)."""
    return torch.complex(planes[:, 0], planes[:, 1])


def as_planes(z: Tensor) -> Tensor:
    """Return the coordinates x and y (batch, 2, ...) of complex numbers `z` (batch, ...)."""
    return torch.stack([z.real, z.imag], 1)


def as_numpy(values: Tensor) -> Any:
    """Return `values` as a NumPy array, without gradients."""
    return values.detach().cpu().numpy()
