"""The interface of a model with its data to the loop and the trainer."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from torch import Tensor, nn


class Task(nn.Module):
    """A model with its training set; parameters and data are on one device.

    `count`: training shapes; `parts`: names of the parts of the loss.
    """

    count: int
    parts: ClassVar[tuple[str, ...]] = ("loss",)

    @abstractmethod
    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the parts of the loss over the shapes `rows`, weighted, each a mean over them.

        `step` seeds what is drawn at random, so that a resumed run and every process draw the same.
        """

    def validate(self) -> dict[str, float]:
        """Return ``loss`` and other figures over the held-out shapes; nothing when there are none."""
        return {}

    @abstractmethod
    def figures(self, epoch: int) -> dict[str, Any]:
        """Return what the trained model does on the held-out shapes; its weights are of `epoch`."""

    @abstractmethod
    def write(self, path: Path, *, recipe: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
        """Write the model file."""


@dataclass(frozen=True)
class Run:
    """A task, the facts for its recipe, and further facts that a resumed run must have in common."""

    task: Task
    recipe: Mapping[str, Any]
    identity: Mapping[str, Any] = field(default_factory=dict)
