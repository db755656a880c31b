"""Grids as layers of a network: boundary tensors in, node tensors out, with gradients, for batches.

    import torch
    from meshonet import layer

    nodes = layer.winslow(south, north, west, east)   # (batch, ni, nj, 2)
    nodes.square().mean().backward()                  # gradients of the boundary nodes

Results have the device and the dtype of the sides; the arithmetic is in double precision. `torch.func.vmap`
and `torch.func.grad` can be applied to these functions. The module needs torch (extra ``train``).
"""

from meshonet.solvers.neural.devices import INSTALL_TORCH

try:
    import torch  # noqa: F401 - all below are functions of its tensors
except ModuleNotFoundError:
    raise ModuleNotFoundError(f"meshonet.layer needs torch; {INSTALL_TORCH}", name="torch") from None

from meshonet.solvers.neural.differentiable import AirfoilGrids, BodyGrids, QuadGrids
from meshonet.solvers.neural.differentiable.airfoil import conformal
from meshonet.solvers.neural.differentiable.grids import transfinite, variational, winslow
from meshonet.solvers.neural.differentiable.in_jax import in_jax

__all__ = [
    "AirfoilGrids",
    "BodyGrids",
    "QuadGrids",
    "conformal",
    "in_jax",
    "transfinite",
    "variational",
    "winslow",
]
