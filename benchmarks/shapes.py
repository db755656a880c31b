"""The boundaries of the operator's benchmark, each as a recipe at any finer node count."""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "solvers"))
from random_quads import random_quad

from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.families import procedural
from meshonet.geometry.families.family import family
from meshonet.geometry.families.split import split as divided
from meshonet.geometry.spacing.laws import Spacing
from meshonet.geometry.spacing.sampling import Sampling

SEED = 20_000_003
FIRST = 1000
"""Seed of the first random four-sided domain."""


@dataclass(frozen=True)
class Shape:
    """A boundary by name: `make` gives it with k times the cells; every k-th node of it is the boundary."""

    name: str
    make: Callable[[int], Boundary]


def random_airfoils(count: int, n: int, spacing: Spacing | None = None) -> list[Shape]:
    """Return held-out procedural airfoils of n x n nodes; with `spacing` every wall has that law."""

    def make(seed: int, k: int) -> Boundary:
        nodes = k * (n - 1) + 1
        return procedural.boundary(np.random.default_rng(seed), nodes, nodes, spacing)

    seeds = range(SEED, SEED + count)
    return [Shape(f"procedural {seed}", lambda k, seed=seed: make(seed, k)) for seed in seeds]


def airfoil_files(folder: Path, n: int, spacing: Spacing | None) -> Iterator[Shape]:
    """Yield every file of `folder` that holds an airfoil; with the default spacing where none is given."""
    for path in sorted(folder.glob("*.dat")):
        try:
            section = next(read_shapes(str(path)))
        except MeshonetError as error:
            print(f"refused: {error}")
            continue

        def make(k: int, section: object = section) -> Boundary:
            nodes = k * (n - 1) + 1
            law = {} if spacing is None else {"spacing": spacing}
            return section.boundary(Sampling(nodes, nodes, "o", normalise=True, **law))  # type: ignore[attr-defined]

        yield Shape(path.name, make)


def random_domains(count: int, n: int) -> list[Shape]:
    """Return random four-sided domains of n x n nodes, as many as `count` seeds give."""

    def make(seed: int, k: int) -> Boundary:
        result = random_quad(seed, k * (n - 1) + 1, k * (n - 1) + 1)
        if result is None:
            raise ValueError("no valid domain")
        return result

    seeds = [s for s in range(FIRST, FIRST + count) if random_quad(s, n, n) is not None]
    return [Shape(f"domain {seed}", lambda k, seed=seed: make(seed, k)) for seed in seeds]


def members(name: str, split: str, n: int) -> list[Shape]:
    """Return the tested members of one of the paper's families: six of 36 over its range."""
    drawn = family(name)
    parameters = np.linspace(drawn.low, drawn.high, 36)
    tested = [w == "test" for w in divided(list(parameters), split, low=drawn.to_low)]

    def make(value: float, k: int) -> Boundary:
        return drawn.boundary(value, k * (n - 1) + 1, k * (n - 1) + 1)

    return [Shape(f"{name}-{v:.6g}", lambda k, v=float(v): make(v, k)) for v in parameters[tested]]
