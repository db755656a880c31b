"""`meshonet infer` on many boundaries with a network: solved together, reported one by one."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet
from inferred import infer

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.solvers.neural.operator import in_batches


@pytest.fixture
def arches(meshonet: Meshonet) -> Path:
    words = ("--family", "arch", "--count", "5", "--res", "21x17", "-o", "arches.h5")
    assert meshonet("sample-boundary", *words).code == 0
    return Path("arches.h5")


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many boundaries went into each call of the solver."""
    counts: list[int] = []
    monkeypatch.setattr(
        "meshonet.solvers.neural.quad.operator.in_batches",
        lambda boundaries, threads: counts.append(len(boundaries)) or in_batches(boundaries, threads),
    )
    return counts


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_dataset_has_the_grids_of_its_members_alone(
    meshonet: Meshonet, arches: Path, quad_model: str, jobs: str
) -> None:
    words = ("--model", quad_model, "--polish", "1", "--jobs", jobs, "--json")
    report = meshonet("infer", arches, *words, "-o", "g.h5").objects
    assert [(one["method"], one["model"], one["cycles"], one["folded"]) for one in report] == 5 * [
        ("operator", "random", 1, 0)
    ]
    for one, boundary in zip(read_grids("g.h5"), read_shapes(str(arches)), strict=True):
        alone = infer(boundary, quad_model, 1).grid
        assert one.name == alone.name
        np.testing.assert_array_equal(one.nodes, alone.nodes)


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_members_that_fail_leave_the_others_alone(
    meshonet: Meshonet, arches: Path, quad_model: str, body_h5: Path, jobs: str
) -> None:
    words = ("--model", quad_model, "--jobs", jobs)
    done = meshonet("infer", body_h5, arches, *words, "-o", "{stem}-{index}.vts")
    assert done.code == 2
    assert "makes quad grids, and this boundary is o; use another model" in done.err
    assert len(list(Path().glob("arches-*.vts"))) == 5


def test_members_of_different_sizes_go_together(meshonet: Meshonet, arches: Path, quad_model: str) -> None:
    meshonet("sample-boundary", "--family", "wrench", "--count", "2", "--res", "30x33", "-o", "w.h5")
    done = meshonet("infer", arches, "w.h5", "--model", quad_model, "-o", "{stem}-{index}.vts", "--json")
    assert {(one["ni"], one["nj"]) for one in done.objects} == {(21, 17), (30, 33)}
    assert done.code == 0


def test_only_members_without_a_file_are_solved(
    meshonet: Meshonet, arches: Path, quad_model: str, solved: list[int]
) -> None:
    words = ("infer", arches, "--model", quad_model, "-o", "{index}.vts", "--skip-existing")
    meshonet(*words)
    Path("1.vts").unlink()
    Path("3.vts").unlink()
    meshonet(*words)
    assert solved == [5, 2]


def test_large_grids_are_solved_a_few_at_a_time(
    meshonet: Meshonet,
    arches: Path,
    quad_model: str,
    solved: list[int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("meshonet.solvers.pipeline.make_grid.MOST_NODES", 2 * 21 * 17)
    meshonet("infer", arches, "--model", quad_model, "-o", "{index}.vts")
    assert solved == [2, 2, 1]


def test_airfoils_go_through_the_network_together(meshonet: Meshonet) -> None:
    words = ("--family", "airfoil", "--count", "3", "--res", "41x21", "-o", "foils.h5")
    assert meshonet("sample-boundary", *words).code == 0
    report = meshonet("infer", "foils.h5", "--polish", "off", "-o", "g.h5", "--json").objects
    assert [(one["model"], one["folded"]) for one in report] == 3 * [("airfoil-o", 0)]
    assert meshonet("infer", "foils.h5", "--polish", "off", "--jobs", "2", "-o", "apart.h5").code == 0
    for one, other in zip(read_grids("g.h5"), read_grids("apart.h5"), strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(one.nodes, other.nodes, rtol=0, atol=1e-11)
