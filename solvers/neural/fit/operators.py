"""Training of the paper's models: batches of geometries and of randomly drawn points."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import mse_loss

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.harmonic import extend
from meshonet.solvers.elliptic.winslow import left_side
from meshonet.solvers.neural.fit.loop import Run
from meshonet.solvers.neural.fit.model_task import ModelTask, tensor, tensors
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.models.architecture import Architecture
from meshonet.solvers.neural.models.architectures import architecture, settings_of
from meshonet.solvers.neural.models.mgnet import MGNet
from meshonet.solvers.neural.samples import Samples

PLAN = Plan(epochs=15_000, points=(1000, 200))  # the authors' published settings

HELD_OUT = 0  # datasets are small, as in the paper: all shapes outside the test split are trained on

MACHINE = ("device", "compiled", "log_every", "validate_every", "checkpoint_every")
"""Settings that a resumed run may change, because they do not affect the result."""


class OperatorTask(ModelTask):
    """Training of an operator on solved grids.

    ::

        loss = interior * mean |error|^2 inside + boundary * mean |error|^2 on the boundary

    over the points of a step, in squares of the unit of length; error = output - (grid - base). Where there
    is a base, both are divided by the mean square of grid - base, so that the loss is of the order of 1.
    `model`: the architecture; `training`, `held_out`: its shapes; `points`: numbers of points drawn for a
    step, inside and on the boundary; None takes all; `seed`: of the initial weights and of the points.
    """

    def __init__(
        self, model: Architecture, training: Samples, held_out: Samples | None,
        points: tuple[int, int] | None, seed: int, device: torch.device,
    ) -> None:  # fmt: skip
        targets = differences(model, training)
        super().__init__(model, training, targets, points, seed, device)
        self.inputs = tensors(model.encode(training.boundaries()), device)
        # points first: those of a step are then whole rows of a matrix, which torch gathers fastest
        self.targets = tensor(_by_place(targets).reshape(training.ni * training.nj, -1)).to(device)
        size = float((targets**2).mean()) if model.base != "none" else 1.0
        self.weights = model.interior / size, model.boundary / size
        self.places = model.seen(torch, self.places)
        self.held_out: tuple[dict[str, Tensor], Tensor] | None = None
        if held_out is not None and len(held_out):
            goal = tensor(_by_place(differences(model, held_out))).to(device)
            self.held_out = tensors(model.encode(held_out.boundaries()), device), goal
        self.to(device)
        with torch.no_grad():
            more = model.penalty(torch, self._weights(), self.inputs) is not None
        self.parts = ("interior", "boundary", *(("penalty",) if more else ()))

    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the interior and the boundary part of the loss over the shapes `rows`, then any penalty."""
        index, inner = self._drawn(step)
        place = torch.from_numpy(index).to(self.places.device)
        goal = self.targets.index_select(0, place).view(len(place), self.count, 2)
        inputs = self.inputs
        if len(rows) < self.count:  # of all shapes the order does not matter
            inputs = {name: value[rows] for name, value in inputs.items()}
            goal = goal.index_select(1, rows)
        answer = self._answer(inputs, self.places[place], place)
        parts = self._weighted(answer.float().transpose(0, 1), goal, inner)
        penalty = self.model.penalty(torch, self._weights(), inputs)
        return parts if penalty is None else torch.cat([parts, penalty.float()[None]])

    def validate(self) -> dict[str, float]:
        """Return the loss over the held-out shapes and the median of their relative L2 error."""
        if self.held_out is None:
            return {}
        inputs, goal = self.held_out
        index = np.concatenate([self.inside, self.outside])
        place = torch.from_numpy(index).to(self.places.device)
        with torch.no_grad():
            answer, goal = self._answer(inputs, self.places[place], place).transpose(0, 1), goal[place]
            loss = self._weighted(answer, goal, len(self.inside)).sum()
            return {"loss": float(loss), "mean_square": 2.0 * float(mse_loss(answer, goal))}

    def _answer(self, inputs: Mapping[str, Tensor], points: Tensor, place: Tensor) -> Tensor:
        return self.model.answer(torch, self._weights(), inputs, points, place)

    def _weights(self) -> dict[str, Any]:
        return {**dict(self.named_parameters()), **self.fixed}

    def _drawn(self, step: int) -> tuple[np.ndarray[Any, np.dtype[np.intp]], int]:
        """Return indices of nodes, those inside first, and how many are inside."""
        if self.points is None:
            return np.concatenate([self.inside, self.outside]), len(self.inside)
        rng = np.random.default_rng([self.seed, 1, step])
        groups = zip((self.inside, self.outside), self.points, strict=True)
        drawn = [group[rng.integers(0, len(group), n)] for group, n in groups]
        return np.concatenate(drawn), self.points[0]

    def _weighted(self, answer: Tensor, goal: Tensor, inner: int) -> Tensor:
        """Return both parts of the loss of outputs (p, batch, 2), of which the first `inner` are inside."""
        inside, outside = (2.0 * weight for weight in self.weights)  # two coordinates a place
        first, second = mse_loss(answer[:inner], goal[:inner]), mse_loss(answer[inner:], goal[inner:])
        return torch.stack([inside * first, outside * second])


