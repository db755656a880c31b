"""Training of the strip operator, from solved strips to its file."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Complexes
from meshonet.solvers.conformal.strip import across, harmonic, picard
from meshonet.solvers.neural.fit.loop import Run, Task
from meshonet.solvers.neural.fit.model_task import tensor
from meshonet.solvers.neural.fit.networks import StripFNO
from meshonet.solvers.neural.fit.plan import Plan
from meshonet.solvers.neural.fit.team import Team
from meshonet.solvers.neural.model_file import STRIP, write_model
from meshonet.solvers.neural.strip.dataset import Strips, make_targets
from meshonet.solvers.neural.strip.encoding import CHANNELS, SCALARS, decode, encode

PLAN = Plan(
    epochs=24, batch=32, rate=2e-3, schedule="cosine", warm_up=100, weight_decay=1e-4, clip=1.0, device="cpu"
)  # those of the shipped model

HELD_OUT = 300  # of the 6,000 shapes: 30 of them lie beyond the 90th percentile

QUANTILES = {"median": 0.5, "p90": 0.9, "worst": 1.0}  # of held-out errors, in the header of the file


@dataclass(frozen=True)
class StripSizes:
    """Sizes of the network: numbers of basis functions, channels, Fourier modes and layers."""

    basis: int = 16
    width: int = 32
    modes: int = 32
    layers: int = 3


class StripTask(Task):
    """Training of the network for airfoils on Winslow's solutions and their mirror images.

    Solutions are grids in a strip, the conformal image of the domain. Errors are measured on `held_out`.
    """

    parts: tuple[str, ...] = ("difference",)

    def __init__(self, training: Strips, held_out: Strips, sizes: StripSizes, device: torch.device) -> None:
        super().__init__()
        targets = make_targets(training, sizes.basis)
        self.held_out, self.basis, self.scale = held_out, targets.basis, targets.scale
        self.net = StripFNO(CHANNELS, SCALARS, 2 * sizes.basis, sizes.width, sizes.modes, sizes.layers)
        self.count, self.device = len(targets.wanted), device
        self.data = [tensor(a).to(device) for a in (targets.channels, targets.scalars, targets.wanted)]
        self.importance = 1.0 / ((self.data[2] ** 2).sum(1).mean(1) + 0.03) ** 0.75
        self.to(device)

    def forward(self, rows: Tensor, step: int) -> Tensor:  # noqa: ARG002 - nothing is drawn
        """Return the weighted mean square error over the strips with indices `rows`."""
        channels, scalars, wanted = (array[rows] for array in self.data)
        error = self.net(channels, scalars).float() - wanted
        return (self.importance[rows] * (error**2).sum(1).mean(1)).mean()[None]

    def validate(self) -> dict[str, float]:
        """Return the median (``loss``), ``p90`` and ``worst`` error of the network on held-out strips."""
        pairs = zip(self.answers(), self.held_out.residual, strict=True)
        errors = [distance(answer, goal) for answer, goal in pairs]
        median, p90, worst = (float(q) for q in np.quantile(errors, list(QUANTILES.values())))
        return {"loss": median, "p90": p90, "worst": worst}

    def answers(self) -> list[Complexes]:
        """Return, per held-out body, predicted Fourier modes of (Winslow's solution - harmonic solution)."""
        channels, scalars, size = encode(self.held_out.wall, self.held_out.far)
        with torch.no_grad():
            out = self.net(tensor(channels).to(self.device), tensor(scalars).to(self.device)).cpu()
        return list(decode(out.numpy().astype(np.float64), self.basis, self.scale, size))

    def figures(self, epoch: int) -> dict[str, Any]:  # noqa: ARG002
        """Return error quantiles of several kinds of grids of held-out shapes, against Winslow's grids."""
        test, errors = self.held_out, dict[str, list[float]]()
        for wall, far, goal, answer in zip(test.wall, test.far, test.residual, self.answers(), strict=True):
            base = harmonic(wall, far, across().eta)
            for way, residual in (
                ("base", np.zeros_like(goal)),
                ("base + 1 Picard", picard(base, 1)[0] - base),
                ("base + 2 Picard", picard(base, 2)[0] - base),
                ("network", answer),
                ("network + 1 Picard", picard(base + answer, 1)[0] - base),
            ):
                errors.setdefault(way, []).append(distance(residual, goal))
        figures: dict[str, Any] = {
            "strips": len(test),
            "error": "root mean square distance to the Winslow solution in the strip, radians",
        }
        for way, values in errors.items():
            figures[way] = {key: float(f"{np.quantile(values, q):.3e}") for key, q in QUANTILES.items()}
        return figures

    def write(self, path: Path, *, recipe: Mapping[str, Any], figures: Mapping[str, Any]) -> None:
        """Write the model file: weights in float16, basis functions in float32."""
        arrays = {key: value.cpu().numpy().astype(np.float16) for key, value in self.net.state_dict().items()}
        arrays["basis"] = self.basis.astype(np.float32)
        made: dict[str, Any] = {"scale": self.scale, "recipe": recipe, "figures": figures}
        write_model(path, STRIP, arrays, path.stem, "o", **made)


def run(
    model: str,  # noqa: ARG001 - there is one
    data: Strips, plan: Plan, team: Team, held_out: int, sizes: StripSizes | None = None,
) -> Run:  # fmt: skip
    """Return the task and the settings with which the network for airfoils is trained.

    The last `held_out` shapes of `data` are not used for training. Raises InputError if too few remain.
    """
    sizes, kept = sizes or StripSizes(), plan.kept(len(data), held_out, "shapes")
    torch.manual_seed(plan.seed)
    facts = {key: getattr(plan, key) for key in ("epochs", "batch", "rate", "warm_up", "seed")}
    facts |= asdict(sizes) | {"held_out": held_out, "strips": len(data)}
    return Run(StripTask(data[:kept], data[kept:], sizes, team.device), facts)


def distance(answer: Complexes, goal: Complexes) -> float:
    """Return the root mean square difference of two functions on n lines, from Fourier modes (modes, n)."""
    return float(np.sqrt((np.abs(answer - goal) ** 2).sum(axis=0).mean()))
