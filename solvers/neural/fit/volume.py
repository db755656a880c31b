"""Training of 3DMeshNet: Peng, Chen & Liu, arXiv 2407.01560.

Kendall, Gal & Cipolla, arXiv 1705.07115 (weights); Yu et al., arXiv 2001.06782 (projected gradients).
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.six_faces import FACES, SixFaces
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import folded_cells
from meshonet.solvers.neural.fit.loop import Run, Task
from meshonet.solvers.neural.fit.model_task import tensor, tensors
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.model_file import VOLUME, write_model
from meshonet.solvers.neural.models.architectures import with_settings
from meshonet.solvers.neural.models.layers import dense, initial
from meshonet.solvers.neural.volumes.network import VolumeMeshNet, VolumeNetwork, scales

PLAN = Plan(epochs=15_000, points=(1000, 600))
HELD_OUT = 0


class VolumeTask(Task):
    """Training of a network per volume; `points` are numbers of points per step: inside, and on the faces."""

    parts = ("winslow", "faces", "weights")

    def __init__(
        self, model: VolumeMeshNet, volumes: Sequence[SixFaces], points: tuple[int, int], seed: int,
        device: torch.device,
    ) -> None:  # fmt: skip
        super().__init__()
        self.model, self.volumes, self.points, self.seed = model, volumes, points, seed
        self.count = len(volumes)
        rng = np.random.default_rng([seed, 0])
        for name, value in initial(model.shapes(self.count), rng).items():
            self.register_parameter(name, nn.Parameter(tensor(value)))
        self.spread = nn.Parameter(torch.tensor([0.0, -float(np.log(model.rim))]))
        self.fixed = scales(volumes)
        centre, size = self.fixed["fixed/centre"], self.fixed["fixed/size"]
        places = zip(volumes, centre, size, strict=True)
        rims = [_rim(faces) for faces in volumes]
        self.places = tensors({str(k): at for k, (at, _) in enumerate(rims)}, device)
        nodes = {str(k): (u - c) / s for k, ((_, u), (_, c, s)) in enumerate(zip(rims, places, strict=True))}
        self.rims = tensors(nodes, device)
        self.to(device)

    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the terms of the loss, averaged over the volumes `rows` (indices), which have unit size.

        ::

            loss = sum over both terms of exp(-s) L / 2 + s / 2   s: log of the term's variance, trained
            L_winslow = mean |sum_ij a_ij X_ij|^2                 a: adjugate of metric, X_ij: 2nd derivatives
            L_faces   = mean |X - U|^2                            X: predicted nodes, U: nodes of the faces
        """
        rng = np.random.default_rng([self.seed, 1, step])
        inner = tensor(rng.uniform(-1.0, 1.0, (self.points[0], 3))).to(rows.device)
        draws = rng.random(self.points[1])
        winslow, faces = [], []
        for k in rows.tolist():
            net = {key: value[k : k + 1] for key, value in self.named_parameters() if key != "spread"}
            winslow.append((residual(net, inner, 2.0 * self.model.finite) ** 2).sum(-1).mean())
            some = torch.from_numpy((draws * len(self.rims[str(k)])).astype(np.int64)).to(rows.device)
            answer = dense(torch, net, "net", self.places[str(k)][some][None])[0]
            faces.append(((answer - self.rims[str(k)][some]) ** 2).sum(-1).mean())
        both = torch.stack([torch.stack(winslow).mean(), torch.stack(faces).mean()])
        return torch.cat([0.5 * torch.exp(-self.spread) * both, 0.5 * self.spread.sum()[None]])

    def differentiate(self, parts: Tensor, team: Team) -> None:
        """Compute the gradient of the loss, which is the sum of `parts`, with respect to the parameters.

        With `model.projected`, gradients of the first two parts lose components that oppose each other.
        """
        if not self.model.projected:
            super().differentiate(parts, team)
            return
        weights = [value for key, value in self.named_parameters() if key != "spread"]
        each = (torch.autograd.grad(part, weights, retain_graph=True) for part in parts[:2])
        summed = project(*(torch.cat([gradient.reshape(-1) for gradient in own]) for own in each))
        (self.spread.grad,) = torch.autograd.grad(parts.sum(), [self.spread])
        self.spread.grad = team.mean(self.spread.grad)
        summed = team.mean(summed)
        for value, gradient in zip(weights, summed.split([w.numel() for w in weights]), strict=True):
            value.grad = gradient.view_as(value)

    def network(self, name: str = "trained") -> VolumeNetwork:
        """Return the network, called `name`, with the current weights for all volumes."""
        own = {key: value.detach().cpu().numpy() for key, value in self.named_parameters() if key != "spread"}
        return VolumeNetwork(name, {**own, **self.fixed})

    def figures(self, epoch: int) -> dict[str, Any]:
        """Return the epoch and, if Winslow's equations can be solved, the errors of the networks' grids."""
        from meshonet.solvers.volumes.winslow import winslow

        network, errors, away, folded = self.network(), [], 0.0, 0
        for faces in self.volumes:
            nodes = network.nodes(faces)
            rim = _rim(faces)[1]
            away = max(away, float(np.sqrt(((_rim(SixFaces.of_block(nodes))[1] - rim) ** 2).sum(-1)).max()))
            folded += len(folded_cells(nodes))
            try:
                errors.append(compare(faces.grid(nodes), winslow(faces).grid).relative_l2)
            except MeshonetError:
                continue
        if not errors:
            return {"epoch": epoch}
        own = {"median": float(np.median(errors)), "worst": float(np.max(errors))}
        return {"epoch": epoch, "train": {**own, "boundary": away, "folded": folded, "grids": self.count}}

    def write(self, path: Path, *, recipe: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
        """Write the model file with the training settings `recipe` and the error measures `figures`."""
        arrays = {key: np.asarray(value) for key, value in self.network().weights.items()}
        write_model(
            path, VOLUME, arrays, path.stem, "quad", recipe=recipe, figures=figures,
            model="meshnet", settings=asdict(self.model),
        )  # fmt: skip


def residual(net: Mapping[str, Tensor], points: Tensor, h: float) -> Tensor:
    """Return the residual (p, 3) of Winslow's equations at `points` (p, 3), by differences of step `h`."""
    unit = h * torch.eye(3, dtype=points.dtype, device=points.device)
    pairs = list(combinations(range(3), 2))
    steps = [torch.zeros_like(unit[0]), *unit, *-unit]
    for i, j in pairs:
        steps += [unit[i] + unit[j], unit[i] - unit[j], unit[j] - unit[i], -unit[i] - unit[j]]
    at = (points[None] + torch.stack(steps)[:, None]).reshape(1, -1, 3)
    x = dense(torch, net, "net", at)[0].view(len(steps), -1, 3)
    first = [(x[1 + i] - x[4 + i]) / (2.0 * h) for i in range(3)]
    metric = torch.stack([torch.stack([(a * b).sum(-1) for b in first], -1) for a in first], -2)
    total = torch.zeros_like(x[0])
    for i in range(3):
        bend = (x[1 + i] - 2.0 * x[0] + x[4 + i]) / h**2
        total = total + _cofactor(metric, i, i)[:, None] * bend
    for k, (i, j) in enumerate(pairs):
        a, b, c, d = x[7 + 4 * k : 11 + 4 * k]
        total = total + 2.0 * _cofactor(metric, i, j)[:, None] * (a - b - c + d) / (4.0 * h**2)
    return total


def project(first: Tensor, second: Tensor) -> Tensor:
    """Add two gradients (n,); first remove from each of them the component that opposes the other."""
    dot = first @ second
    if dot >= 0.0:
        return first + second
    return first + second - dot * (second / (second @ second) + first / (first @ first))


def _cofactor(metric: Tensor, i: int, j: int) -> Tensor:
    (a, b), (c, d) = ([k for k in range(3) if k != each] for each in (i, j))
    minor = metric[:, a, c] * metric[:, b, d] - metric[:, a, d] * metric[:, b, c]
    return minor if (i + j) % 2 == 0 else -minor


def _rim(faces: SixFaces) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Return the network's inputs (p, 3) at all nodes of the faces, and the nodes (p, 3)."""
    places = []
    for side in FACES:
        axis, end = PLACES[side]
        axes = [np.linspace(-1.0, 1.0, n) for n in faces.counts]
        axes[axis] = np.array([-1.0 if end == 0 else 1.0])
        places.append(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
    return np.concatenate(places), np.concatenate([face.reshape(-1, 3) for face in faces.faces])


def run(
    model: str, data: Sequence[SixFaces], plan: Plan, team: Team, held_out: int,
    settings: Mapping[str, Any] | None = None,
) -> Run:  # fmt: skip
    """Return the run that trains a network for each volume of `data`.

    Raises InputError if settings are unknown, or if `held_out`, a number of volumes to leave out, is not 0.
    """
    if held_out:
        raise InputError("a network for one volume holds none out", "leave {held_out} out")
    made = with_settings(VolumeMeshNet, model.partition("-")[0], settings or {})
    if not 0.0 < made.finite < 0.5:
        raise InputError(f"finite={made.finite:g}", "use a step between 0 and 0.5", parameter="set")
    if plan.points is None:
        raise InputError("{points} all of a volume", "give a number")
    task = VolumeTask(made, data, plan.points, plan.seed, team.device)
    shapes = hashlib.sha256(b"".join(face.tobytes() for faces in data for face in faces.faces)).hexdigest()
    return Run(task, {**plan.recipe, "grids": len(data)}, {**asdict(made), "data": shapes[:16]})
