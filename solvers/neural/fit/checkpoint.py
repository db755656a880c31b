"""All that resuming a training run needs, in one file that replaces the last one whole."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from meshonet.geometry.errors import InputError, SolverError

FREE = ("rate",)
"""Settings that may change when a run goes on: a smaller rate is the remedy of a loss that is not finite."""


def beside(output: Path) -> Path:
    """Return the checkpoint of a model file."""
    return output.with_name(output.name + ".checkpoint")


def save_checkpoint(path: Path, state: Mapping[str, Any]) -> None:
    """Replace the checkpoint at `path`; a machine that stops in between leaves the last one.

    Raises SolverError: a weight is not finite: the last checkpoint stays.
    """
    for name, value in state["task"].items():
        if not torch.isfinite(value).all():
            raise SolverError(
                f"{name} is not finite after epoch {state['epoch']}; resume from the last "
                "checkpoint with a smaller learning rate"
            )
    part = path.with_name(path.name + ".part")
    with part.open("wb") as file:
        torch.save(dict(state), file)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


def load_checkpoint(path: Path, facts: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the state that was saved, None when there is no file.

    Raises InputError: a file that is no checkpoint, or one of another model or of a run with other settings.
    """
    if not path.exists():
        return None
    try:
        state: dict[str, Any] = torch.load(path, weights_only=True, map_location="cpu")
        had = state["facts"]
    except Exception as error:
        raise InputError(
            f"not a checkpoint ({type(error).__name__})", "remove it", source=str(path)
        ) from error
    if had.get("model") != facts.get("model"):
        raise InputError(
            f"the checkpoint is of model {had.get('model')}, not {facts.get('model')}",
            "remove it, or write to another file",
            source=str(path),
        )
    keys = [key for key in (*facts, *had) if key not in FREE and had.get(key) != facts.get(key)]
    if keys:
        settings = ", ".join(f"{key} {had.get(key)!r}" for key in dict.fromkeys(keys))
        raise InputError(
            f"the checkpoint was made with {settings}", "repeat that or remove it", source=str(path)
        )
    return state
