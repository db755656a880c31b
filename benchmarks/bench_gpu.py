"""Everything that needs a GPU: training, batched operators, equality with the CPU, memory.

    python benchmarks/bench_gpu.py [--device cuda] [--quick] [--page docs/benchmarks/gpu.md]

No measurement starts after seven minutes, and the command ends within eight; rows say which were not made.
Without a CUDA device the page says that. `--device cpu --quick` runs all of it on a CPU with few and small
grids, to see that it works.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import torch
from device_time import LEFT_OUT, Time, most_memory, timed
from device_training import Trainings, training_rows
from page import arguments, processor, publish

import meshonet
from meshonet import layer
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.devices import Device
from meshonet.solvers.neural.inference import infer_many
from meshonet.solvers.neural.registry import load

TITLE = """# GPU

<!-- made by python benchmarks/bench_gpu.py --page docs/benchmarks/gpu.md -->
"""
HEAD = """
Use this page to find the speed of batches of grids and of training on a GPU, and the differences from the
grids of the CPU. [Threads and GPUs](../guide/threads-and-gpu.md) explains how to use a GPU.

`python benchmarks/bench_gpu.py --page docs/benchmarks/gpu.md` measures for at most eight minutes and writes
this page, with three tables:

- **Layers** for [torch](../guide/layers.md): the solvers `winslow` and `variational`, and the network
  `quad-general`. The boundaries are already in the memory of the GPU. *coarse=65*: the solver runs on 65 x 65
  nodes, and its grid is interpolated. *with gradients*: grids per second if gradients are computed too.
  *same bits*: whether two runs give bitwise equal nodes.
- **Operators**: `infer --device cuda` with three networks.
- **Training**: shapes per second, with and without the options `--amp` and `--compile`. The time of compiling
  does not count. Relative values are relative to training without these options.

