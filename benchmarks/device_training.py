"""Rows of a table on training: models on a device, with and without --amp and --compile."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from device_time import LEFT_OUT, Time, most_memory

import meshonet
from meshonet.formats.hdf5.write import write_grids
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.devices import Device
from meshonet.solvers.neural.fit.loop import Progress
from meshonet.solvers.neural.quad.encoding import LATENT

TRAINED = {"meshonet": (30, 240), "fno2d": (30, 120), "quad": (16, 64)}
"""Models and the batch sizes that they are trained with."""
WAYS: dict[str, dict[str, bool]] = {
    "off | off": {},
    "on | off": {"amp": True},
    "off | on": {"compiled": True},
}
"""Cells of the columns for amp and compile, and what they are in a plan."""
LONGEST = {"off | off": 20.0, "on | off": 20.0, "off | on": 75.0}
"""Seconds that a training may take, most of them for compiling."""


@dataclass(frozen=True)
class Trainings:
    """What is trained: shapes of n x n nodes, epochs, batch sizes of a model, models that are compiled."""

    shapes: int = 260
    nodes: int = 65
    epochs: int = 12
    sizes: int = 2
    compiled: tuple[str, ...] = tuple(TRAINED)


def datasets(folder: Path, count: int, n: int) -> dict[str, list[str]]:
    """Write what the models are trained on; return the files of each."""

    def written(name: str, n: int, solve: Callable[[Boundary], Any]) -> str:
        path = str(folder / f"{name}-{n}.h5")
        write_grids(path, [solve(edges).grid for edges in meshonet.sample_family("arch", count, res=(n, n))])
        return path

    smooth = [written("winslow", n, winslow)]
    both = [written("winslow", LATENT, winslow), written("variational", LATENT, variational)]
    return {"meshonet": smooth, "fno2d": smooth, "quad": both}


def training_rows(device: Device, folder: Path, extent: Trainings, left: Time) -> Iterator[str]:
    """Yield the rows of training."""
    files = datasets(folder, extent.shapes, extent.nodes)
    yield "| model | batch | amp | compile | shapes per second | relative speed | relative last loss | MB |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for model, batches in TRAINED.items():
        for batch in batches[: extent.sizes]:
            compiled = batch == batches[0] and model in extent.compiled
            ways = WAYS if compiled else list(WAYS)[:2]
            plan = {"epochs": extent.epochs, "batch": min(batch, extent.shapes - 4)}
            plain: tuple[float, float] | None = None
            for way in ways:
                words = f"{LEFT_OUT} | - | - | -"
                if left.suffices(LONGEST[way]):
                    try:
                        memory, own = trained(files[model], model, device, folder, {**plan, **WAYS[way]})
                        plain = plain or own
                        speed, loss = own[0] / plain[0], own[1] / plain[1]
                        words = f"{own[0]:.0f} | {speed:.2f} | {loss:.2f} | {memory}"
                    except (MeshonetError, RuntimeError) as error:
                        words = f"{str(error).splitlines()[0]} | - | - | -"
                yield f"| `{model}` | {plan['batch']} | {way} | {words} |"


def trained(
    files: Sequence[str], model: str, device: Device, folder: Path, plan: Mapping[str, object]
) -> tuple[str, tuple[float, float]]:
    """Train; return the most memory, then shapes a second in the later epochs and the last loss."""
    marks: list[Progress] = []
    act = partial(
        meshonet.train, files, folder / "model.safetensors", model=model, held_out=4, log_every=1,
        report=marks.append, device=device, **plan,
    )  # fmt: skip
    memory, _ = most_memory(device, act)
    first, last = marks[len(marks) // 2 - 1], marks[-1]
    return memory, ((last.seen - first.seen) / (last.seconds - first.seconds), last.loss)
