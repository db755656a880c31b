"""What the quad operator is trained on: Winslow's and variational grids of the same domains, normalised.

Domains around bodies are unrolled.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.quad.edges import Edges, rims
from meshonet.solvers.neural.quad.encoding import HEADS, LATENT, frame
from meshonet.solvers.neural.quad.picard import approached
from meshonet.solvers.neural.quad.unrolled import AROUND, even, factors, middles, unrolled
from meshonet.solvers.neural.samples import Samples, gathered


@dataclass(frozen=True)
class Quads:
    """m domains of unit size: `base`, `winslow` and `variational` grids (m, n, n), complex64.

    The base, with the last `step` to it, is what `approach` makes of transfinite grids. Domains `around`
    bodies are unrolled, (m, 65, n), and theirs begins with even steps from wall to wall.
    """

    base: Tensor
    step: Tensor
    winslow: Tensor
    variational: Tensor
    around: bool = False

    def __len__(self) -> int:
        return len(self.base)

    def __getitem__(self, rows: Any) -> Quads:
        return Quads(
            self.base[rows], self.step[rows], self.winslow[rows], self.variational[rows], self.around
        )


def quads_of(datasets: Iterable[Iterable[Grid]]) -> Quads:
    """Return the domains that datasets of Winslow's and of variational grids have in common, normalised.

    A dataset's first grid says by which method all of it was solved; several may be of one method.

    Raises
    ------
    InputError
        no grids; grids of one of the methods only, or of others; as `quads`.
    """
    groups: dict[str, list[Grid]] = {}
    for dataset in datasets:
        grids = list(dataset)
        if grids:
            method = str(grids[0].provenance.get("method", "an unknown method"))
            groups.setdefault(method, []).extend(grids)
    if not groups:
        return quads(gathered([]), gathered([]))
    if sorted(groups) != sorted(HEADS):
        raise InputError(
            f"grids by {' and '.join(sorted(groups))} for the quad operator",
            "give grids of the same boundaries by winslow and by variational",
        )
    return quads(gathered(groups["variational"]), gathered(groups["winslow"]))


def quads(variational: Samples, winslow: Samples) -> Quads:
    """Return the domains whose grids are in both datasets, normalised.

    Raises
    ------
    InputError
        grids that are not quads of `LATENT` nodes along xi and eta, nor O grids of `AROUND` along xi; no
        domain in common.
    """
    around = variational.topology == "o"
    ni = AROUND if around else LATENT
    for samples in (variational, winslow):
        if (samples.topology, samples.ni, samples.nj) != ("o" if around else "quad", ni, LATENT):
            raise InputError(
                f"{samples.topology} grids of {samples.ni} x {samples.nj} nodes among those to train on",
                f"give quads of {LATENT} x {LATENT}, or O grids of {AROUND} x {LATENT}",
            )
    sides = slice(2 if around else 4)  # the cut of an O grid is no boundary
    where = {_rim(nodes, sides): k for k, nodes in enumerate(winslow.nodes)}
    rims = [_rim(nodes, sides) for nodes in variational.nodes]
    pairs = [(k, where[rim]) for k, rim in enumerate(rims) if rim in where]
    if not pairs:
        raise InputError("no domain is in both datasets", "solve the same boundaries with both methods")
    first, second = (list(rows) for rows in zip(*pairs, strict=True))
    goal, other = _complex(variational.nodes[first]), _complex(winslow.nodes[second])
    if around:
        return _unrolled(goal, other)
    base = transfinite(goal)
    middle, factor = frame(base, np)
    base, other, goal = ((z - middle[:, None, None]) * factor[:, None, None] for z in (base, other, goal))
    return _approached(base, other, goal)


def _unrolled(goal: Complexes, other: Complexes) -> Quads:
    """Return the domains around bodies that both grids go round once in the same sense."""
    centres = middles(goal[:, :-1, 0])
    (goal, once), (other, also) = unrolled(goal, centres), unrolled(other, centres)
    alike = np.abs(goal[:, :, -1] - other[:, :, -1]).max(axis=1) < 1e-6
    kept = once & also & alike
    goal, other = goal[kept], other[kept]
    factor = factors(goal)[:, None, None]
    return _approached(even(goal, goal.shape[2]) * factor, other * factor, goal * factor, around=True)


def _approached(base: Complexes, winslow: Complexes, variational: Complexes, around: bool = False) -> Quads:
    """Return domains by their grids, the base transfinite."""
    near, step = (p[:, 0] + 1j * p[:, 1] for p in approached(base, around))
    return Quads(_single(near), _single(step), _single(winslow), _single(variational), around)


def _single(z: Complexes) -> Tensor:
    return torch.from_numpy(z.astype(np.complex64))


def _rim(nodes: Floats, sides: slice) -> bytes:
    """Return what tells a domain from others."""
    return b"".join(side.tobytes() for side in (nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1])[sides])


def transfinite(z: Complexes) -> Complexes:
    """Return the transfinite grids (m, n, n) in the rims of the grids `z`."""
    edges = Edges(*(np.ascontiguousarray(side) for side in rims(np.stack([z.real, z.imag], axis=1))))
    planes = edges.interpolated(edges.laws())
    return np.asarray(planes[:, 0] + 1j * planes[:, 1])


def _complex(nodes: Floats) -> Complexes:
    return np.asarray(nodes[..., 0] + 1j * nodes[..., 1])
