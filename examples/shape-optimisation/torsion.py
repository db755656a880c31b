"""The section of a bar that is stiffest in torsion for its area, found through its grid.

    python examples/shape-optimisation/torsion.py [--nodes 33] [--steps 30] [--finite-differences]

A Winslow grid fills the section. As many waves as boundary nodes give the radii of these. Prandtl's stress
function solves a Poisson problem on the grid by bilinear finite elements. torch takes the gradient of the
stiffness back through elements and grid to the waves. Saint-Venant (1856): the stiffest section is the disc.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable

import torch
from torch import Tensor

from meshonet import layer

GAUSS = 0.5 * (1.0 - 1.0 / math.sqrt(3.0))  # place of the first of two Gauss points in an edge of length 1
STEP = 1e-6  # of finite differences


def grid(radii: Tensor) -> Tensor:
    """Return the nodes (n, n, 2) of the section with `radii` (4 n - 4,) at equal angles."""
    angle = torch.arange(len(radii), dtype=radii.dtype) * (2.0 * math.pi / len(radii)) - 0.75 * math.pi
    ring = radii[:, None] * torch.stack([angle.cos(), angle.sin()], 1)
    south, east, north, west = torch.cat([ring, ring[:1]]).unfold(0, len(radii) // 4 + 1, len(radii) // 4).mT
    return layer.winslow(south, north.flip(0), west.flip(0), east)


def stiffness(nodes: Tensor) -> Tensor:
    """Return the torsional stiffness over the squared area of the section; of a disc it is 1 / (2π)."""
    matrices, loads = elements(nodes)

    def times(values: Tensor) -> Tensor:
        return assembled(matrices @ at_corners(values)[..., None])

    right = assembled(loads)
    with torch.no_grad():
        stress = conjugate_gradients(times, right)
    work = 2.0 * (stress * right).sum() - (stress * times(stress)).sum()  # stationary in the stress function
    return 4.0 * work / loads.sum() ** 2


def elements(nodes: Tensor) -> tuple[Tensor, Tensor]:
    """Return stiffness matrices (n-1, n-1, 4, 4) and loads (n-1, n-1, 4, 1) of bilinear elements."""
    corners = at_corners(nodes)
    matrices, loads = 0.0, 0.0
    for s in (GAUSS, 1.0 - GAUSS):
        for t in (GAUSS, 1.0 - GAUSS):
            shape = torch.tensor([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t]).to(nodes)
            slopes = torch.tensor([[t - 1, 1 - t, -t, t], [s - 1, -s, 1 - s, s]]).to(nodes)
            jacobian = slopes @ corners
            size = 0.25 * torch.linalg.det(jacobian)[..., None, None]
            gradient = torch.linalg.solve(jacobian, slopes)
            matrices = matrices + size * (gradient.mT @ gradient)
            loads = loads + size * shape[:, None]
    return matrices, loads


def at_corners(values: Tensor) -> Tensor:
    """Return values (n, n, ...) at the four corners of each cell, (n-1, n-1, 4, ...)."""
    return torch.stack([values[:-1, :-1], values[1:, :-1], values[:-1, 1:], values[1:, 1:]], 2)


def assembled(parts: Tensor) -> Tensor:
    """Return the sums (n, n) at inner nodes of `parts` (n-1, n-1, 4, 1) of elements, 0 on the boundary."""
    pads = (0, 1, 0, 1), (0, 1, 1, 0), (1, 0, 0, 1), (1, 0, 1, 0)
    total = sum(torch.nn.functional.pad(parts[:, :, k, 0], pad) for k, pad in enumerate(pads))
    return torch.nn.functional.pad(total[1:-1, 1:-1], (1, 1, 1, 1))


def conjugate_gradients(times: Callable[[Tensor], Tensor], right: Tensor) -> Tensor:
    """Return the solution of a linear system with a positive definite matrix."""
    x, rest, way, size = torch.zeros_like(right), right, right, (right * right).sum()
    while size > 1e-24 * (right * right).sum():
        image = times(way)
        step = size / (way * image).sum()
        x, rest = x + step * way, rest - step * image
        size, before = (rest * rest).sum(), size
        way = rest + size / before * way
    return x


def optimise(nodes: int, steps: int, finite_differences: bool) -> tuple[Tensor, float, float]:
    """Return the radii of the best section, its stiffness and the seconds that it took."""
    count = 4 * (nodes - 1)
    numbers, angle = torch.arange(1, count + 1) // 2, torch.arange(count).double() * (2.0 * math.pi / count)
    phase = torch.where(torch.arange(1, count + 1) % 2 == 0, 0.0, 0.5 * math.pi)
    waves = torch.sin(angle[:, None] * numbers + phase) / (1.0 + numbers) ** 2  # short ones are small
    shape = torch.zeros(count, dtype=torch.float64)
    shape[[0, 3, 6]] = torch.tensor([1.0, 1.8, 1.6], dtype=torch.float64)
    shape.requires_grad_()
    optimiser = torch.optim.LBFGS(
        [shape], max_iter=steps, line_search_fn="strong_wolfe", tolerance_change=1e-12
    )
    begun, last = time.perf_counter(), 0.0

    def loss() -> Tensor:
        nonlocal last
        optimiser.zero_grad()
        value = -stiffness(grid(waves @ shape))
        if finite_differences:
            with torch.no_grad():
                moved = [
                    -stiffness(grid(waves @ (shape + STEP * unit))) for unit in torch.eye(count).double()
                ]
                shape.grad = (torch.stack(moved) - value) / STEP
        else:
            value.backward()
        last = -float(value.detach())
        return value

    optimiser.step(loss)
    return waves @ shape.detach(), last, time.perf_counter() - begun


def main() -> None:
    """Optimise and print the stiffness and the deviation from the disc."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--nodes", type=int, default=33, help="along each of the four sides")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--finite-differences", action="store_true")
    options = parser.parse_args()
    radii, best, seconds = optimise(options.nodes, options.steps, options.finite_differences)
    print(f"stiffness / area² {best:.5f}, of the disc {0.5 / math.pi:.5f}; {seconds:.1f} s")
    least, most = (float(radius / radii.mean()) for radius in (radii.min(), radii.max()))
    print(f"radii {least:.4f} to {most:.4f} of their mean")


if __name__ == "__main__":
    main()
