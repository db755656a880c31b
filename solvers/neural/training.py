"""Training of the strip operator, read from top to bottom."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from geometry.arrays import Complexes
from geometry.errors import InputError, SolverError
from solvers.neural.checkpoint import load_checkpoint, save_checkpoint
from solvers.neural.dataset import Strips
from solvers.neural.encoding import CHANNELS, SCALARS, decode, encode
from solvers.neural.export import distance, held_out_figures, write_model
from solvers.neural.models.strip_fno import StripFNO
from solvers.neural.targets import Targets, make_targets


@dataclass(frozen=True)
class Settings:
    """What a run is made of: the same settings, data and machine give the same weights.

    `held_out` strips, the last ones, are never trained on; `warm_up` counts steps; `basis`, `width`, `modes`
    and `layers` are the network's.
    """

    epochs: int = 24
    batch: int = 32
    rate: float = 2e-3
    warm_up: int = 100
    basis: int = 16
    width: int = 32
    modes: int = 32
    layers: int = 3
    held_out: int = 300
    seed: int = 0


@dataclass(frozen=True)
class Report:
    """One epoch: mean training loss; distance to R over the held-out strips; learning rate; seconds."""

    epoch: int
    loss: float
    median: float
    p90: float
    worst: float
    rate: float
    seconds: float


def train(
    strips: Strips,
    output: Path,
    settings: Settings,
    *,
    name: str,
    recipe: Mapping[str, Any],
    resume: bool = False,
    checkpoint_every: int = 1,
    report: Callable[[Report], None] | None = None,
) -> dict[str, Any]:
    """Fit a StripFNO, write it to `output` with its recipe and held-out figures, and return the figures.

    A checkpoint stands beside `output` (``.checkpoint``) after every `checkpoint_every` epochs and is removed
    at the end; `resume` starts from it.

    Raises
    ------
    InputError
        fewer strips than one batch beside those held out; a checkpoint of other settings.
    SolverError
        a loss that is not finite; the last checkpoint stays.
    """
    if len(strips) < settings.held_out + settings.batch:
        needed = settings.held_out + settings.batch
        raise InputError(f"{len(strips)} shapes to train on", f"give at least {needed} or hold fewer out")
    torch.manual_seed(settings.seed)
    kept = len(strips) - settings.held_out
    targets, test = make_targets(strips[:kept], settings.basis), strips[kept:]
    net = StripFNO(CHANNELS, SCALARS, 2 * settings.basis, settings.width, settings.modes, settings.layers)
    optimiser = torch.optim.AdamW(net.parameters(), settings.rate, weight_decay=1e-4)
    checkpoint = output.with_name(output.name + ".checkpoint")
    facts = {**asdict(settings), "strips": len(strips)}
    first = load_checkpoint(checkpoint, net, optimiser, facts) if resume else 0
    for epoch in range(first, settings.epochs):
        begun = time.perf_counter()
        loss, rate = _one_epoch(net, optimiser, targets, settings, epoch)
        answers = _answers(net, test, targets)
        errors = [distance(found, goal) for found, goal in zip(answers, test.residual, strict=True)]
        median, p90, worst = (float(q) for q in np.quantile(errors, [0.5, 0.9, 1.0]))
        if report is not None:
            report(Report(epoch + 1, loss, median, p90, worst, rate, time.perf_counter() - begun))
        if (epoch + 1) % checkpoint_every == 0:
            save_checkpoint(checkpoint, net, optimiser, facts, epoch + 1)
    figures = held_out_figures(_answers(net, test, targets).__getitem__, test)
    state = {key: value.numpy() for key, value in net.state_dict().items()}
    write_model(
        output, state, targets.basis, targets.scale, name=name, recipe={**recipe, **facts}, figures=figures
    )
    checkpoint.unlink(missing_ok=True)
    return figures


def _one_epoch(
    net: StripFNO, optimiser: torch.optim.Optimizer, targets: Targets, settings: Settings, epoch: int
) -> tuple[float, float]:
    """Return the mean loss and the last learning rate: linear warm-up, then a cosine to zero."""
    channels, scalars, wanted = (_tensor(a) for a in (targets.channels, targets.scalars, targets.wanted))
    importance = 1.0 / ((wanted**2).sum(1).mean(1) + 0.03) ** 0.75  # small answers count too
    order = torch.from_numpy(np.random.default_rng([settings.seed, epoch]).permutation(len(wanted)))
    steps = -(-len(order) // settings.batch)
    total, rate = 0.0, 0.0
    for step in range(steps):
        rows = order[step * settings.batch : (step + 1) * settings.batch]
        done = epoch * steps + step + 1
        fade = 0.5 * (1.0 + np.cos(np.pi * done / (settings.epochs * steps)))
        rate = float(settings.rate * min(1.0, done / settings.warm_up) * fade + 1e-6)
        for group in optimiser.param_groups:
            group["lr"] = rate
        error = net(channels[rows], scalars[rows]) - wanted[rows]
        loss = (importance[rows] * (error**2).sum(1).mean(1)).mean()
        if not torch.isfinite(loss):
            raise SolverError(
                f"the loss is not finite in epoch {epoch + 1}; use --resume with a smaller --rate"
            )
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        optimiser.step()
        total += loss.item() * len(rows)
    return total / len(wanted), rate


def _answers(net: StripFNO, strips: Strips, targets: Targets) -> list[Complexes]:
    """Return the network's R for every strip."""
    channels, scalars, size = encode(strips.wall, strips.far)
    with torch.no_grad():
        out = net(_tensor(channels), _tensor(scalars)).numpy().astype(np.float64)
    return [decode(out[m], targets.basis, targets.scale, float(size[m])) for m in range(len(strips))]


def _tensor(array: np.ndarray[Any, Any]) -> Tensor:
    return torch.tensor(array, dtype=torch.float32)
