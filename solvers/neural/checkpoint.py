"""All that resuming a training run needs, in one file that replaces the last one whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch

from geometry.errors import InputError


def save_checkpoint(
    path: Path, net: torch.nn.Module, optimiser: torch.optim.Optimizer, settings: dict[str, Any], epoch: int
) -> None:
    """Write the state after `epoch` epochs."""
    part = path.with_name(path.name + ".part")
    state = {
        "net": net.state_dict(),
        "optimiser": optimiser.state_dict(),
        "settings": settings,
        "epoch": epoch,
    }
    torch.save(state, part)
    part.replace(path)


def load_checkpoint(
    path: Path, net: torch.nn.Module, optimiser: torch.optim.Optimizer, settings: dict[str, Any]
) -> int:
    """Bring `net` and `optimiser` to the checkpoint's state and return its epochs, 0 when there is no file.

    Raises
    ------
    InputError
        a file that is no checkpoint, or one of a run with other settings.
    """
    if not path.exists():
        return 0
    try:
        state = torch.load(path, weights_only=True)
        had = state["settings"]
    except Exception as error:
        raise InputError(
            f"not a checkpoint ({type(error).__name__})", "remove it", source=str(path)
        ) from error
    if had != settings:
        other = ", ".join(f"{key} {had.get(key)!r}" for key in settings if had.get(key) != settings[key])
        raise InputError(
            f"the checkpoint was made with {other}", "repeat that or remove it", source=str(path)
        )
    net.load_state_dict(state["net"])
    optimiser.load_state_dict(state["optimiser"])
    return int(state["epoch"])
