"""Training of the paper's models: batches of geometries and of randomly drawn points."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import mse_loss

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.harmonic import extend
from meshonet.solvers.neural.fit.loop import Run
from meshonet.solvers.neural.fit.model_task import ModelTask, tensor, tensors
from meshonet.solvers.neural.fit.physics_task import PhysicsTask
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.models.architecture import Architecture
from meshonet.solvers.neural.models.architectures import architecture, settings_of
from meshonet.solvers.neural.models.mgnet import MGNet
from meshonet.solvers.neural.samples import Samples

PLAN = Plan(epochs=15_000, points=(1000, 200))  # the authors' published settings

HELD_OUT = 0  # datasets are small, as in the paper: all shapes outside the test split are trained on


class OperatorTask(ModelTask):
    """Training of a model on solved grids.

    ::

        loss = interior * mean |error|^2 inside + boundary * mean |error|^2 on the boundary

    The means are over the points drawn in a step. The error is output - (grid - base); base is the grid to
    which the model adds its output. If there is a base, both terms are divided by the mean square of (grid -
    base). `held_out` has the shapes on which the loss is monitored; other parameters: `ModelTask`.
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
        """Return the weighted interior and boundary loss, and any penalty, of shapes with indices `rows`."""
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
        """Return, by name, the loss over held-out shapes and the mean square error of their grids' nodes."""
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
    """Return what a model has to learn (n, ni, nj, 2): nodes, minus harmonic grids if it corrects those."""
    if model.base == "none":
        return samples.nodes
    return samples.nodes - np.array([extend(boundary) for boundary in samples.boundaries()])


def _by_place(nodes: Floats) -> Floats:
    return nodes.reshape(len(nodes), -1, 2).swapaxes(0, 1)


def run(
    model: str, data: Samples, plan: Plan, team: Team, held_out: int,
    settings: Mapping[str, Any] | None = None,
) -> Run:  # fmt: skip
    """Return the run that trains `model` on the training split of `data`, never on its test split.

    `held_out` grids of this split, evenly spaced, are not trained on; the loss on them is monitored.
    `settings` replaces defaults of the model, by name. Raises InputError: too few grids or unknown settings.
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
    return Run(task, {**plan.recipe, "grids": len(rows)}, {**settings_of(made), "data": data.fingerprint()})
