"""Training of the quad operator on Winslow's and variational grids of the same domains (`quad_grids`)."""

import copy
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Complexes, Floats, Topology
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.loop import Run, Task
from meshonet.solvers.neural.fit.networks import QuadUNet
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.quad_figures import excess, held_out_figures
from meshonet.solvers.neural.fit.quad_grids import Quads
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.model_file import QUAD, write_model
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.quad.encoding import HEADS, SCALE, features
from meshonet.solvers.neural.quad.operator import QuadOperator
from meshonet.solvers.neural.quad.unrolled import TURN, rolled

PLAN = Plan(
    epochs=24, batch=64, rate=3e-3, schedule="cosine", warm_up=200, weight_decay=1e-3, clip=1.0, device="cpu"
)  # those of the shipped model

HELD_OUT = 600  # domains, so that one folded grid is a fraction of 0.2 %

AVERAGED = 0.999  # decay per step of the exponential moving average of the weights, which the file holds

PARTS = {"winslow": 0.2, "variational": 1.0, "angles": 5.0, "widest": 1.0, "folds": 0.8}
"""Weights in the loss: distances from both targets; mean angle, largest angle, folds of the second output."""

FADE_IN = (0.1, 0.3)  # fractions of all steps between which angles and folds are faded into the loss
NEAR, CLOSE = 0.1, 3e-4  # weight of the logarithm of the distance from Winslow's grids, and where it sets in
STARTS = 8  # columns that strips begin at in turn: those that the coarsest of four levels tells apart


@dataclass(frozen=True)
class QuadUNetSizes:
    """Numbers of channels and of residual blocks of `meshonet.solvers.neural.fit.networks.QuadUNet`."""

    widths: tuple[int, ...] = (2, 3, 6, 8)
    blocks: tuple[int, ...] = (0, 1, 1, 2)


