"""What the loop needs of a model and its data."""

from __future__ import annotations

from typing import ClassVar

from torch import Tensor, nn


class Task(nn.Module):
    """A model with its training set; parameters and data are on one device.

    Attributes
    ----------
    count : training shapes.
    parts : names of the parts of the loss.
    """

    count: int
    parts: ClassVar[tuple[str, ...]] = ("loss",)

    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the parts of the loss over the shapes `rows`, weighted, each a mean over them.

        `step` seeds what is drawn at random, so that a resumed run and every process draw the same.
        """
        raise NotImplementedError

    def validate(self) -> dict[str, float]:
        """Return ``loss`` and other figures over the held-out shapes; nothing when there are none."""
        return {}
