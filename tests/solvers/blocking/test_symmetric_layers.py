"""Grids with layers of symmetric domains are symmetric to rounding, however many cells they have."""

import numpy as np
import pytest
from symmetric_shapes import SYMMETRIC, amiss, symmetric_domain

from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.make import make_blocks
from meshonet.solvers.blocking.request import BlockRequest


def blocks_of(name, degrees=0.0, **wanted):
    """Return the nodes of the blocks of a domain with layers: at all holes, or at all walls without holes."""
    domain = symmetric_domain(name, degrees)
    walls = () if len(domain.loops) > 1 else tuple(dict.fromkeys(domain.loops[0].names))
    request = BlockRequest(**wanted, walls=walls)
    return [block.nodes for block in make_blocks(DomainShape(domain), request).grid.blocks]


def nodes_of(blocks):
    return np.concatenate([block.reshape(-1, 2) for block in blocks])


@pytest.mark.parametrize("name", SYMMETRIC)
def test_layers_of_symmetric_domains_are_symmetric(name):
    blocks = blocks_of(name, first_cell=1e-3, cells=15_000)
    assert amiss(name, nodes_of(blocks)) < 1e-9


SOME = ("cross", "plate with four holes", "wing")
WANTED = {
    "by y+": {"y_plus": 3.0, "reynolds": 1e5, "cells": 10_000},
    "by their size": {"first_cell": 1e-3, "cell_size": 0.12},
    "in families": {"first_cell": 1e-3, "cells": 3000, "refine": 1},
}


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("wanted", WANTED)
def test_so_are_layers_of_cells(name, wanted):
    blocks = blocks_of(name, **WANTED[wanted])
    assert amiss(name, nodes_of(blocks)) < 1e-9
    if wanted == "in families":
        coarse = nodes_of([block[::2, ::2] for block in blocks])
        assert amiss(name, coarse) < 1e-9


@pytest.mark.parametrize(
    ("name", "degrees"), [("plate with four holes", 13.0), ("wing", 100.0), ("tube bank", 13.0)]
)
def test_mirrors_of_layers_may_have_any_direction(name, degrees):
    blocks = blocks_of(name, degrees, first_cell=1e-3, cells=12_000)
    assert amiss(name, nodes_of(blocks), degrees) < 1e-9