def differences(model: Architecture, samples: Samples) -> Floats:
    """Return the grids minus the model's base (n, ni, nj, 2)."""
    if model.base == "none":
        return samples.nodes
    return samples.nodes - np.array([extend(boundary) for boundary in samples.boundaries()])


def _by_place(nodes: Floats) -> Floats:
    return nodes.reshape(len(nodes), -1, 2).swapaxes(0, 1)


def run(
    model: str,
    data: Samples,
    plan: Plan,
    team: Team,
    held_out: int,
    settings: Mapping[str, Any] | None = None,
) -> Run:
    """Return the run that trains `model` on the training split of `data`, never on its test split.

    `held_out`: number of training grids, spread evenly, that are held out to monitor the loss; `settings`: of
    the model, in place of its defaults. Raises InputError: too few grids; settings that the model does not
    have.
    """
    made = architecture(model, data.topology, settings)
    rows = np.arange(len(data)) if made.physics else data.where("train")
    apart = rows[np.linspace(0, len(rows) - 1, held_out + 2).astype(int)[1:-1]]
    rows = np.setdiff1d(rows, apart)
    if len(rows) < (1 if made.physics else 2) or len(np.unique(apart)) < held_out:
        raise InputError(f"{len(rows)} grids to train on", "give at least 2, or hold fewer out")
    training = data.pick(rows)
    task: ModelTask
    if isinstance(made, MGNet):
        task = PhysicsTask(made, training, plan.points, plan.seed, team.device)
    else:
        task = OperatorTask(made, training, data.pick(apart), plan.points, plan.seed, team.device)
    task.samples = data
    recipe = {key: value for key, value in asdict(plan).items() if key not in MACHINE}
    return Run(task, {**recipe, "grids": len(rows)}, {**settings_of(made), "data": data.fingerprint()})


