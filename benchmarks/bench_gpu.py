"""Everything that needs a GPU: training, batched operators, equality with the CPU, memory.

    python benchmarks/bench_gpu.py [--device cuda] [--quick] [--page docs/benchmarks/gpu.md]

One command under eight minutes. Without a CUDA device it says so on the page; `--device cpu --quick` runs
all of it in seconds on a CPU, to see that it works.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import torch
from page import arguments, processor, publish

import meshonet
from meshonet import layer
from meshonet.formats.hdf5.write import write_grids
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.devices import Device
from meshonet.solvers.neural.inference import infer_many
from meshonet.solvers.neural.registry import load

HEAD = """# GPU

<!-- made by python benchmarks/bench_gpu.py --page docs/benchmarks/gpu.md -->

Use this page to find the speed of training and of batched neural operators on a GPU. For its use see
[threads and GPUs](../guide/threads-and-gpu.md). `python benchmarks/bench_gpu.py --page
docs/benchmarks/gpu.md` measures these values in less than eight minutes:

- *training*: shapes per second and peak memory of `meshonet`, `fno2d` and `quad`, for two batch sizes, with
  and without `--amp` and `--compile`; the first epochs are not counted;
- *operators*: grids per second and peak memory of `airfoil-o`, `quad-general` and `hole-o` in batches, with
  65 x 65 and 200 x 200 nodes, from boundaries in memory to nodes in memory;
- *layers*: grids per second of `meshonet.layer`, exact solvers beside the network `quad-general`, for batches
  of sides in the memory of the device, forward, and forward and backward together; peak memory; whether two
  runs have the same bits; the largest distance from the compiled solver or operator on the CPU, relative to
  the domain size. The last rows are single grids of 800 x 800 and 3200 x 3200 nodes, without gradients;
- *equality*: the largest distance between the nodes on the GPU and those of the same operator on the CPU in
  double precision. It must be below 1e-10 of the domain size.
