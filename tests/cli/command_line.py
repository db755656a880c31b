"""What tests of commands share: the types of their fixtures, edges made by hand, and datasets of them."""

import contextlib
import json
import os
import pty
import select
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
BOUNDARY_COMMANDS = ("sample-boundary", "tfi", "solve-pde", "infer")
"""Commands that take boundaries."""


@dataclass(frozen=True)
class Outcome:
    """What a run of the program left behind."""

    code: int
    out: str
    err: str

    @property
    def objects(self) -> list[dict[str, Any]]:
        """Every line of standard output as JSON."""
        return [json.loads(line) for line in self.out.splitlines()]

    @property
    def only(self) -> dict[str, Any]:
        """The one JSON object on standard output."""
        (report,) = self.objects
        return report


Meshonet = Callable[..., Outcome]
Process = Callable[..., subprocess.CompletedProcess[bytes]]


def duct(ni: int = 21, nj: int = 11, bump: float = 0.2) -> dict[str, np.ndarray]:
    """Edges of a channel whose floor has a bump in the middle."""
    x, y = np.linspace(0, 2, ni), np.linspace(0, 1, nj)
    floor = bump * np.exp(-20 * (x - 1) ** 2)
    floor[[0, -1]] = 0
    return {
        "south": np.stack([x, floor], axis=-1),
        "north": np.stack([x, np.ones(ni)], axis=-1),
        "west": np.stack([np.zeros(nj), y], axis=-1),
        "east": np.stack([np.full(nj, 2.0), y], axis=-1),
    }


def ellipse(ni: int = 41, nj: int = 15, thickness: float = 0.3) -> dict[str, np.ndarray]:
    """Edges of an O grid around an ellipse of chord 1, in a circle of radius 5."""
    turn = -np.linspace(0, 2 * np.pi, ni)
    around = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    around[-1] = around[0]
    wall, far = 0.5 * around * [1, thickness], 5 * around
    cut = np.linspace(wall[0], far[0], nj)
    return {"south": wall, "north": far, "west": cut, "east": cut}


def wave(n: int = 41) -> dict[str, np.ndarray]:
    """Edges of a channel with a breaking wave in its floor, which transfinite interpolation folds over."""
    edges = duct(n, n, bump=0.0)
    height = np.exp(-8 * (edges["south"][:, 0] - 1) ** 2)
    edges["south"][1:-1] += (height[:, None] * [0.4, 0.6])[1:-1]
    return edges


def dataset(path: Path, topology: str, *samples: dict[str, np.ndarray], names: tuple[str, ...] = ()) -> Path:
    """Write a boundary dataset of layout version 1."""
    with h5py.File(path, "w") as file:
        file.attrs.update(format="meshonet-boundary", version=1, topology=topology)
        for side in ("south", "north", "west", "east"):
            file[side] = np.stack([sample[side] for sample in samples])
        if names:
            file["names"] = list(names)
    return path


@contextlib.contextmanager
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], str]]:
    """Standard error on a pseudo-terminal; what is on it so far is returned by the function it gives."""
    leader, follower = pty.openpty()
    monkeypatch.setenv("TERM", "xterm")
    with os.fdopen(follower, "w") as stream, monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", stream)

        def text() -> str:
            stream.flush()
            shown = b""
            while select.select([leader], [], [], 0.2)[0]:
                shown += os.read(leader, 65536)
            return shown.decode()

        yield text
    os.close(leader)
