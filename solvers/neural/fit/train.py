"""Training of any model: its task, the training loop, held-out figures, and the model file."""

from collections.abc import Callable, Mapping
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.loop import Progress, Run, beside, fit
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.models.architectures import MODELS

OF_VOLUMES = "meshnet-volume"  # name of ``meshnet`` when it is trained on volumes

TRAINERS = {
    "strip": "meshonet.solvers.neural.fit.strip",
    "quad": "meshonet.solvers.neural.fit.quad",
    OF_VOLUMES: "meshonet.solvers.neural.fit.volume",
}
"""Modules with the training of models that have tasks of their own."""


def train(
    model: str, data: Any, output: Path, plan: Plan, team: Team, *, recipe: Mapping[str, Any],
    held_out: int | None = None, resume: bool = False, report: Callable[[Progress], None] | None = None,
    **choices: Any,
) -> dict[str, Any]:  # fmt: skip
    """Train a model, write its file, and return its error measures on held-out shapes.

    Raises InputError if there is no such model, if shapes are too few, if the checkpoint has another model,
    data or settings, or if choices do not suit the model. Raises SolverError as `fit.loop.fit`.

    Parameters
    ----------
    model : one of `models.architectures.MODELS`, or `OF_VOLUMES`.
    data : `Strips` for ``strip``, `Quads` for ``quad``, `list[SixFaces]` for `OF_VOLUMES`, else `Samples`.
    output : path of the model file.
    plan : settings of the training loop (see `standard`).
    team : rank and device of this process, and the number of processes that train the model together.
    recipe : settings to store in the model file.
    held_out : number of shapes that are not used for training; None: the default of the model.
    resume : whether to continue from the checkpoint that belongs to `output`.
    report : called every `plan.log_every` epochs and at the end.
    choices : options of the model. They are further parameters of `fit.strip.run`, `fit.quad.run`,
        `fit.volume.run` (for `OF_VOLUMES`) or `fit.operators.run` (for all other models).
    """
    module = _module(model)
    held_out = module.HELD_OUT if held_out is None else held_out
    run: Run = module.run(model, data, plan, team, held_out, **choices)
    checkpoint = beside(output)
    facts = {"model": model, **run.recipe, **run.identity}
    epoch = fit(run.task, plan, team, checkpoint=checkpoint, facts=facts, resume=resume, report=report)
    figures = run.task.figures(epoch)
    if team.leads:
        run.task.write(output, recipe={**recipe, **run.recipe}, figures=figures)
        checkpoint.unlink(missing_ok=True)
    return figures


def standard(model: str) -> Plan:
    """Return the default settings for training `model`."""
    plan: Plan = _module(model).PLAN
    return plan


def _module(model: str) -> Any:
    if model not in (*MODELS, OF_VOLUMES):
        raise InputError(f"model {model!r} is not known", "use one of " + ", ".join(MODELS))
    return resolve_name(TRAINERS.get(model, "meshonet.solvers.neural.fit.operators"))
