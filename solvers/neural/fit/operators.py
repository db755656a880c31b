"""Training of operator models, from solved grids to a model file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.neural.fit.checkpoint import beside
from meshonet.solvers.neural.fit.loop import Progress, fit
from meshonet.solvers.neural.fit.operator_task import OperatorTask
from meshonet.solvers.neural.fit.physics_task import PhysicsTask
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.inference import answered
from meshonet.solvers.neural.model_file import Trained, load_trained, write_trained
from meshonet.solvers.neural.models.mgnet import MGNet
from meshonet.solvers.neural.models.model import Frame, Operator
from meshonet.solvers.neural.registry import settings_of
from meshonet.solvers.neural.samples import Samples

PLAN = Plan(epochs=15_000, points=(1000, 200))
"""The authors' published settings, with their thirty shapes in one step and places drawn at random."""
MACHINE = ("device", "compiled", "log_every", "validate_every", "checkpoint_every")
"""Settings that a resumed run may change without changing what it computes."""


def train_operator(
    samples: Samples,
    output: Path,
    kind: str,
    model: Operator,
    plan: Plan,
    team: Team,
    *,
    held_out: int = 0,
    recipe: Mapping[str, Any],
    resume: bool = False,
    report: Callable[[Progress], None] | None = None,
) -> dict[str, Any]:
    """Fit `model` to the training grids of `samples`, write it to `output` and return its figures.

    Parameters
    ----------
    kind : name of the model in the registry.
    held_out : training grids, spread evenly, that are kept out to watch the loss; test grids never are seen.

    Raises
    ------
    InputError
        too few grids, a checkpoint of another model, data or settings.
    SolverError
        as `meshonet.solvers.neural.fit.loop.fit`.
    """
    rows = np.arange(len(samples)) if model.physics else samples.where("train")
    apart = rows[np.linspace(0, len(rows) - 1, held_out + 2).astype(int)[1:-1]]
    rows = np.setdiff1d(rows, apart)
    if len(rows) < (1 if model.physics else 2) or len(np.unique(apart)) < held_out:
        raise InputError(f"{len(rows)} grids to train on", "give at least 2, or hold fewer out")
    training = samples.pick(rows)
    task: OperatorTask | PhysicsTask
    if isinstance(model, MGNet):
        task = PhysicsTask(model, training, plan.points, plan.seed, team.device)
    else:
        task = OperatorTask(model, training, samples.pick(apart), plan.points, plan.seed, team.device)
    made = {key: value for key, value in asdict(plan).items() if key not in MACHINE}
    facts = {"model": kind, **settings_of(model), **made, "grids": len(rows), "data": samples.fingerprint()}
    checkpoint = beside(output)
    epoch = fit(task, plan, team, checkpoint=checkpoint, facts=facts, resume=resume, report=report)
    frame = Frame(training.topology, training.ni, training.nj, len(training))
    trained = Trained(output.stem, model, frame, task.arrays(), {})
    found = {name: judged(trained, samples.pick(samples.where(name))) for name in ("train", "test")}
    figures: dict[str, Any] = {"epoch": epoch, **{name: told for name, told in found.items() if told}}
    if team.leads:
        told = {"recipe": {**recipe, **made, "grids": len(rows)}, "figures": figures}
        write_trained(output, output.stem, model, kind, frame, task.arrays(), **told)
        load_trained.cache_clear()
        checkpoint.unlink(missing_ok=True)
    return figures


def judged(trained: Trained, samples: Samples) -> dict[str, float]:
    """Return what a model does on samples, before its boundary is replaced: nothing when there are none.

    `median` and `worst` are of the relative L2 error against the solved grids, `boundary` is the largest
    distance of a boundary node from its place, `folded` counts the folded cells of all.
    """
    away, errors, folded = 0.0, [], 0
    for nodes, edges in zip(samples.nodes, samples.boundaries(), strict=True):
        found, off = answered(trained, edges, paste=False)
        away, folded = max(away, off), folded + count_folded(found)
        errors.append(
            compare(
                Grid.from_nodes(found, samples.topology), Grid.from_nodes(nodes, samples.topology)
            ).relative_l2
        )
    if not errors:
        return {}
    median, worst = float(np.median(errors)), float(np.max(errors))
    return {"median": median, "worst": worst, "boundary": away, "folded": folded, "grids": len(errors)}
