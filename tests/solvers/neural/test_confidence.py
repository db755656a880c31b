"""Expected errors of networks' answers rank them as their true errors do, and decide on fallbacks."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from families import arches
from scipy.stats import spearmanr

sys.path.insert(0, str(Path(__file__).parents[3] / "benchmarks"))
from yardstick.shapes import shapes

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.compare import compare
from meshonet.solvers.conformal.solve import solve as conformal
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural import inference
from meshonet.solvers.neural.confidence import Goal, expected_error
from meshonet.solvers.neural.inference import infer_many
from meshonet.solvers.neural.registry import load

KINDS = {
    "quad-general": ("wavy", "duct", "bumps"),
    "hole-o": ("star", "slab"),
    "airfoil-o": ("slab", "section"),
}


def boundaries(kind: str, count: int, ni: int = 65, nj: int = 33) -> list[Boundary]:
    drawn = shapes(kind, 5, count, ni, nj)
    return [Boundary(s.south, s.north, s.west, s.east, s.topology, name=s.name) for s in drawn]  # type: ignore[arg-type]


@pytest.mark.parametrize("model", KINDS)
def test_answers_on_unseen_kinds_of_shapes_are_ranked_as_by_their_true_errors(model: str) -> None:
    operator, pairs = load(model), []
    for boundary in (one for kind in KINDS[model] for one in boundaries(kind, 6)):
        exact = conformal([boundary], 12)[0] if model == "airfoil-o" else variational(boundary)
        answer = operator.solve([boundary], "off")[0]
        true = compare(answer.grid, exact.grid).relative_l2
        pairs.append((true, operator.expected_error(boundary, answer)))
    assert spearmanr(*zip(*pairs, strict=True))[0] >= 0.8


@pytest.mark.parametrize("goal", ["winslow", "variational"])
@pytest.mark.parametrize("size", [0.003, 0.03])
def test_a_known_displacement_is_expected(goal: Goal, size: float) -> None:
    boundary = boundaries("wavy", 1, 33, 33)[0]
    exact = (winslow(boundary, tol=1e-9) if goal == "winslow" else variational(boundary, tol=1e-7)).grid
    xi, eta = np.meshgrid(*[np.linspace(0, 1, 33)] * 2, indexing="ij")
    wave = np.sin(2 * np.pi * xi) * np.sin(3 * np.pi * eta)
    moved = boundary.grid(exact.nodes + size * wave[..., None] * np.array([1.0, -0.5]))
    true = compare(moved, exact).relative_l2
    assert 0.5 * true < expected_error(moved, boundary, goal) < 1.5 * true
    assert expected_error(exact, boundary, goal) < 1e-3


def test_large_grids_are_judged_on_fewer_nodes() -> None:
    errors = []
    for n in (129, 385):
        boundary = boundaries("duct", 1, n, n)[0]
        (answer,) = load("quad-general").solve([boundary], "off")
        errors.append(expected_error(answer.grid, boundary, "variational"))
    assert errors[1] == pytest.approx(errors[0], rel=0.2)


def test_accepted_answers_stay_and_others_are_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = boundaries("wavy", 1, 33, 33)[0]
    (answer,), (kept,) = (
        infer_many([boundary], "quad-general"),
        infer_many([boundary], "quad-general", fallback=True),
    )
    assert answer.confidence is not None
    assert answer.confidence.accepted
    assert np.array_equal(answer.grid.nodes, kept.grid.nodes)
    monkeypatch.setattr(inference, "THRESHOLD", 0.5 * answer.confidence.expected_error)
    (refused,), (solved,) = (
        infer_many([boundary], "quad-general"),
        infer_many([boundary], "quad-general", fallback=True),
    )
    assert np.array_equal(refused.grid.nodes, answer.grid.nodes)
    assert np.array_equal(solved.grid.nodes, variational(boundary).grid.nodes)
    assert solved.confidence is not None
    assert not solved.confidence.accepted
    assert (
        "the answer of quad-general was replaced by the variational method's: its expected error is"
        in solved.notes[-1]
    )


def test_folded_answers_are_not_accepted() -> None:
    samples = arches(n=17)
    boundary = samples.boundaries()[0]
    nodes = boundary.grid(samples.nodes[0]).nodes.copy()
    nodes[8, 8], nodes[9, 8] = nodes[9, 8].copy(), nodes[8, 8].copy()

    operator = load("quad-general")
    folded = operator.solve([boundary], "off")[0]
    folded = inference.replace(folded, grid=boundary.grid(nodes))
    judged = inference._judged(operator, boundary, folded, fallback=True)
    assert judged.confidence is not None
    assert not judged.confidence.accepted
    assert "cells are folded" in judged.notes[-1]


def test_without_a_network_there_is_no_confidence() -> None:
    boundary = boundaries("star", 1)[0]
    assert infer_many([boundary], "base")[0].confidence is None


def test_a_diverging_step_is_an_infinite_error(monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = boundaries("slab", 1)[0]
    operator = load("airfoil-o")
    (answer,) = operator.solve([boundary], "off")
    assert 0 < operator.expected_error(boundary, answer) < 0.1
    monkeypatch.setattr("meshonet.solvers.conformal.solve.DIVERGED", 0.0)
    assert operator.expected_error(boundary, answer) == math.inf
