"""Training of the strip operator, from solved strips to its file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Complexes
from meshonet.solvers.neural.encoding import CHANNELS, SCALARS, decode, encode
from meshonet.solvers.neural.export import distance, held_out_figures, write_model
from meshonet.solvers.neural.fit.checkpoint import beside
from meshonet.solvers.neural.fit.loop import Progress, fit
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.task import Task
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.models.strip_fno import StripFNO
from meshonet.solvers.neural.pod import Targets, make_targets
from meshonet.solvers.neural.strip_dataset import Strips

PLAN = Plan(
    epochs=24, batch=32, rate=2e-3, schedule="cosine", warm_up=100, weight_decay=1e-4, clip=1.0, device="cpu"
)
"""The shipped model's."""
HELD_OUT = 300


@dataclass(frozen=True)
class Sizes:
    """The network's: basis functions across the strip, width, modes and layers of the hidden state."""

    basis: int = 16
    width: int = 32
    modes: int = 32
    layers: int = 3


class StripTask(Task):
    """The strip network on solved strips and their mirror images; small answers count too.

    Parameters
    ----------
    training, held_out : strips.
    sizes : of the network.
    device : to compute on.
    """

    parts: ClassVar[tuple[str, ...]] = ("difference",)

    def __init__(self, training: Strips, held_out: Strips, sizes: Sizes, device: torch.device) -> None:
        super().__init__()
        self.targets, self.held_out = make_targets(training, sizes.basis), held_out
        self.net = StripFNO(CHANNELS, SCALARS, 2 * sizes.basis, sizes.width, sizes.modes, sizes.layers)
        self.count = len(self.targets.wanted)
        given = (self.targets.channels, self.targets.scalars, self.targets.wanted)
        self.given = tuple(_tensor(array).to(device) for array in given)
        self.importance = 1.0 / ((self.given[2] ** 2).sum(1).mean(1) + 0.03) ** 0.75
        self.device = device
        self.to(device)

    def forward(self, rows: Tensor, step: int) -> Tensor:  # noqa: ARG002 - nothing is drawn
        """Return the weighted mean square of what is missing in the answers to the strips `rows`."""
        channels, scalars, wanted = (array[rows] for array in self.given)
        error = self.net(channels, scalars).float() - wanted
        return (self.importance[rows] * (error**2).sum(1).mean(1)).mean()[None]

    def validate(self) -> dict[str, float]:
        """Return quantiles of the distance to R over the held-out strips; ``loss`` is the median."""
        answers = self.answers()
        errors = [distance(found, goal) for found, goal in zip(answers, self.held_out.residual, strict=True)]
        median, p90, worst = (float(q) for q in np.quantile(errors, [0.5, 0.9, 1.0]))
        return {"loss": median, "p90": p90, "worst": worst}

    def answers(self) -> list[Complexes]:
        """Return the network's R for every held-out strip."""
        targets: Targets = self.targets
        channels, scalars, size = encode(self.held_out.wall, self.held_out.far)
        with torch.no_grad():
            out = self.net(_tensor(channels).to(self.device), _tensor(scalars).to(self.device)).cpu()
        found = out.numpy().astype(np.float64)
        basis, scale = targets.basis, targets.scale
        return list(decode(found, basis, scale, size))


def train_strip(
    strips: Strips,
    output: Path,
    plan: Plan,
    team: Team,
    *,
    held_out: int = HELD_OUT,
    sizes: Sizes | None = None,
    recipe: Mapping[str, Any],
    resume: bool = False,
    report: Callable[[Progress], None] | None = None,
) -> dict[str, Any]:
    """Fit a strip operator, write it to `output` with its recipe and held-out figures, return the figures.

    Parameters
    ----------
    held_out : strips, the last ones, that are never trained on.

    Raises
    ------
    InputError
        fewer strips than one batch beside those held out; a checkpoint of other settings.
    SolverError
        as `meshonet.solvers.neural.fit.loop.fit`.
    """
    sizes, kept = sizes or Sizes(), plan.kept(len(strips), held_out, "shapes")
    torch.manual_seed(plan.seed)
    task = StripTask(strips[:kept], strips[kept:], sizes, team.device)
    told = ("epochs", "batch", "rate", "warm_up", "seed")
    facts = {key: getattr(plan, key) for key in told} | asdict(sizes)
    facts |= {"held_out": held_out, "strips": len(strips)}
    checkpoint = beside(output)
    same = {"model": "strip", **facts}
    fit(task, plan, team, checkpoint=checkpoint, facts=same, resume=resume, report=report)
    figures = held_out_figures(task.answers().__getitem__, task.held_out)
    if team.leads:
        state = {key: value.cpu().numpy() for key, value in task.net.state_dict().items()}
        basis, scale = task.targets.basis, task.targets.scale
        write_model(
            output, state, basis, scale, name=output.stem, recipe={**recipe, **facts}, figures=figures
        )
        checkpoint.unlink(missing_ok=True)
    return figures


def _tensor(array: np.ndarray[Any, Any]) -> Tensor:
    return torch.tensor(array, dtype=torch.float32)
