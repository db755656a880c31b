"""Settings of a training run: the same settings, data and machine give the same weights."""

import math
from dataclasses import dataclass
from typing import Any, Literal

from meshonet.geometry.errors import InputError

Schedule = Literal["cosine", "step"]
Device = Literal["auto", "cpu", "cuda"]
MACHINE = (
    "device",
    "compiled",
    "log_every",
    "validate_every",
    "checkpoint_every",
)  # without effect on the result


@dataclass(frozen=True)
class Plan:
    """Settings of the training loop, such as the numbers of epochs and the learning rate."""

    epochs: int  # passes over the training shapes
    batch: int = 30  # shapes a step
    rate: float = 1e-3  # the largest learning rate
    schedule: Schedule = "step"  # cosine: to zero after `warm_up` steps; step: by `decay` each `decay_every`
    warm_up: int = 0
    decay: float = 0.9
    decay_every: int = 1000  # epochs
    weight_decay: float = 0.0  # of AdamW; Adam when zero
    clip: float | None = None  # largest norm of the gradient
    points: tuple[int, int] | None = None  # drawn for each step, inside and on the boundary; None takes all
    seed: int = 0
    patience: int | None = None  # stop when the held-out loss has not improved over so many epochs
    log_every: int = 1  # epochs between reports
    validate_every: int = 1  # epochs between evaluations of the held-out shapes
    checkpoint_every: int = 1  # epochs
    device: Device = "auto"
    amp: bool = False
    compiled: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.rate < 1:
            raise InputError(f"{self.rate:g} is no learning rate", "use 0.001, say", parameter="rate")

    @property
    def recipe(self) -> dict[str, Any]:
        """Settings that affect the result."""
        return {key: value for key, value in vars(self).items() if key not in MACHINE}

    def kept(self, count: int, held_out: int, what: str) -> int:
        """Return how many of the `count` shapes remain for training; `what` is their name in messages.

        Raises InputError if no shape is held out, or if less than one batch remains.
        """
        if held_out < 1 or count < held_out + self.batch:
            needed = max(held_out, 1) + self.batch
            raise InputError(f"{count} {what} to train on", f"give at least {needed} or hold fewer out")
        return count - held_out

    def rate_at(self, done: int, steps: int) -> float:
        """Return the learning rate of training step number `done`, from 1; an epoch has `steps` steps."""
        warm = min(1.0, done / self.warm_up) if self.warm_up else 1.0
        if self.schedule == "cosine":
            fade = 0.5 * (1.0 + math.cos(math.pi * done / (self.epochs * steps)))
            return self.rate * warm * fade + 1e-6
        return self.rate * warm * self.decay ** ((done - 1) // steps // self.decay_every)
