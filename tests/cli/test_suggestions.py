"""Errors name the nearest command, option, choice, file, model, format or metric."""

from pathlib import Path

import pytest
from command_line import Meshonet


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (("plott", "g.vts"), "Did you mean 'plot'?"),
        (("infer", "naca:0012", "--topolgy", "c"), "no such option --topolgy; did you mean '--topology'?"),
        (("solve-pde", "naca:0012", "-o", "g.h5", "--method", "winslo"), "did you mean 'winslow'?"),
        (("quality", "duct.vst"), "duct.vst: no such file; did you mean 'duct.vts'?"),
        (("quality", "naca2412"), "naca2412: no such file; did you mean naca:2412?"),
        (("infer", "NACA 0012-sharp", "-o", "g.h5"), "no such file; did you mean naca:0012-sharp?"),
        (("infer", "circle0.5", "-o", "g.h5"), "no such file; did you mean circle:0.5?"),
        (("infer", "naca:0012", "-o", "g.h5", "--model", "airfoil"), "did you mean 'airfoil-o'?"),
        (("models", "airfol-o"), "did you mean 'airfoil-o'?"),
        (("convert", "naca:0012", "g.x", "--to", "cgsn"), "did you mean 'cgns'?"),
        (("convert", "naca:0012", "g.cgs"), "did you mean '.cgns'?"),
        (("plot", "duct.vts", "-o", "g.png", "--metric", "max_angel"), "did you mean 'max_angle'?"),
        (("quality", "duct.vts", "--fail-on", "max_angel>3"), "did you mean 'max_angle'?"),
    ],
)
def test_the_nearest_is_named(meshonet: Meshonet, words: tuple[str, ...], near: str) -> None:
    Path("duct.vts").touch()
    done = meshonet(*words)
    assert done.code == 2
    assert near in done.err
    assert done.err.count("\n") == 1


@pytest.mark.parametrize(
    "words",
    [
        ("quality", "zebra.vts"),
        ("infer", "naca:0012", "--xyzzy"),
        ("infer", "naca:0012", "-o", "g.h5", "--model", "z"),
    ],
)
def test_nothing_is_named_where_nothing_is_near(meshonet: Meshonet, words: tuple[str, ...]) -> None:
    done = meshonet(*words)
    assert done.code == 2
    assert "did you mean" not in done.err
