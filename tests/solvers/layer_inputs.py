"""Sides of batches for grids as layers, and the functions of sides that have the same tests."""

from functools import partial
from typing import Any

import numpy as np
import pytest
from random_quads import random_quad

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families import procedural
from meshonet.geometry.families.family import family
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling

torch = pytest.importorskip("torch")
from meshonet import layer  # noqa: E402 - it imports torch

LIFTED = partial(layer.winslow, coarse=9), partial(layer.variational, coarse=9)
QUADS = (layer.transfinite, layer.winslow, layer.variational, layer.QuadGrids(), *LIFTED)
NETWORKS = layer.BodyGrids(), layer.AirfoilGrids()
AROUND = (layer.conformal, *NETWORKS)
NAMES = ("south", "north", "west", "east")
AIRFOILS = ("2424", *(f"{name}-sharp" for name in ("4412", "23012", "0024", "6409", "1408", "2412", "0010")))
"""One that converges in some 50 steps, and more that are done before it."""


def domains(ni: int, nj: int, count: int) -> list[Boundary]:
    drawn = [random_quad(seed, ni, nj) for seed in range(count)]
    return [boundary for boundary in drawn if boundary is not None]


def sides_of(boundaries: list[Boundary]) -> list[Any]:
    return [torch.tensor(np.stack([getattr(b, name) for b in boundaries])) for name in NAMES]


def inputs(function: Any, count: int) -> tuple[Any, list[Any]]:
    """Return the function of the sides alone, and sides of `count` members."""
    if function in QUADS:
        counts = (14, 11) if function in LIFTED else (9, 8)
        return function, sides_of(domains(*counts, 2 * count)[:count])
    sections = [naca(name).boundary(Sampling(25, 6, "o", far_field=3.0)) for name in AIRFOILS[:count]]
    if function in (layer.conformal, NETWORKS[1]):
        return lambda south, north: function(south, north, 6), sides_of(sections)[:2]
    holes = [family("hole").boundary(0.1 + 0.2 * k / count, 25, 6) for k in range(count)]
    return lambda south, north: function(south, north, 6), sides_of(holes)[:2]


def uneven() -> Boundary:
    """Return an airfoil with nodes so uneven that 60 plain Picard steps change its grid."""
    return procedural.boundary(np.random.default_rng(20_000_004), 33, 9)
