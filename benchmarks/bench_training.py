"""Training throughput of the faithful MeshONet beside the published scheme: one geometry a step, every place.

    python benchmarks/bench_training.py [--seconds 20] [--page docs/training-speed.md]

The published scheme takes one geometry a step, 15,000 times the thirty of the training set. Three loops
train the same network on the same 30 arches of 101 x 101 nodes, one thread, from the same first weights:

* one by one, all 10,201 places of the grid a step, modules and optimiser as anybody writes them in torch;
* one by one, 1,200 places drawn at random a step, written the same way;
* `meshonet train` with 30, 10 and 5 geometries a step, 1,200 places drawn for all of them.

Processor seconds, since other programs share the machine; the loss is that of every place of every grid,
after as many geometries seen.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import argparse
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from geometry.families.family import family
from solvers.elliptic.solve import solve
from solvers.neural.fit.operator_task import OperatorTask
from solvers.neural.models.meshonet import MeshONet
from solvers.neural.places import lift, rim, sensors, square
from solvers.neural.samples import Samples, gathered

POINTS = (1000, 200)
SEEN = (600, 1_500, 3_000, 6_000, 15_000)
"""Geometries seen at which the losses are compared."""


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--seconds", type=float, default=20.0, help="processor seconds for each one-by-one loop"
    )
    parser.add_argument("--rate", type=float, default=1e-3, help="learning rate of the one-by-one loops")
    parser.add_argument("--batched-rate", type=float, default=3e-3, help="learning rate of the batched loop")
    parser.add_argument("--page", type=Path, help="markdown page to write")
    options = parser.parse_args()
    torch.set_num_threads(1)
    samples = arches()
    loops = {
        "one geometry a step, every place": (one_by_one(samples, None, options.rate), 1),
        "one geometry a step, 1,200 places": (one_by_one(samples, POINTS, options.rate), 1),
    }
    for n in (30, 10, 5):
        loops[f"`meshonet train --batch {n}`"] = (batched(samples, options.batched_rate, n), n)
    rows = {name: run(step, loss, each, options.seconds) for name, ((step, loss), each) in loops.items()}
    text = page(rows)
    print(text)
    if options.page:
        options.page.write_text(text, encoding="utf-8")


def arches() -> Samples:
    """Return thirty solved arches."""
    heights = np.linspace(-0.1, 0.4, 30)
    return gathered(solve(family("arch").boundary(float(h), 101, 101)).grid for h in heights)


Loop = tuple[Callable[[int], None], Callable[[], float]]


def one_by_one(samples: Samples, points: tuple[int, int] | None, rate: float) -> Loop:
    """Return the published scheme's step and its loss over everything."""
    torch.manual_seed(0)
    net, optimiser = (made := Published()), torch.optim.Adam(made.parameters(), rate)
    seen = torch.tensor(np.array([sensors(b, 50) for b in samples.boundaries()]), dtype=torch.float32)
    goal = torch.tensor(samples.nodes.reshape(len(samples), -1, 2), dtype=torch.float32)
    places = torch.tensor(square(101, 101), dtype=torch.float32)
    on = rim(101, 101, "quad")
    inner, outer = (torch.tensor(np.flatnonzero(mask)) for mask in (~on, on))

    def step(k: int) -> None:
        i, o = inner, outer
        if points is not None:
            i = inner[torch.randint(len(inner), (points[0],))]
            o = outer[torch.randint(len(outer), (points[1],))]
        m = k % len(samples)
        inside = ((net(seen[m], places[i]) - goal[m, i]) ** 2).sum(-1).mean()
        outside = ((net(seen[m], places[o]) - goal[m, o]) ** 2).sum(-1).mean()
        loss = 900.0 * inside + 1000.0 * outside
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()

    def everything() -> float:
        with torch.no_grad():
            error = torch.stack(
                [((net(s, places) - g) ** 2).sum(-1) for s, g in zip(seen, goal, strict=True)]
            )
        return float(900.0 * error[:, inner].mean() + 1000.0 * error[:, outer].mean())

    return step, everything


class Published(nn.Module):
    """The same network with torch's own layers, for one geometry at a time."""

    def __init__(self) -> None:
        super().__init__()
        branch = (50, 64, 128, 64, 50)
        self.x, self.y = (_stack(branch, last=False) for _ in "xy")
        self.trunk = _stack((12, 50, 50, 50, 50), last=True)
        self.bias = nn.Parameter(torch.zeros(2))

    def forward(self, seen: Tensor, places: Tensor) -> Tensor:
        """(50, 2) sensors and (p, 2) places to (p, 2)."""
        trunk = self.trunk(lift(torch, places, 4))
        return torch.stack([trunk @ self.x(seen[:, 0]), trunk @ self.y(seen[:, 1])], -1) + self.bias


def _stack(sizes: tuple[int, ...], *, last: bool) -> nn.Sequential:
    layers: list[nn.Module] = []
    for a, b in pairwise(sizes):
        linear = nn.Linear(a, b)
        nn.init.xavier_uniform_(linear.weight)
        nn.init.zeros_(linear.bias)
        layers += [linear, nn.Tanh()]
    return nn.Sequential(*(layers if last else layers[:-1]))


def batched(samples: Samples, rate: float, batch: int) -> Loop:
    """Return the step of `meshonet train` and its loss over everything."""
    task = OperatorTask(MeshONet(), samples, samples, POINTS, 0, torch.device("cpu"))
    optimiser = torch.optim.Adam(task.parameters(), rate, fused=True)
    rng = np.random.default_rng(0)

    def step(k: int) -> None:
        rows = torch.from_numpy(rng.choice(len(samples), batch, replace=False))
        loss = task(rows, k).sum()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()

    return step, lambda: task.validate()["loss"]


def run(
    step: Callable[[int], None], loss: Callable[[], float], each: int, seconds: float
) -> dict[str, object]:
    """Return geometries a processor second and losses by geometries seen, as far as the seconds go."""
    spent, done, losses = 0.0, 0, {}
    for goal in SEEN:
        while done * each < goal and spent < seconds:
            begun = time.process_time()
            step(done)
            spent += time.process_time() - begun
            done += 1
        if done * each >= goal:
            losses[goal] = loss()
    return {"speed": done * each / spent, "losses": losses}


def page(rows: dict[str, dict[str, object]]) -> str:
    """Return the table."""
    slowest = float(next(iter(rows.values()))["speed"])  # type: ignore[arg-type]
    head = ["loop", "geometries a second", "times", *(f"loss after {n:,}" for n in SEEN)]
    lines = [head, ["---"] * len(head)]
    for name, row in rows.items():
        losses: dict[int, float] = row["losses"]  # type: ignore[assignment]
        speed = float(row["speed"])  # type: ignore[arg-type]
        cells = [f"{losses[n]:.2f}" if n in losses else "-" for n in SEEN]
        lines.append([name, f"{speed:,.0f}", f"{speed / slowest:.0f}", *cells])
    table = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    mark = "<!-- made by python benchmarks/bench_training.py -->"
    return f"# Training throughput\n\n{mark}\n\n{TOLD}\n\n{table}\n"


TOLD = """The faithful `meshonet` on 30 arches of 101 x 101 nodes, one thread, processor seconds.
The published scheme takes one geometry a step; whether at every place or at places drawn at random is
not known, so both are here."""


if __name__ == "__main__":
    main()
