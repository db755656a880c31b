"""The training loop of every model, read from top to bottom."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.neural.fit.checkpoint import load_checkpoint, save_checkpoint
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.task import Task
from meshonet.solvers.neural.fit.team import Team


@dataclass(frozen=True)
class Progress:
    """How far a run is: figures of the epochs since the last report.

    `loss` and its `parts` are means over the steps; `held_out` figures of the held-out shapes, when they were
    evaluated; `rate` the learning rate; `seen` shapes since the start, a shape seen twice counting twice;
    `seconds` since this process began, `speed` shapes a second in it, and `done` its epochs.
    """

    epoch: int
    epochs: int
    loss: float
    parts: Mapping[str, float]
    held_out: Mapping[str, float]
    rate: float
    seen: int
    seconds: float
    speed: float
    done: int


@dataclass
class _State:
    """What changes from epoch to epoch; all of it is in the checkpoint."""

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
    """Train `task` in place and return the epoch whose weights it has.

    A checkpoint stands at `checkpoint` after every `plan.checkpoint_every` epochs; `resume` starts from it.
    With `plan.patience` the weights are those of the least held-out loss. `facts`: what a checkpoint must
    have in common with this run; ``model`` among them; `report`: told every `plan.log_every` epochs and at
    the end. Raises InputError: a checkpoint of another model or of other settings; patience, and no shapes
    held out. Raises SolverError: a loss or a weight that is not finite, not enough memory; the last
    checkpoint stays.
    """
    optimiser = _optimiser(task, plan)
    state = _State()
    saved = load_checkpoint(checkpoint, facts) if resume else None
    if saved is not None:
        task.load_state_dict({**task.state_dict(), **saved["task"]})
        optimiser.load_state_dict(saved["optimiser"])
        state = _State(**saved["state"])
    run = _wrapped(task, plan, team)
    begun, first = time.perf_counter(), state.epoch
    while state.epoch < plan.epochs:
        rate = _one_epoch(run, task, optimiser, plan, team, state)
        state.epoch += 1
        last = state.epoch == plan.epochs
        held_out = _judged(task, plan, state) if last or state.epoch % plan.validate_every == 0 else {}
        stop = plan.patience is not None and state.epoch - state.best_epoch >= plan.patience
        if (last or stop or state.epoch % plan.log_every == 0) and report is not None:
            spent = time.perf_counter() - begun
            report(_progress(task, plan, state, rate, held_out, spent, first))
        if last or stop or state.epoch % plan.log_every == 0:
            state.summed, state.steps = 0.0, 0
        if team.leads and (stop or last or state.epoch % plan.checkpoint_every == 0):
            kept = {"facts": dict(facts), "epoch": state.epoch, "state": vars(state)}
            trained = {name: value.detach().cpu() for name, value in task.named_parameters()}
            save_checkpoint(checkpoint, {"task": trained, "optimiser": optimiser.state_dict(), **kept})
        if stop:
            break
    if state.kept is None:
        return state.epoch
    task.load_state_dict({**task.state_dict(), **state.kept})
    return state.best_epoch


def _optimiser(task: Task, plan: Plan) -> torch.optim.Optimizer:
    parameters = list(task.parameters())
    if plan.weight_decay:
        return torch.optim.AdamW(parameters, plan.rate, weight_decay=plan.weight_decay)
    return torch.optim.Adam(parameters, plan.rate, fused=True)


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
    """Take the steps of one epoch, add to the sums of `state`, and return the last learning rate."""
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
            parts.sum().backward()  # type: ignore[no-untyped-call]
        except (RuntimeError, MemoryError) as error:
            raise _explained(error, plan) from error
        parts = team.mean(parts.detach())
        if not torch.isfinite(parts).all():
            raise SolverError(
                f"the loss is not finite in epoch {state.epoch + 1}; resume from the "
                "last checkpoint with a smaller learning rate"
            )
        if plan.clip is not None:
            torch.nn.utils.clip_grad_norm_(task.parameters(), plan.clip)
        optimiser.step()
        state.summed = state.summed + parts.double().cpu()
        state.steps += 1
    return rate


def _explained(error: Exception, plan: Plan) -> Exception:
    """Return what to raise for an error of a step: a compiler or memory that is missing is the user's."""
    if plan.compiled and type(error).__module__.startswith(("torch._dynamo", "torch._inductor")):
        first = str(error).splitlines()[0]
        return InputError(
            f"torch.compile cannot ({first})", "leave it out, or install a C++ compiler", parameter="compile"
        )
    short = isinstance(error, (torch.OutOfMemoryError, MemoryError)) or "allocate memory" in str(error)
    if not short:
        return error
    return SolverError(
        f"not enough memory for {plan.batch} shapes a step; use a smaller batch or fewer points (the last "
        "checkpoint is kept)"
    )


def _judged(task: Task, plan: Plan, state: _State) -> dict[str, float]:
    """Return the figures of the held-out shapes, and keep the weights if patience has an eye on them."""
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
    done = state.epoch - first
    seen = state.epoch * task.count
    speed = done * task.count / spent
    return Progress(state.epoch, plan.epochs, sum(means), parts, held_out, rate, seen, spent, speed, done)
