"""Training of the paper's models, from solved grids."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.model_task import ModelTask
from meshonet.solvers.neural.fit.operator_task import OperatorTask
from meshonet.solvers.neural.fit.physics_task import PhysicsTask
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.task import Run
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.models.mgnet import MGNet
from meshonet.solvers.neural.registry import architecture, settings_of
from meshonet.solvers.neural.samples import Samples

PLAN = Plan(epochs=15_000, points=(1000, 200))
"""The authors' published settings, with their thirty shapes in one step and places drawn at random."""

HELD_OUT = 0

MACHINE = ("device", "compiled", "log_every", "validate_every", "checkpoint_every")
"""Settings that a resumed run may change without changing what it computes."""


def run(
    model: str,
    data: Samples,
    plan: Plan,
    team: Team,
    held_out: int,
    settings: Mapping[str, Any] | None = None,
) -> Run:
    """Return what `train` needs of the training grids of `data`; its test grids are never trained on.

    Parameters
    ----------
    held_out : training grids, spread evenly, that are kept out to watch the loss.
    settings : of the model, in place of its defaults.

    Raises
    ------
    InputError
        too few grids; settings that the model does not have.
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
