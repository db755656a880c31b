"""The wall of a duct with a given throat that leaves the least skewed cells.

    python examples/shape-optimisation/throat.py [-o throat.vts]

The duct is 3 long and 1 high; its top comes down to 0.6 half way. Six waves shape the wall between. The grid
operator is differentiable, so the gradient of what the cells look like reaches the six numbers, and Adam
moves them. Needs torch: pip install 'meshonet[train]'.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import torch
from torch import Tensor

from meshonet.formats.vtk.vts import write_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.neural.differentiable import QuadGrids

LENGTH, HEIGHT, THROAT = 3.0, 1.0, 0.6
NODES = 121, 41
WAVES = 6
TYPE = torch.float32


def edges(shape: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return south, north (1, ni, 2), west and east (1, nj, 2) of the duct of `shape` (WAVES,)."""
    t, s = (torch.linspace(0.0, 1.0, n, dtype=TYPE) for n in NODES)
    waves = [torch.sin((2 * k + 1) * math.pi * t) * (-1.0) ** k for k in range(WAVES)]
    bump = (shape[:, None] * torch.stack(waves)).sum(0)
    top = HEIGHT - (HEIGHT - THROAT) * bump / bump[NODES[0] // 2]
    south, north = torch.stack([LENGTH * t, 0.0 * t], -1), torch.stack([LENGTH * t, top], -1)
    west = torch.stack([0.0 * s, HEIGHT * s], -1)
    return south[None], north[None], west[None], west[None] + torch.tensor([LENGTH, 0.0], dtype=TYPE)


def skewness(nodes: Tensor) -> Tensor:
    """Return the mean of cos² of the angles at the cells' corners of `nodes` (1, ni, nj, 2)."""
    u, v = nodes.diff(dim=1), nodes.diff(dim=2)
    corners = [(p, q) for p in (u[:, :, :-1], u[:, :, 1:]) for q in (v[:, :-1], v[:, 1:])]
    return torch.stack(
        [((p * q).sum(-1) ** 2 / ((p * p).sum(-1) * (q * q).sum(-1))).mean() for p, q in corners]
    ).mean()


def optimise(steps: int) -> tuple[list[float], Tensor]:
    """Return the skewness before each step and after the last, and the last grid's nodes (ni, nj, 2)."""
    torch.set_num_threads(1)  # tensors are small
    grids = QuadGrids("quad-general", dtype=TYPE)
    shape = torch.zeros(WAVES, dtype=TYPE)
    shape[0] = 1.0
    shape.requires_grad_()
    optimiser = torch.optim.Adam([shape], lr=0.02)
    found = []
    for _ in range(steps):
        optimiser.zero_grad()
        skew = skewness(grids(*edges(shape)))
        skew.backward()
        optimiser.step()
        found.append(float(skew.detach()))
    nodes = grids(*edges(shape)).detach()
    return [*found, float(skewness(nodes))], nodes[0]


def main() -> None:
    """Optimise and tell; write the last grid when asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, help="grid file to write")
    parser.add_argument("--steps", type=int, default=60)
    options = parser.parse_args()
    found, nodes = optimise(options.steps)
    print(
        f"mean of cos² at the corners: {found[0]:.5f} at first, {found[-1]:.5f} after {options.steps} steps"
    )
    if options.output:
        write_grids(options.output, [Grid.from_nodes(nodes.double().numpy())])


if __name__ == "__main__":
    main()
