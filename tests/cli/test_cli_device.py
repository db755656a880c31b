"""`meshonet infer --device`: the same grids through torch, a batch together, or a clear line."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids

torch = pytest.importorskip("torch")


def same(one: str, other: str) -> bool:
    pairs = zip(read_grids(one), read_grids(other), strict=True)
    return all(np.allclose(a.nodes, b.nodes, rtol=0, atol=1e-9) for a, b in pairs)


def test_airfoils_are_those_without_torch(meshonet: Meshonet) -> None:
    family = ("--family", "airfoil", "--count", "3", "--res", "81x30", "-o", "bodies.h5")
    assert meshonet("sample-boundary", *family).code == 0
    words = ("infer", "bodies.h5", "--model", "airfoil-o", "--polish", "1")
    assert meshonet(*words, "-o", "here.h5").code == 0
    report = meshonet(*words, "--device", "cpu", "-o", "there.h5", "--json").objects
    assert [(one["method"], one["model"], one["folded"]) for one in report] == 3 * [
        ("operator", "airfoil-o", 0)
    ]
    assert same("here.h5", "there.h5")


def test_bodies_without_a_lift_are_solved_all_the_same(meshonet: Meshonet) -> None:
    family = ("--family", "hole", "--count", "1", "--res", "8x9", "-o", "holes.h5")
    assert meshonet("sample-boundary", *family).code == 0
    done = meshonet("infer", "holes.h5", "--device", "cpu", "-o", "grid.vts", "--json").only
    assert done["method"] == "winslow"


def test_four_sided_domains_are_those_without_torch(meshonet: Meshonet, quad_model: str) -> None:
    family = ("--family", "arch", "--count", "3", "--res", "21x17", "-o", "arches.h5")
    assert meshonet("sample-boundary", *family).code == 0
    words = ("infer", "arches.h5", "--model", quad_model, "--polish", "off")
    meshonet(*words, "-o", "here.h5")
    meshonet(*words, "--device", "cpu", "-o", "there.h5")
    assert same("here.h5", "there.h5")


def test_bodies_are_those_without_torch(meshonet: Meshonet) -> None:
    family = ("--family", "hole", "--count", "3", "--res", "41x17", "-o", "holes.h5")
    assert meshonet("sample-boundary", *family).code == 0
    words = ("infer", "holes.h5", "--model", "hole-o", "--polish", "off")
    meshonet(*words, "-o", "here.h5")
    report = meshonet(*words, "--device", "cpu", "-o", "there.h5", "--json").objects
    assert [(one["method"], one["model"]) for one in report] == 3 * [("operator", "hole-o")]
    assert same("here.h5", "there.h5")


def test_what_a_device_cannot_do_is_said(meshonet: Meshonet, quad_model: str) -> None:
    family = ("--family", "arch", "--count", "1", "--res", "21x17", "-o", "arches.h5")
    assert meshonet("sample-boundary", *family).code == 0
    done = meshonet(
        "infer", "arches.h5", "--model", quad_model, "--polish", "2", "--device", "cpu", "-o", "g.h5"
    )
    assert done.code == 2
    assert "steps of descent are not taken on a device; leave --polish or --device out" in done.err
    words = ("--model", "airfoil-o", "--device", "cpu", "-o", "g.h5")
    done = meshonet("infer", "arches.h5", *words)
    assert done.code == 2
    assert "model airfoil-o makes o grids, and this boundary is quad" in done.err
    assert not Path("g.h5").exists()


def test_four_sided_domains_go_to_their_network_when_none_is_named(meshonet: Meshonet, duct_h5: Path) -> None:
    report = meshonet("infer", duct_h5, "--device", "cpu", "-o", "g.h5", "--json").only
    assert (report["model"], report["topology"]) == ("quad-general", "quad")


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a CUDA device")
def test_a_missing_device_is_told(meshonet: Meshonet) -> None:
    done = meshonet("infer", "naca:2412", "--device", "cuda", "-o", "grid.vts")
    assert done.code == 2
    assert "torch sees no CUDA device; use --device cpu, or leave it out" in done.err
    assert not Path("grid.vts").exists()
