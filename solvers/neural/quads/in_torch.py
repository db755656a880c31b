"""The network of a quad model's file in torch, fixed."""

from __future__ import annotations

import torch

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.quad_unet import QuadUNet
from meshonet.solvers.neural.quads.model import head_of, load_quads
from meshonet.solvers.neural.weights import model_path


def loaded(
    model: str, topology: Topology, device: str, dtype: torch.dtype, remedy: str
) -> tuple[QuadUNet, int]:
    """Return the network of a shipped model, or of the path of a file, and the number of its answer.

    Raises
    ------
    InputError
        no such model, or one that cannot be read; it makes grids of another topology, for which `remedy`.
    """
    held = load_quads(model_path(model))
    if held.topology != topology:
        raise InputError(f"model {model} makes {held.topology} grids", remedy)
    network = QuadUNet(held.widths, held.blocks, around=topology == "o")
    network.load_state_dict({name: torch.from_numpy(one) for name, one in held.weights.items()})
    network.to(device=device, dtype=dtype).requires_grad_(False)
    return network, head_of(model, topology)
