"""Numbers of cells along named sides, counted on the patches of the grids."""

from collections import Counter

import numpy as np
import pytest
from periodic_domains import BOTH, bank

import meshonet
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.errors import InputError

BOX = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 3.0], [0.0, 3.0]])
SIDES = ["floor", "outlet", "roof", "inlet"]
TURN = 2 * np.pi * np.arange(60) / 60
TUBE = np.stack([2 + 0.5 * np.cos(TURN), 1.5 + 0.5 * np.sin(TURN)], axis=1)
CHANNEL = Domain.of_polygons([BOX, TUBE], names=[SIDES, "tube"])
LAYERS = {"first_cell": {"tube": 1e-2, "floor": 1e-2}, "cells": 3000}


def counted(domain: Domain, **parameters: object) -> Counter[str]:
    """Cells along each name of a grid without folded cells."""
    grid = meshonet.grid(domain, **parameters)  # type: ignore[arg-type]
    assert grid.quality().folded == 0
    cells: Counter[str] = Counter()
    for patch in grid.patches:
        cells[patch.name] += patch.stop - patch.start
    return cells


@pytest.mark.parametrize("count", [{"inlet": 40}, {"inlet": 31, "outlet": 24, "tube": 61}], ids=str)
@pytest.mark.parametrize("more", [{}, {"cells": 9000}, LAYERS], ids=["few", "interpolated", "layers"])
def test_sides_have_the_cells_given_for_them(count: dict[str, int], more: dict[str, object]) -> None:
    cells = counted(CHANNEL, count=count, **more)
    assert {name: cells[name] for name in count} == count


def test_the_total_is_kept_by_the_other_sides() -> None:
    grid = meshonet.grid(CHANNEL, count={"tube": 60}, cells=4000)
    total = sum((block.nodes.shape[0] - 1) * (block.nodes.shape[1] - 1) for block in grid.blocks)
    assert total == pytest.approx(4000, rel=0.1)


@pytest.mark.parametrize("more", [{}, LAYERS], ids=["plain", "layers"])
def test_refinement_doubles_them(more: dict[str, object]) -> None:
    assert counted(CHANNEL, count={"inlet": 35}, refine=1, **(more | {"cells": 1500}))["inlet"] == 70


def test_periodic_sides_share_them() -> None:
    cells = counted(bank(), periodic=BOTH, count={"left": 12, "tubes": 60}, cells=1200)
    assert (cells["left"], cells["right"], cells["tubes"]) == (12, 12, 60)


def test_symmetric_grids_stay_symmetric() -> None:
    domain = Domain.of_polygons([BOX - [3.0, 1.5], TUBE - [2.0, 1.5]], names=[SIDES, "tube"])
    grid = meshonet.grid(domain, count={"inlet": 30}, cells=1500)
    nodes = np.concatenate([block.nodes.reshape(-1, 2) for block in grid.blocks])
    image = nodes * [1.0, -1.0]
    apart = np.hypot(*(image[:, None] - nodes).transpose(2, 0, 1)).min(axis=1)
    assert apart.max() < 1e-9 * domain.extent
    unlike = counted(domain, count={"inlet": 30, "outlet": 20}, cells=1500)
    assert (unlike["inlet"], unlike["outlet"]) == (30, 20)


def test_what_no_blocks_can_have_is_refused() -> None:
    with pytest.raises(InputError, match=r"1 cells along 'inlet'.*or more"):
        meshonet.grid(CHANNEL, count={"inlet": 1}, cells=900)
    for more in ({}, LAYERS):
        with pytest.raises(InputError, match=r"count.*more than 2e"):
            meshonet.grid(CHANNEL, count={"inlet": 100_000, "floor": 100_000}, **more)
    empty = Domain.of_polygons([BOX[:, ::-1]], names=[["inlet", "roof", "outlet", "floor"]])
    with pytest.raises(InputError, match="exclude each other"):
        meshonet.grid(empty, count={"inlet": 20, "outlet": 30}, cells=900)
    with pytest.raises(InputError, match=r"no side 'intake'.*inlet"):
        meshonet.grid(CHANNEL, count={"intake": 20}, cells=900)
    with pytest.raises(InputError, match="goes straight on"):
        meshonet.grid(plate_behind(2.0), count={"plate": 20}, cells=900)


def plate_behind(length: float) -> Domain:
    """Return a box of 6 by 3 with a plate behind a slip wall of some length on its floor."""
    points = np.array([[0.0, 0.0], [length, 0.0], [6.0, 0.0], [6.0, 3.0], [0.0, 3.0]])
    names = ["slip", "plate", "out", "top", "in"]
    return Domain((ring_loop(points, hole=False, corners=list(range(5)), names=names),))


@pytest.mark.parametrize("layers", [{}, {"first_cell": {"slip": 0.05, "plate": 0.05}}], ids=["", "layers"])
def test_a_plate_that_ends_on_a_line_of_symmetry_has_its_count(layers: dict[str, object]) -> None:
    assert counted(plate_behind(3.0), count={"plate": 20}, cells=900, **layers)["plate"] == 20
