"""Grids as functions of JAX arrays: the functions of torch, called by JAX on the host."""

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.errors import InputError


def in_jax(function: Callable[..., Tensor], nj: int | None = None) -> Callable[..., Any]:
    """Convert a function of `meshonet.layer` to a differentiable function of JAX arrays.

    `jax.grad`, `jax.vmap` and `jax.jit` apply to the result. `jax.grad` computes each grid twice.

    Parameters
    ----------
    function : callable
        One of ``transfinite``, ``winslow``, ``variational`` and ``conformal``, or an object of the class
        ``QuadGrids``, ``BodyGrids`` or ``AirfoilGrids``.
    nj : int, optional
        Number of nodes from wall to far field, for functions that make grids around bodies.

    Raises
    ------
    InputError
        JAX is not installed (``pip install jax``).
    """
    try:
        import jax
    except ImportError:
        raise InputError("in_jax needs JAX", "run pip install jax") from None
    more = () if nj is None else (nj,)

    def nodes_of(sides: tuple[Any, ...]) -> Any:
        lead = np.broadcast_shapes(*(side.shape[:-2] for side in sides))
        counts = sides[0].shape[-2], sides[2].shape[-2] if nj is None else nj
        return jax.ShapeDtypeStruct((*lead, *counts, 2), sides[0].dtype)

    def forward(*sides: Any) -> Any:
        with torch.no_grad():
            return function(*map(_tensor, sides), *more).numpy()

    def pulled(gradient: Any, *sides: Any) -> Any:
        tensors = [_tensor(side).requires_grad_() for side in sides]
        gradients = torch.autograd.grad(function(*tensors, *more), tensors, _tensor(gradient))
        return tuple(values.numpy() for values in gradients)

    def called(*sides: Any) -> Any:
        return jax.pure_callback(forward, nodes_of(sides), *sides, vmap_method="broadcast_all")

    nodes = jax.custom_vjp(called)

    def kept(*sides: Any) -> Any:
        return nodes(*sides), sides

    def back(sides: Any, gradient: Any) -> Any:
        like = tuple(jax.ShapeDtypeStruct(side.shape, side.dtype) for side in sides)
        return jax.pure_callback(pulled, like, gradient, *sides, vmap_method="broadcast_all")

    nodes.defvjp(kept, back)
    return nodes


def _tensor(values: Any) -> Tensor:
    return torch.tensor(np.asarray(values))