class QuadTask(Task):
    """Training of the U-Net on two grids per domain: by Winslow's equations and by the variational method.

    `training` and `held_out` are domains with their grids. `steps` is the number of steps of the whole run.
    `weights` has the weights of the loss terms, `initial` the initial weights of the network, by name.
    """

    parts: tuple[str, ...] = tuple(PARTS)

    def __init__(
        self, training: Quads, held_out: Quads, sizes: QuadUNetSizes, steps: int, device: torch.device,
        weights: Mapping[str, float] = PARTS, initial: Mapping[str, Floats] | None = None,
    ) -> None:  # fmt: skip
        super().__init__()
        self.weights = [weights[part] for part in PARTS]
        self.training_set, self.held_out, self.steps = training, held_out, steps
        self.around = training.around
        self.net = QuadUNet(sizes.widths, sizes.blocks, self.around)
        if initial is not None:
            self.net.load_state_dict({key: torch.from_numpy(array) for key, array in initial.items()})
        self.mean = copy.deepcopy(self.net).requires_grad_(requires_grad=False)
        self.count = len(training)
        self.to(device)
        self.device = device

    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the weighted terms of the loss over the domains with indices `rows`."""
        self._average(step)
        grids = [z.to(self.device) for z in self.training_set[rows.cpu()].grids()]
        if self.around:
            grids = [_further(z, step % STARTS) for z in grids]
        base, last, winslow, variational = grids
        answers = self._answers(self.net, base, last)
        fade_in = float(np.interp(step / self.steps, FADE_IN, (0.0, 1.0)))
        angles = excess(answers[:, 1], variational)
        values = (
            _error(answers[:, 0], winslow) + _distance(answers[:, 0], winslow),
            _error(answers[:, 1], variational),
            *(fade_in * angle.mean() for angle in angles),
        )
        return torch.stack([weight * value for weight, value in zip(self.weights, values, strict=True)])

    def _answers(self, net: QuadUNet, base: Tensor, step: Tensor) -> Tensor:
        """Return the grids (m, heads, ...) of a network, with the repeated column that closes O grids."""
        answer = SCALE * net(features(base, step, torch, self.around))
        if self.around:
            answer = torch.cat([answer, answer[:, :, :1]], 2)
        return base[:, None] + answer

    def _average(self, step: int) -> None:
        keep = min(AVERAGED, step / (step + 20.0))
        with torch.no_grad():
            for own, mean in zip(self.net.parameters(), self.mean.parameters(), strict=True):
                mean.lerp_(own, 1.0 - keep)

    def validate(self) -> dict[str, float]:
        """Return the median relative L2 errors on held-out domains, by method, and the ``loss``."""
        answers, loss = self.answers(), {}
        for k, name in enumerate(HEADS):
            goal = self.held_out.grids()[2 + k]
            error = (answers[:, k] - goal).abs().square().sum((1, 2)) / goal.abs().square().sum((1, 2))
            loss[name] = float(error.sqrt().median())
        return {"loss": loss["variational"], **loss}

    def answers(self) -> Tensor:
        """Return predicted Winslow and variational grids of held-out domains, complex nodes (m, 2, n, n)."""
        with torch.no_grad():
            pairs = zip(*(torch.split(z, 100) for z in (self.held_out.base, self.held_out.step)), strict=True)
            parts = [self._answers(self.mean, *(z.to(self.device) for z in pair)).cpu() for pair in pairs]
        return torch.cat(parts)

    def figures(self, epoch: int) -> dict[str, Any]:  # noqa: ARG002
        """Return error measures of the network's grids of held-out domains; see `held_out_figures`."""
        base, _, *goals = self.held_out.grids()
        grids = (self.answers(), base, *goals)
        return held_out_figures(*(_in_plane(z) if self.around else z.numpy() for z in grids))

    def write(self, path: Path, *, recipe: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
        """Write the model file with the averaged weights as float32 arrays, named as in torch."""
        state = self.mean.state_dict()
        arrays = {key: value.cpu().numpy().astype(np.float32) for key, value in state.items()}
        topology: Topology = "o" if self.around else "quad"
        write_model(path, QUAD, arrays, path.stem, topology, recipe=recipe, figures=figures)


def _further(z: Tensor, by: int) -> Tensor:
    """Return strips (m, n + 1, k) that begin `by` columns further around the body."""
    turn = z[:, -1:, :1] - z[:, :1, :1]
    return torch.cat([z[:, by:-1], z[:, : by + 1] + turn], 1)


def _error(answer: Tensor, goal: Tensor) -> Tensor:
    """Return the mean relative error of the edges between nodes, plus a little of that of the nodes."""
    error = answer - goal
    total = 3.0 * error.abs().mean()
    rough = torch.zeros(len(goal), device=goal.device)
    for axis in (1, 2):
        off, step = error.diff(dim=axis).abs().square(), goal.diff(dim=axis).abs().square()
        rough = rough + torch.log1p(4.0 * off / (step + 1e-8)).mean((1, 2))
    return total + (rough + 1e-7).sqrt().mean()


def _distance(answer: Tensor, goal: Tensor) -> Tensor:
    """Return the mean logarithm of the distance between grids, which gives weight to small distances too."""
    distance = (answer - goal).abs().square().mean((1, 2)).sqrt()
    return NEAR * torch.log1p(distance / CLOSE).mean()


def run(
    model: str,  # noqa: ARG001 - there is one
    data: Quads, plan: Plan, team: Team, held_out: int, sizes: QuadUNetSizes | None = None,
    initial: Operator | None = None, weights: Mapping[str, float] | None = None,
) -> Run:  # fmt: skip
    """Return the run that trains the U-Net; the last `held_out` domains are never trained on.

    `initial` is an operator whose weights and sizes are used at the start. `weights` are weights of loss
    terms, by default `PARTS`. Raises InputError if less than one batch remains for training, if one of
    `weights` is unknown, negative or not finite, or if `initial` is no quad operator.
    """
    sizes, kept = sizes or QuadUNetSizes(), plan.kept(len(data), held_out, "domains")
    if initial is not None:
        if not isinstance(initial, QuadOperator):
            raise InputError(f"{initial.name} is no quad operator", "name one", parameter="initial")
        sizes = QuadUNetSizes(initial.widths, initial.blocks)
    torch.manual_seed(plan.seed)
    steps = plan.epochs * -(-kept // plan.batch)
    parts = _weights(weights or {})
    begun = None if initial is None else initial.weights
    task = QuadTask(data[:kept], data[kept:], sizes, steps, team.device, parts, begun)
    names = ("epochs", "batch", "rate", "warm_up", "weight_decay", "clip", "seed")
    facts = {key: getattr(plan, key) for key in names}
    facts |= {key: list(value) for key, value in asdict(sizes).items()}
    facts |= {"weights": parts, "held_out": held_out, "domains": len(data)}
    facts |= {"initial": initial.name} if initial is not None else {}
    return Run(task, facts)


def _weights(changed: Mapping[str, float]) -> dict[str, float]:
    for part, weight in changed.items():
        if part not in PARTS:
            problem = f"the quad operator's loss has no part {part!r}"
            raise InputError(problem, "use one of " + ", ".join(PARTS), parameter="set")
        if not (isinstance(weight, int | float) and 0 <= weight < np.inf):
            raise InputError(f"{part}={weight} is no weight", "use a number from 0 on", parameter="set")
    return {**PARTS, **changed}


def _in_plane(z: Tensor) -> Complexes:
    strips = z.numpy().astype(np.complex128)
    turn = (strips[..., -1:, :1] - strips[..., :1, :1]).real
    return np.asarray(rolled(strips * (TURN / turn)))
