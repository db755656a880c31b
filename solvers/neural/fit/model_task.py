"""The common base of both training tasks for the paper's models, on solved grids and physics-informed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.neural.fit.loop import Task
from meshonet.solvers.neural.model_file import PAPER, write_model
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, initial
from meshonet.solvers.neural.models.operator import PaperOperator
from meshonet.solvers.neural.models.sensors import rim, square
from meshonet.solvers.neural.samples import Samples


class ModelTask(Task):
    """Training of a model of the MeshONet paper.

    `targets` (n, ni, nj, 2) are the wanted outputs for the shapes `training`. `points` has the numbers of
    points drawn in each step, inside and on the boundary; None takes all. `seed` seeds initial weights and
    points. The method `figures` measures errors on the attribute `samples`, which is `training` at first.
    """

    def __init__(
        self, model: Architecture, training: Samples, targets: Floats, points: tuple[int, int] | None,
        seed: int, device: torch.device,
    ) -> None:  # fmt: skip
        super().__init__()
        self.model, self.points, self.seed, self.count = model, points, seed, len(training)
        self.samples = training
        self.frame = Frame(training.topology, training.ni, training.nj, len(training))
        for name, value in initial(model.shapes(self.frame), np.random.default_rng([seed, 0])).items():
            self.register_parameter(name, nn.Parameter(tensor(value)))
        self.fixed = tensors(model.fixed(training, targets), device)
        on = rim(training.ni, training.nj, training.topology)
        self.inside, self.outside = np.flatnonzero(~on), np.flatnonzero(on)
        self.places = tensor(square(training.ni, training.nj)).to(device)

    def arrays(self) -> Arrays:
        """Return the arrays of the model by name, trained ones and constant ones."""
        trained = {name: value.detach().cpu().numpy() for name, value in self.named_parameters()}
        return {**trained, **{name: value.cpu().numpy() for name, value in self.fixed.items()}}

    def operator(self, name: str = "trained") -> PaperOperator:
        """Return the operator with the current weights."""
        return PaperOperator(name, self.frame.topology, {}, self.model, self.frame, self.arrays())

    def figures(self, epoch: int) -> dict[str, Any]:
        """Return the epoch, and the errors of predicted training grids and test grids (see `judged`)."""
        operator, own = self.operator(), self.samples
        parts = {name: judged(operator, own.pick(own.where(name))) for name in ("train", "test")}
        return {"epoch": epoch, **{name: figures for name, figures in parts.items() if figures}}

    def write(self, path: Path, *, recipe: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
        """Write the model file with arrays in float32."""
        arrays = {key: value.astype(np.float32) for key, value in self.arrays().items()}
        facts = self.operator().facts()
        write_model(path, PAPER, arrays, name=path.stem, recipe=recipe, figures=figures, **facts)


def judged(operator: PaperOperator, samples: Samples) -> dict[str, float]:
    """Return the errors of the grids that a model predicts for `samples`; {} without samples.

    ``median`` and ``worst`` are statistics of the relative L2 error against the solved grids. ``boundary`` is
    the greatest distance of a predicted boundary node from the given one. ``folded`` is the number of folded
    cells in all grids, ``grids`` the number of grids.
    """
    boundary, errors, folded = 0.0, [], 0
    for nodes, edges in zip(samples.nodes, samples.boundaries(), strict=True):
        own, away = operator.nodes(edges, paste=False)
        boundary, folded = max(boundary, away), folded + count_folded(own)
        errors.append(compare(edges.grid(own), edges.grid(nodes)).relative_l2)
    if not errors:
        return {}
    median, worst = float(np.median(errors)), float(np.max(errors))
    return {"median": median, "worst": worst, "boundary": boundary, "folded": folded, "grids": len(errors)}


def tensor(array: Any) -> Tensor:
    """Return an array as a tensor in single precision."""
    return torch.tensor(np.asarray(array), dtype=torch.float32)


def tensors(arrays: Arrays, device: torch.device) -> dict[str, Tensor]:
    """Return arrays as tensors in single precision on a device."""
    return {name: tensor(value).to(device) for name, value in arrays.items()}