"""

NONE = "No GPU was available when this page was made, so it has no values yet."
EQUAL = 1e-10
"""The largest distance of nodes from those of the CPU."""

FAMILIES = {"airfoil-o": "procedural", "quad-general": "four-sided", "hole-o": "bodies"}
"""Operators, and the families of boundaries that they are given."""
NETWORK = "quad-general"
"""The network beside exact solvers in the table of layers."""
TRAINED = {"meshonet": (30, 240), "fno2d": (30, 120), "quad": (16, 64)}
"""Models and the batch sizes that they are trained with."""


def shapes_for(name: str, count: int, n: int) -> list[Boundary]:
    """Return boundaries that an operator is for, n x n nodes each."""
    return meshonet.sample_family(FAMILIES[name], count, res=(n, n), seed=1)


def most_memory(device: Device, act: Callable[[], object]) -> str:
    """Run and return the most memory that was in use on the device, in MB; a dash on a CPU."""
    if device == "cpu":
        act()
        return "-"
    torch.cuda.reset_peak_memory_stats()
    act()
    return f"{torch.cuda.max_memory_allocated() / 1e6:.0f}"


def operator_rows(device: Device, sizes: Sequence[int], count: int) -> Iterator[str]:
    """Yield the rows of batched operators."""
    yield "| operator | nodes | grids | grids a second | MB | farthest node from the CPU's |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for name in FAMILIES:
        for n in sizes:
            boundaries = shapes_for(name, count, n)
            few = boundaries[:8]
            here = infer_many(few, name, device="cpu")
            there = infer_many(few, name, device=device)
            apart = max(
                float(np.abs(a.grid.nodes - b.grid.nodes).max() / np.ptp(a.grid.nodes))
                for a, b in zip(here, there, strict=True)
            )
            infer_many(boundaries, name, device=device)  # warm
            begun = time.perf_counter()
            memory = most_memory(device, partial(infer_many, boundaries, name, device=device))
            rate = count / (time.perf_counter() - begun)
            verdict = f"{apart:.0e}" if apart <= EQUAL else f"{apart:.0e}: TOO FAR"
            yield f"| `{name}` | {n} x {n} | {count} | {rate:.0f} | {memory} | {verdict} |"


def layer_rows(device: Device, batch: int, n: int, large: Sequence[int]) -> Iterator[str]:
    """Yield the rows of grids as layers: batches of random four-sided domains, and large single grids."""
    yield "| function | nodes | grids | a second | with gradients | MB | same bits | distance |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    jobs = [(NETWORK, n, batch), ("winslow", n, batch), ("variational", n, min(batch, 256))]
    jobs += [(name, m, 1) for m in large for name in (NETWORK, "winslow")]
    for name, m, count in jobs:
        try:
            words = " | ".join(layer_words(device, name, shapes_for("quad-general", count, m)))
        except (MeshonetError, RuntimeError) as error:
            words = f"{str(error).splitlines()[0]} | - | - | - | -"
        yield f"| `{name}` | {m} x {m} | {count} | {words} |"


def layer_words(device: Device, name: str, boundaries: Sequence[Boundary]) -> Iterator[str]:
    """Yield rates, memory, equality of two runs and distance from the compiled solver."""
    function = layer.QuadGrids(NETWORK, device=device) if name == NETWORK else getattr(layer, name)
    count = len(boundaries)
    sides = [
        torch.tensor(np.stack([getattr(b, side) for b in boundaries]), device=device)
        for side in ("south", "north", "west", "east")
    ]
    nodes, first = timed(device, partial(function, *sides))
    again, second = timed(device, partial(function, *sides))
    yield f"{count / min(first, second):.3g}"
    marks: list[float] = []
    if count == 1:
        yield "-"
        memory = most_memory(device, partial(function, *sides))
    else:
        for side in sides:
            side.requires_grad_()
        both = lambda: marks.append(timed(device, lambda: function(*sides).square().mean().backward())[1])  # noqa: E731
        memory = most_memory(device, both)
        yield f"{count / marks[0]:.3g}"
    yield memory
    yield "yes" if torch.equal(nodes, again) else "NO"
    pairs = zip(boundaries[:4], nodes.cpu().numpy(), strict=False)
    apart = max(from_compiled(name, boundary, own) for boundary, own in pairs)
    yield f"{apart:.0e}" if apart <= EQUAL else f"{apart:.0e}: TOO FAR"


def timed(device: Device, act: Callable[[], Any]) -> tuple[Any, float]:
    """Run after the device is idle and until it is idle again; return the result and the seconds."""
    if device == "cuda":
        torch.cuda.synchronize()
    begun = time.perf_counter()
    result = act()
    if device == "cuda":
        torch.cuda.synchronize()
    return result, time.perf_counter() - begun


def from_compiled(name: str, boundary: Boundary, nodes: Floats) -> float:
    """Return the distance of nodes from those of the converged compiled solver, relative to their extent."""
    if name == NETWORK:
        exact = load(NETWORK).solve([boundary], "off")[0].grid.nodes
    elif name == "winslow":
        exact = winslow(boundary, tol=1e-12, max_cycles=100).grid.nodes
    else:
        grid = variational(boundary, tol=1e-8, max_cycles=1000).grid
        exact = meshonet.optimum_derivative(grid.with_nodes(nodes)).grid.nodes
    return float(np.abs(exact - nodes).max() / np.ptp(nodes))


def datasets(folder: Path, count: int, n: int) -> dict[str, list[str]]:
    """Write what the models are trained on; return the files of each."""
    edges = meshonet.sample_family("arch", count, res=(n, n), seed=1)
    smooth, best = [winslow(b).grid for b in edges], [variational(b).grid for b in edges]
    for name, grids in (("winslow", smooth), ("variational", best)):
        write_grids(str(folder / f"{name}.h5"), grids)
    both = [str(folder / "winslow.h5"), str(folder / "variational.h5")]
    return {"meshonet": both[:1], "fno2d": both[:1], "quad": both}


def training_rows(
    device: Device, folder: Path, count: int, n: int, epochs: int, quick: bool
) -> Iterator[str]:
    """Yield the rows of training."""
    files = datasets(folder, count, n)
    yield "| model | batch | amp | compile | shapes a second | MB |"
    yield "| --- | --- | --- | --- | --- | --- |"
    ways = ((False, False),) if quick else ((False, False), (True, False), (False, True))
    for model, batches in TRAINED.items():
        for batch, (amp, compiled) in product(batches[:1] if quick else batches, ways):
            plan = {"epochs": epochs, "batch": min(batch, count - 4), "amp": amp, "compiled": compiled}
            words = f"{'on' if amp else 'off'} | {'on' if compiled else 'off'}"
            try:
                speed, memory = trained(files[model], model, device, folder, plan)
            except (MeshonetError, RuntimeError) as error:
                speed, memory = str(error).splitlines()[0], "-"
            yield f"| `{model}` | {plan['batch']} | {words} | {speed} | {memory} |"


def trained(
    files: Sequence[str], model: str, device: Device, folder: Path, plan: Mapping[str, object]
) -> tuple[str, str]:
    """Train and return shapes a second in the second half of the epochs, and the most memory."""
    marks: list[tuple[int, float]] = []
    act = partial(
        meshonet.train, files, folder / "model.safetensors", model=model, held_out=4, log_every=1,
        report=lambda progress: marks.append((progress.seen, progress.seconds)), device=device, **plan,
    )  # fmt: skip
    memory = most_memory(device, act)
    (first, begun), (last, ended) = marks[len(marks) // 2 - 1], marks[-1]
    return f"{(last - first) / (ended - begun):.0f}", memory


def page(device: Device, quick: bool) -> str:
    """Return the page."""
    if device == "cuda" and not torch.cuda.is_available():
        return f"{HEAD}\n{NONE}\n"
    machine = torch.cuda.get_device_name() if device == "cuda" else processor()
    sizes, count, n = ((33,), 4, 33) if quick else ((65, 200), 256, 65)
    shapes, epochs = (8, 2) if quick else (260, 12)
    with tempfile.TemporaryDirectory() as folder:
        made = list(operator_rows(device, sizes, count))
        layers = list(layer_rows(device, *((4, 17, (65,)) if quick else (4096, 65, (800, 3200)))))
        fitted = list(training_rows(device, Path(folder), shapes, n, epochs, quick))
    parts = "\n".join(["## Operators\n", *made, "\n## Layers\n", *layers, "\n## Training\n", *fitted])
    return f"{HEAD}\n{machine}, torch {torch.__version__}.\n\n{parts}\n"


def main(words: Sequence[str] | None = None) -> str:
    """Print the page, or write it; return it."""
    parser = arguments(__doc__)
    parser.add_argument("--device", choices=("cuda", "cpu"), default="cuda")
    parser.add_argument("--quick", action="store_true", help="seconds, on few shapes")
    chosen = parser.parse_args(words)
    text = page(chosen.device, chosen.quick)
    publish(text, chosen.page)
    return text


if __name__ == "__main__":
    main()