class PhysicsTask(ModelTask):
    """Networks of `MGNet` or `MeshNet` on the geometries of `samples`.

    `points`: numbers of points drawn for a step, inside (anywhere, not only at nodes) and on the boundary (at
    nodes); None takes every node.
    """

    model: MGNet
    parts: tuple[str, ...] = ("winslow", "boundary", "data")

    def __init__(
        self, model: MGNet, samples: Samples, points: tuple[int, int] | None, seed: int, device: torch.device
    ) -> None:
        super().__init__(model, samples, samples.nodes, points, seed, device)
        fixed = model.fixed(samples, samples.nodes)
        centre, size = (fixed[f"fixed/{name}"][:, None] for name in ("centre", "size"))
        self.nodes = tensor((samples.nodes.reshape(len(samples), -1, 2) - centre) / size).to(device)
        known = _known(model, samples.ni, samples.nj)
        known[self.outside] = False
        self.known = torch.from_numpy(np.flatnonzero(known)).to(device)
        self.to(device)

    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the parts of the loss over the geometries `rows`."""
        net = {name: value[rows] for name, value in self.named_parameters()}
        inner, outer = self._drawn(step)
        answer = self._plain(net, self.places[outer])
        boundary = ((answer - self.nodes[rows][:, outer]) ** 2).sum(-1).mean()
        winslow = (self._residual(net, inner) ** 2).sum(-1).mean()
        data = 0.0 * boundary
        if len(self.known):
            answer = self._plain(net, self.places[self.known])
            data = ((answer - self.nodes[rows][:, self.known]) ** 2).sum(-1).mean()
        return torch.stack([winslow, self.model.rim * boundary, self.model.data * data])

    def _drawn(self, step: int) -> tuple[Tensor, Tensor]:
        """Return points inside (p, 2), in (xi, eta), and indices of nodes on the boundary."""
        device = self.places.device
        if self.points is None:
            inside, outside = (torch.from_numpy(k).to(device) for k in (self.inside, self.outside))
            return self.places[inside], outside
        rng = np.random.default_rng([self.seed, 1, step])
        inner = tensor(rng.random((self.points[0], 2))).to(device)
        outer = self.outside[rng.integers(0, len(self.outside), self.points[1])]
        return inner, torch.from_numpy(outer).to(device)

    def _plain(self, net: dict[str, Tensor], points: Tensor) -> Tensor:
        h = self.model.features(torch, points)[None]
        return _layers(net, [h])[0]

    def _residual(self, net: dict[str, Tensor], points: Tensor) -> Tensor:
        """Return the residual of Winslow's equations (batch, p, 2)."""
        h = self.model.finite
        if h > 0:
            X: Sequence[Tensor] = self._differences(net, points, h)
        else:
            X = _layers(net, [f[None] for f in self.model.slopes(torch, points)])[1:]
        return left_side(X, lambda a, b: (a * b).sum(-1, keepdim=True))[0]

    def _differences(self, net: dict[str, Tensor], points: Tensor, h: float) -> Sequence[Tensor]:
        """Return the five derivatives by central differences of step h."""
        steps = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]
        at = torch.cat(
            [points + h * torch.tensor(s, dtype=points.dtype, device=points.device) for s in steps]
        )
        o, e, w, n, s, ne, se, nw, sw = self._plain(net, at).chunk(9, dim=1)
        first = ((e - w) / (2 * h), (n - s) / (2 * h))
        return (*first, (e - 2 * o + w) / h**2, (ne - se - nw + sw) / (4 * h**2), (n - 2 * o + s) / h**2)


def _layers(net: dict[str, Tensor], h: list[Tensor]) -> list[Tensor]:
    """Return the network's output (batch, p, 2), and its derivatives when `h` has those of the features.

    With z = h W + b and t = tanh z: t_a = (1 - t^2) z_a, t_ab = (1 - t^2) z_ab - 2 t (1 - t^2) z_a z_b.
    """
    depth = sum(name.endswith("weight") for name in net)
    for k in range(depth):
        weight, bias = net[f"net/{k}/weight"], net[f"net/{k}/bias"]
        z = [part @ weight for part in h]
        z[0] = z[0] + bias
        if k == depth - 1:
            return z
        t = torch.tanh(z[0])
        if len(z) == 1:
            h = [t]
            continue
        slope = 1.0 - t * t
        bend = -2.0 * t * slope
        _, a, b, aa, ab, bb = z
        second = [slope * aa + bend * a * a, slope * ab + bend * a * b, slope * bb + bend * b * b]
        h = [t, slope * a, slope * b, *second]
    return h


def _known(model: MGNet, ni: int, nj: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return a mask (ni * nj,) of the known nodes: those of auxiliary lines and of a coarse grid."""
    known = np.zeros((ni, nj), dtype=bool)
    for axis, n in ((0, ni), (1, nj)):
        if model.lines:
            lines = np.round(np.linspace(0, n - 1, model.lines + 2)).astype(int)[1:-1]
            known[lines if axis == 0 else slice(None), lines if axis == 1 else slice(None)] = True
    if model.coarse:
        if not 3 <= model.coarse <= min(ni, nj):
            raise InputError(f"coarse={model.coarse}", f"use 3 to {min(ni, nj)}", parameter="set")
        rows, columns = (np.round(np.linspace(0, n - 1, model.coarse)).astype(int) for n in (ni, nj))
        known[np.ix_(rows, columns)] = True
    return known.reshape(-1)
