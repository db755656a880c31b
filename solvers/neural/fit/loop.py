"""The training loop of every model, its tasks, and checkpoints from which training is resumed."""

import os
import time
from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.stages import reached

SLOWER = "resume from the last checkpoint with a smaller learning rate"  # where a number is not finite
FREE = ("rate",)  # settings that may change when a run is resumed: a smaller rate is that remedy


class Task(nn.Module):
    """A model with its training set; parameters and data are on one device.

    `count` is the number of training shapes. `parts` has the names of the terms of the loss.
    """

    count: int
    parts: tuple[str, ...] = ("loss",)

    @abstractmethod
    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the weighted terms of the loss, averaged over the training shapes with indices `rows`.

        `step` seeds random draws, so that all processes and resumed runs draw the same numbers.
        """

    def differentiate(self, parts: Tensor, team: Team) -> None:  # noqa: ARG002 - subclasses use it
        """Compute the gradient of the loss, which is the sum of `parts`, with respect to the parameters."""
        parts.sum().backward()

    def validate(self) -> dict[str, float]:
        """Return errors on held-out shapes by name, ``loss`` among them; {} if no shapes are held out."""
        return {}

    @abstractmethod
    def figures(self, epoch: int) -> dict[str, Any]:
        """Return error measures on held-out shapes, by name; `epoch` is the number of epochs done."""

    @abstractmethod
    def write(self, path: Path, *, recipe: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
        """Write the model file with the training settings `recipe` and the error measures `figures`."""


@dataclass(frozen=True)
class Run:
    """A training task and its settings.

    `recipe` has the settings that the model file stores, `identity` further facts, such as a fingerprint of
    the data. Both must be the same when a run is resumed, except for the learning rate.
    """

    task: Task
    recipe: Mapping[str, Any]
    identity: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Progress:
    """Progress of a run: losses and times of the epochs since the last report."""

    epoch: int
    epochs: int
    loss: float  # mean over the steps
    parts: Mapping[str, float]  # means of the parts of the loss
    held_out: Mapping[str, float]  # figures of the held-out shapes, if evaluated
    rate: float  # learning rate
    seen: int  # shapes since the start, counted once per epoch
    seconds: float  # of this process, as the following
    speed: float  # shapes per second
    done: int  # epochs


@dataclass
class _State:
    """The state of a run that changes from epoch to epoch; a checkpoint holds all of it."""

    epoch: int = 0
    summed: Any = 0.0
    steps: int = 0
    best: float = float("inf")
    best_epoch: int = 0
    kept: dict[str, Tensor] | None = None


def fit(
    task: Task,
    plan: Plan,
    team: Team,
    *,
    checkpoint: Path,
    facts: Mapping[str, Any],
    resume: bool = False,
    report: Callable[[Progress], None] | None = None,
) -> int:
    """Train `task` in place, and return the epoch from which its final weights come.

    With `plan.patience`, the final weights have the least loss on held-out shapes. The file `checkpoint` is
    written every `plan.checkpoint_every` epochs. With `resume`, training continues from this file, if it has
    the settings `facts`. `report` is called every `plan.log_every` epochs and at the end. Raises
    InputError if settings differ, or if `plan.patience` is set without held-out shapes. Raises SolverError if
    a loss or weight is not finite, or if memory is too small; the last checkpoint is then kept.
    """
    trained = list(task.parameters())
    optimiser: torch.optim.Optimizer = torch.optim.Adam(trained, plan.rate, fused=True)
    if plan.weight_decay:
        optimiser = torch.optim.AdamW(trained, plan.rate, weight_decay=plan.weight_decay)
    state = _State()
    saved = load_checkpoint(checkpoint, facts) if resume else None
    if saved is not None:
        task.load_state_dict({**task.state_dict(), **saved["task"]})
        optimiser.load_state_dict(saved["optimiser"])
        state = _State(**saved["state"])
    run = _wrapped(task, plan, team)
    reached("training")
    begun, first = time.perf_counter(), state.epoch
    while state.epoch < plan.epochs:
        rate = _one_epoch(run, task, optimiser, plan, team, state)
        state.epoch += 1
        last = state.epoch == plan.epochs
        held_out = _judged(task, plan, state) if last or state.epoch % plan.validate_every == 0 else {}
        stop = plan.patience is not None and state.epoch - state.best_epoch >= plan.patience
        if last or stop or state.epoch % plan.log_every == 0:
            if report is not None:
                spent = time.perf_counter() - begun
                report(_progress(task, plan, state, rate, held_out, spent, first))
            state.summed, state.steps = 0.0, 0
        if team.leads and (stop or last or state.epoch % plan.checkpoint_every == 0):
            kept = {"facts": dict(facts), "epoch": state.epoch, "state": vars(state)}
            weights = {name: value.detach().cpu() for name, value in task.named_parameters()}
            save_checkpoint(checkpoint, {"task": weights, "optimiser": optimiser.state_dict(), **kept})
        if stop:
            break
    if state.kept is None:
        return state.epoch
    task.load_state_dict({**task.state_dict(), **state.kept})
    return state.best_epoch


def _wrapped(task: Task, plan: Plan, team: Team) -> Callable[[Tensor, int], Tensor]:
    run: Any = torch.compile(task) if plan.compiled else task
    if team.size > 1:
        ids = [team.device.index] if team.device.type == "cuda" else None
        run = torch.nn.parallel.DistributedDataParallel(run, device_ids=ids, broadcast_buffers=False)
    return run


def _one_epoch(
    run: Callable[[Tensor, int], Tensor], task: Task, optimiser: torch.optim.Optimizer, plan: Plan,
    team: Team, state: _State,
) -> float:  # fmt: skip
    """Take the steps of one epoch, add their losses to `state`, and return the last learning rate."""
    order = torch.from_numpy(np.random.default_rng([plan.seed, state.epoch]).permutation(task.count))
    steps = -(-task.count // plan.batch)
    rate = plan.rate
    for k in range(steps):
        rows, weight = team.share(order[k * plan.batch : (k + 1) * plan.batch])
        done = state.epoch * steps + k + 1
        rate = plan.rate_at(done, steps)
        for group in optimiser.param_groups:
            group["lr"] = rate
        try:
            with torch.autocast(team.device.type, torch.bfloat16, enabled=plan.amp):
                parts = run(rows.to(team.device), done) * weight
            optimiser.zero_grad()
            task.differentiate(parts, team)
        except (RuntimeError, MemoryError) as error:
            raise _explained(error, plan) from error
        parts = team.mean(parts.detach())
        if not torch.isfinite(parts).all():
            raise SolverError(f"the loss is not finite in epoch {state.epoch + 1}; {SLOWER}")
        if plan.clip is not None:
            torch.nn.utils.clip_grad_norm_(task.parameters(), plan.clip)
        optimiser.step()
        state.summed = state.summed + parts.double().cpu()
        state.steps += 1
    return rate


def _explained(error: Exception, plan: Plan) -> Exception:
    """Return the exception to raise for an error in a step: a clear one for a missing compiler or memory."""
    if plan.compiled and type(error).__module__.startswith(("torch._dynamo", "torch._inductor")):
        first = str(error).splitlines()[0]
        remedy = "leave it out, or install a C++ compiler"
        return InputError(f"torch.compile cannot ({first})", remedy, parameter="compile")
    if not isinstance(error, torch.OutOfMemoryError | MemoryError) and "allocate memory" not in str(error):
        return error
    remedy = "use a smaller batch or fewer points (the last checkpoint is kept)"
    return SolverError(f"not enough memory for {plan.batch} shapes a step; {remedy}")


def _judged(task: Task, plan: Plan, state: _State) -> dict[str, float]:
    """Return the figures of the held-out shapes; with patience, keep the weights if they are the best."""
    figures = task.validate()
    if plan.patience is None:
        return figures
    if "loss" not in figures:
        raise InputError("stopping early needs shapes held out", "use {held_out}", parameter="patience")
    if figures["loss"] < state.best:
        state.best, state.best_epoch = figures["loss"], state.epoch
        state.kept = {name: value.detach().cpu().clone() for name, value in task.named_parameters()}
    return figures


def _progress(
    task: Task, plan: Plan, state: _State, rate: float, held_out: Mapping[str, float], spent: float,
    first: int,
) -> Progress:  # fmt: skip
    means = (state.summed / state.steps).tolist()
    parts = dict(zip(task.parts, means, strict=True))
    done, seen = state.epoch - first, state.epoch * task.count
    speed = done * task.count / spent
    return Progress(state.epoch, plan.epochs, sum(means), parts, held_out, rate, seen, spent, speed, done)


def beside(output: Path) -> Path:
    """Return the path of the checkpoint that belongs to the model file `output`."""
    return output.with_name(output.name + ".checkpoint")


def save_checkpoint(path: Path, state: Mapping[str, Any]) -> None:
    """Replace the checkpoint at `path` by `state`; if a weight is not finite, raise SolverError instead."""
    for name, value in state["task"].items():
        if not torch.isfinite(value).all():
            raise SolverError(f"{name} is not finite after epoch {state['epoch']}; {SLOWER}")
    part = path.with_name(path.name + ".part")
    with part.open("wb") as file:
        torch.save(dict(state), file)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


def load_checkpoint(path: Path, facts: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the state in the checkpoint at `path`, or None if there is no such file.

    Raises InputError if the file is no checkpoint, or if its model or settings differ from `facts`.
    """
    if not path.exists():
        return None
    source = str(path)
    try:
        state: dict[str, Any] = torch.load(path, weights_only=True, map_location="cpu")
        had = state["facts"]
    except Exception as error:
        raise InputError(f"not a checkpoint ({type(error).__name__})", "remove it", source=source) from error
    if had.get("model") != facts.get("model"):
        problem = f"the checkpoint is of model {had.get('model')}, not {facts.get('model')}"
        raise InputError(problem, "remove it, or write to another file", source=source)
    keys = [key for key in (*facts, *had) if key not in FREE and had.get(key) != facts.get(key)]
    if keys:
        settings = ", ".join(f"{key} {had.get(key)!r}" for key in dict.fromkeys(keys))
        problem = f"the checkpoint was made with {settings}"
        raise InputError(problem, "repeat that or remove it", source=source)
    return state
