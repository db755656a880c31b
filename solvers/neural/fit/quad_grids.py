"""Training data of the quad operator: Winslow's and variational grids of the same domains, normalised."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Complexes, Floats, complex_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.quad.coarse_grids import rims, transfinite
from meshonet.solvers.neural.quad.encoding import HEADS, LATENT, frame, planes_of
from meshonet.solvers.neural.quad.picard import approach
from meshonet.solvers.neural.quad.unrolled import AROUND, even, factors, middles, unrolled
from meshonet.solvers.neural.samples import Samples, gathered


@dataclass(frozen=True)
class Quads:
    """Training grids of m domains of unit size, as complex arrays (m, n, n).

    `winslow` and `variational` are the target grids. `base` are transfinite grids after a few Picard steps,
    and `step` is the displacement in the last step. With `around`, the arrays (m, 65, n) are O grids mapped
    to strips by a complex logarithm.
    """

    base: Tensor
    step: Tensor
    winslow: Tensor
    variational: Tensor
    around: bool = False

    def __len__(self) -> int:
        return len(self.base)

    def __getitem__(self, rows: Any) -> "Quads":
        base, step, winslow, variational = (grids[rows] for grids in self.grids())
        return Quads(base, step, winslow, variational, self.around)

    def grids(self) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return the fields `base`, `step`, `winslow` and `variational`, in this order."""
        return self.base, self.step, self.winslow, self.variational


def quads_of(datasets: Iterable[Iterable[Grid]]) -> Quads:
    """Return the domains for which `datasets` have a grid by ``winslow`` and a grid by ``variational``.

    The first grid of a dataset tells its method. Raises InputError if another method occurs, if one of the
    two is missing, or if `quads` raises it.
    """
    groups: dict[str, list[Grid]] = {}
    for dataset in datasets:
        if grids := list(dataset):
            method = str(grids[0].provenance.get("method", "an unknown method"))
            groups.setdefault(method, []).extend(grids)
    if groups and sorted(groups) != sorted(HEADS):
        problem = f"grids by {' and '.join(sorted(groups))} for the quad operator"
        raise InputError(problem, "give grids of the same boundaries by winslow and by variational")
    winslow, variational = (gathered(groups.get(method, [])) for method in HEADS)
    return quads(variational, winslow)


def quads(variational: Samples, winslow: Samples) -> Quads:
    """Return the domains whose grids are in both datasets, scaled to unit size.

    Raises InputError if no domain is in both. All grids must be four-sided with `LATENT` nodes along xi and
    eta, or all must be O grids with `AROUND` nodes along xi.
    """
    around = variational.topology == "o"
    wanted = ("o", AROUND, LATENT) if around else ("quad", LATENT, LATENT)
    for samples in (variational, winslow):
        if (samples.topology, samples.ni, samples.nj) != wanted:
            problem = f"{samples.topology} grids of {samples.ni} x {samples.nj} nodes among those to train on"
            raise InputError(problem, f"give quads of {LATENT} x {LATENT}, or O grids of {AROUND} x {LATENT}")
    sides = slice(2 if around else 4)  # the cut of an O grid is no boundary
    where = {_rim(nodes, sides): k for k, nodes in enumerate(winslow.nodes)}
    keys = [_rim(nodes, sides) for nodes in variational.nodes]
    pairs = [(k, where[key]) for k, key in enumerate(keys) if key in where]
    if not pairs:
        raise InputError("no domain is in both datasets", "solve the same boundaries with both methods")
    first, second = (list(rows) for rows in zip(*pairs, strict=True))
    best, solved = complex_of(variational.nodes[first]), complex_of(winslow.nodes[second])
    if around:
        return _unrolled(best, solved)
    planes = transfinite(rims(planes_of(best)))
    base = planes[:, 0] + 1j * planes[:, 1]
    middle, factor = (value[:, None, None] for value in frame(base, np))
    return _approached(*((z - middle) * factor for z in (base, solved, best)))


def _unrolled(best: Complexes, solved: Complexes) -> Quads:
    """Return the domains around bodies around which both grids wind once in the same sense."""
    centres = middles(best[:, :-1, 0])
    (best, once), (solved, also) = unrolled(best, centres), unrolled(solved, centres)
    kept = once & also & (np.abs(best[:, :, -1] - solved[:, :, -1]).max(axis=1) < 1e-6)
    best, solved = best[kept], solved[kept]
    factor = factors(best)[:, None, None]
    return _approached(even(best, best.shape[2]) * factor, solved * factor, best * factor, around=True)


def _approached(base: Complexes, winslow: Complexes, variational: Complexes, around: bool = False) -> Quads:
    """Return the domains of these grids; `base` is transfinite, and brought nearer to Winslow's here."""
    near, step = approach(base, np, around)
    return Quads(_single(near), _single(step), _single(winslow), _single(variational), around)


def _single(z: Complexes) -> Tensor:
    return torch.from_numpy(z.astype(np.complex64))


def _rim(nodes: Floats, sides: slice) -> bytes:
    return b"".join(side.tobytes() for side in (nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1])[sides])
