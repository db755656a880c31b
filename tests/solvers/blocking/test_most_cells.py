"""Refinements for which the default number of cells is just too large, and too large requests."""

import numpy as np
import pytest

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking import make, request
from meshonet.solvers.blocking.make import make_blocks
from meshonet.solvers.blocking.request import BlockRequest

SHAPE = DomainShape(Domain.of_polygons([np.array([[0.0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])]))


@pytest.fixture
def most(monkeypatch: pytest.MonkeyPatch) -> int:
    for module in (make, request):
        monkeypatch.setattr(module, "MOST_CELLS", 6000)
    return 6000


def test_a_default_just_out_of_reach_is_reduced_with_a_note(most: int) -> None:
    solution = make_blocks(SHAPE, BlockRequest(refine=1))
    cells = sum((block.counts[0] - 1) * (block.counts[1] - 1) for block in solution.grid.blocks)
    assert cells == pytest.approx(most, rel=0.1)
    (note,) = (note for note in solution.notes if "before {refine}" in note)
    assert note == "1500 cells before {refine} instead of 2500: 6000 are the most after it"
    layered = BlockRequest(refine=5, first_cell=1e-3)
    assert layered.default_cells(1) == layered.usual_cells(1)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"refine": 2}, "2500 cells halved 2 times"),
        ({"refine": 1, "cells": 2500}, "2500 cells halved 1 times"),
    ],
)
def test_what_is_far_out_of_reach_or_requested_is_refused(
    words: dict[str, int], message: str, most: int
) -> None:
    with pytest.raises(InputError, match=f"{message} .*{most} are the most"):
        make_blocks(SHAPE, BlockRequest(**words))  # type: ignore[arg-type]


def test_more_bodies_with_layers_have_more_cells_by_default() -> None:
    layered = BlockRequest(y_plus=1.0, reynolds=1e6)
    assert [layered.usual_cells(bodies) for bodies in (0, 1, 2, 3, 9)] == [20000, 20000, 30000, 40000, 40000]
    assert BlockRequest().usual_cells(3) == 2500
