"""Grids as layers of a network: batches of boundaries in torch in, nodes out, with gradients.

    import torch
    from meshonet import layer

    nodes = layer.winslow(south, north, west, east)   # (batch, ni, nj, 2)
    nodes.square().mean().backward()                  # gradients of the boundary nodes

Sides are tensors (..., n, 2), south and north along xi, west and east along eta, with shared corners; any number
of leading dimensions is a batch. Tensors stay on their device; the arithmetic is in double precision, the nodes
are of the dtype of the sides. `torch.func.vmap` and `torch.func.grad` apply to every function. It needs torch,
the extra ``train``.
"""

from meshonet.solvers.differentiable import AirfoilGrids, BodyGrids, QuadGrids
from meshonet.solvers.differentiable.grids import transfinite, variational, winslow

__all__ = ["AirfoilGrids", "BodyGrids", "QuadGrids", "transfinite", "variational", "winslow"]
