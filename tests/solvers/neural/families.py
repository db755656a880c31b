"""Small solved families for tests of training, written out by hand so that no solver is involved."""

import numpy as np
import torch

from meshonet.solvers.neural.samples import Samples

torch.set_num_threads(1)  # tests run side by side


def arches(count: int = 6, n: int = 9) -> Samples:
    """Channels under an arch of height 0 to 0.5, with every fourth one kept for tests."""
    heights = np.linspace(0.0, 0.5, count)
    xi, eta = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    arch = np.sin(np.pi * xi)
    x = [xi + 0.1 * h * np.sin(2 * np.pi * xi) * np.sin(np.pi * eta) for h in heights]
    y = [eta * (1 + h * arch) - 0.1 * h * arch * np.sin(np.pi * eta) for h in heights]
    return _samples(np.stack([np.array(x), np.array(y)], axis=-1), heights, "quad")


def rings(count: int = 6, n: int = 17) -> Samples:
    """O grids between an ellipse of height 0.5 to 1 and a circle, clockwise."""
    heights = np.linspace(0.5, 1.0, count)
    angle, r = np.meshgrid(-2 * np.pi * np.arange(n) / (n - 1), np.linspace(1.0, 4.0, 9), indexing="ij")
    angle[-1] = angle[0]
    squash = [1 + (h - 1) * (4.0 - r) / 3.0 * r**0.5 for h in heights]
    nodes = [np.stack([r * np.cos(angle), s * r * np.sin(angle)], axis=-1) for s in squash]
    return _samples(np.array(nodes), heights, "o")


def _samples(nodes: np.ndarray, parameters: np.ndarray, topology: str) -> Samples:
    names = tuple(f"shape-{k}" for k in range(len(nodes)))
    splits = tuple("test" if k % 4 == 2 else "train" for k in range(len(nodes)))
    return Samples(nodes, topology, names, splits, parameters)  # type: ignore[arg-type]