*MB* is the peak memory of the GPU. *distance* is the largest distance of a node from the node that the CPU
computes, relative to the size of the domain; above 1e-10 it is marked TOO FAR.
"""

NONE = "This page has no figures yet: no GPU was available when it was made."
EQUAL = 1e-10
"""The largest distance of nodes from those of the CPU."""

FAMILIES = {"airfoil-o": "procedural", "quad-general": "four-sided", "hole-o": "bodies"}
"""Operators, and the families of boundaries that they are given."""
NETWORK = "quad-general"
"""The network beside exact solvers in the table of layers."""

COARSE = ", coarse=65"
LARGE = (NETWORK, "winslow", f"winslow{COARSE}", f"variational{COARSE}")
"""What single large grids are made with."""


@dataclass(frozen=True)
class Extent:
    """What is measured: nodes along a side and counts of grids, for each part."""

    batches: tuple[int, ...] = (64, 256, 4096)
    nodes: int = 65
    large: tuple[int, ...] = (800, 3200)
    operators: tuple[int, ...] = (65, 200)
    count: int = 256
    trainings: Trainings = field(default_factory=Trainings)
    limit: float = 420.0  # seconds after which nothing more is begun


QUICK = Extent((2, 4), 17, (17, 33), (33,), 4, Trainings(8, 33, 4, 1, ("meshonet",)), float("inf"))


def shapes_for(name: str, count: int, n: int) -> list[Boundary]:
    """Return boundaries that an operator is for, n x n nodes each."""
    return meshonet.sample_family(FAMILIES[name], count, res=(n, n), seed=1)


def operator_rows(device: Device, extent: Extent, left: Time) -> Iterator[str]:
    """Yield the rows of batched operators."""
    yield "| operator | nodes | grids | grids per second | MB | distance |"
    yield "| --- | --- | --- | --- | --- | --- |"
    count = extent.count
    for name, n in ((name, n) for name in FAMILIES for n in extent.operators):
        words = f"{LEFT_OUT} | - | -"
        if left.suffices(30.0):
            boundaries = shapes_for(name, count, n)
            few = boundaries[:8]
            here = infer_many(few, name, device="cpu")
            there = infer_many(few, name, device=device)
            apart = max(
                float(np.abs(a.grid.nodes - b.grid.nodes).max() / np.ptp(a.grid.nodes))
                for a, b in zip(here, there, strict=True)
            )
            begun = time.perf_counter()
            memory, _ = most_memory(device, partial(infer_many, boundaries, name, device=device))
            rate = count / (time.perf_counter() - begun)
            words = f"{rate:.0f} | {memory} | {judged(apart)}"
        yield f"| `{name}` | {n} x {n} | {count} | {words} |"


def judged(apart: float) -> str:
    """Return a distance relative to the domain, marked where it is too large."""
    return f"{apart:.0e}" if apart <= EQUAL else f"{apart:.0e}: TOO FAR"


def layer_rows(device: Device, extent: Extent, left: Time) -> Iterator[str]:
    """Yield the rows of grids as layers: batches of random four-sided domains, and large single grids.

    A batch is measured if the time for the one before, by the ratio of their sizes, is left. There are no
    4096 variational grids, since the compiled solver makes their starts one by one.
    """
    yield "| function | nodes | grids | grids per second | with gradients | MB | same bits | distance |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for name in (NETWORK, "winslow", "variational"):
        before, spent = 1, 0.0
        for count in extent.batches if name != "variational" else extent.batches[:2]:
            row, spent = _layer_row(device, name, extent.nodes, count, spent * count / before, left)
            before = count
            yield row
    for name in LARGE:
        spent = 0.0
        for n in extent.large:
            row, spent = _layer_row(device, name, n, 1, 16.0 * spent, left)
            yield row


def _layer_row(
    device: Device, name: str, n: int, count: int, expected: float, left: Time
) -> tuple[str, float]:
    """Return a row and the seconds that it took, the `expected` ones where these are not left."""
    begun = time.perf_counter()
    words = f"{LEFT_OUT} | - | - | - | -"
    if left.suffices(expected):
        try:
            words = " | ".join(layer_words(device, name, shapes_for(NETWORK, count, n)))
        except (MeshonetError, RuntimeError) as error:
            words = f"{str(error).splitlines()[0]} | - | - | - | -"
    else:
        begun -= expected
    return f"| `{name}` | {n} x {n} | {count} | {words} |", time.perf_counter() - begun


def layer_words(device: Device, name: str, boundaries: Sequence[Boundary]) -> Iterator[str]:
    """Yield rates, memory, equality of two runs and distance from the compiled solver."""
    function = function_of(name, device)
    count = len(boundaries)
    sides = sides_of(boundaries, device)
    nodes, first = timed(device, partial(function, *sides))
    again, second = timed(device, partial(function, *sides))
    yield f"{count / min(first, second):.3g}"
    if count == 1:
        yield "-"
        yield most_memory(device, partial(function, *sides))[0]
    else:
        for side in sides:
            side.requires_grad_()
        both = partial(timed, device, lambda: function(*sides).square().mean().backward())
        first = both()[1]
        memory, (_, second) = most_memory(device, both)
        yield f"{count / min(first, second):.3g}"
        yield memory
    yield "yes" if torch.equal(nodes, again) else "NO"
    pairs = zip(boundaries[:4], nodes.cpu().numpy(), strict=False)
    apart = max(from_compiled(name, boundary, own) for boundary, own in pairs)
    yield judged(apart)


def sides_of(boundaries: Sequence[Boundary], device: Device) -> list[torch.Tensor]:
    """Return the sides (batch, n, 2) of boundaries."""
    return [
        torch.tensor(np.stack([getattr(b, side) for b in boundaries]), device=device)
        for side in ("south", "north", "west", "east")
    ]


def function_of(name: str, device: Device) -> Callable[..., torch.Tensor]:
    """Return the function of `meshonet.layer` of a row."""
    if name == NETWORK:
        return layer.QuadGrids(NETWORK, device=device)
    function = getattr(layer, name.removesuffix(COARSE))
    return partial(function, coarse=65) if name.endswith(COARSE) else function


def from_compiled(name: str, boundary: Boundary, nodes: Floats) -> float:
    """Return the distance of nodes from those of the converged compiled solver, relative to their extent.

    Grids from coarse ones are compared with those of the same function on the CPU.
    """
    if name.endswith(COARSE):
        exact = function_of(name, "cpu")(*sides_of([boundary], "cpu"))[0].numpy()
    elif name == NETWORK:
        exact = load(NETWORK).solve([boundary], "off")[0].grid.nodes
    elif name == "winslow":
        exact = winslow(boundary, tol=1e-12, max_cycles=100).grid.nodes
    else:
        grid = variational(boundary, tol=1e-8, max_cycles=1000).grid
        exact = meshonet.optimum_derivative(grid.with_nodes(nodes)).grid.nodes
    return float(np.abs(exact - nodes).max() / np.ptp(nodes))


def page(device: Device, quick: bool) -> str:
    """Return the page."""
    if device == "cuda" and not torch.cuda.is_available():
        return f"{TITLE}\n{NONE}\n{HEAD}"
    machine = torch.cuda.get_device_name() if device == "cuda" else processor()
    extent, begun = QUICK if quick else Extent(), time.perf_counter()
    left = Time(extent.limit)
    lines = [TITLE + HEAD, f"{machine}, torch {torch.__version__}."]
    with tempfile.TemporaryDirectory() as folder:
        for title, rows in (
            ("Layers", layer_rows(device, extent, left)),
            ("Operators", operator_rows(device, extent, left)),
            ("Training", training_rows(device, Path(folder), extent.trainings, left)),
        ):
            lines.append(f"\n## {title}\n")
            for row in rows:
                print(row, file=sys.stderr, flush=True)  # nothing is lost where the machine is
                lines.append(row)
    lines.append(f"\nAll of it took {time.perf_counter() - begun:.0f} s.")
    return "\n".join(lines) + "\n"


def main(words: Sequence[str] | None = None) -> str:
    """Print the page, or write it; return it."""
    parser = arguments(__doc__)
    parser.add_argument("--device", choices=("cuda", "cpu"), default="cuda")
    parser.add_argument("--quick", action="store_true", help="few and small grids")
    chosen = parser.parse_args(words)
    text = page(chosen.device, chosen.quick)
    publish(text, chosen.page)
    return text


if __name__ == "__main__":
    main()
