"""Sharp edges opened by ``--base`` have layers where layers fold otherwise."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids
from meshonet.geometry.shapes.airfoil.naca import naca_points

LAYERS = ("--first-cell", "3e-4", "--cells", "6000")


@pytest.fixture
def bodies() -> tuple[Path, Path]:
    """A slat with a thin, hooked trailing edge in front of a section."""
    points = naca_points("6406") * 0.22
    points[:, 1] += 6.0 * (points[:, 0] - 0.12).clip(0.0) ** 2
    points[[0, -1]] = 0.5 * (points[0] + points[-1])
    for name, ring in (("slat", points + np.array([-0.25, 0.01])), ("main", naca_points("2412"))):
        lines = [f"{x:.7f} {y:.7f}" for x, y in ring.tolist()]
        Path(f"{name}.dat").write_text("\n".join([name, *lines]) + "\n")
    return Path("slat.dat"), Path("main.dat")


def test_where_layers_fold_at_a_sharp_edge_the_message_says_what_opens_it(
    meshonet: Meshonet, bodies: tuple[Path, Path]
) -> None:
    folded = meshonet("infer", *bodies, "--assemble", *LAYERS, "-o", "g.cgns")
    assert folded.code == 2
    assert "slat, (-0.030" in folded.err
    assert "at the sharp edge of an airfoil give --base 0.005, or --te round in place of a w" in folded.err
    done = meshonet("infer", *bodies, "--assemble", *LAYERS, "--base", ".005", "-o", "g.cgns")
    assert done.code == 0, done.err


def test_bases_hold_for_each_body_and_are_told(meshonet: Meshonet, bodies: tuple[Path, Path]) -> None:
    done = meshonet("infer", *bodies, "--assemble", *LAYERS, "--base", ".01", "-o", "g.cgns")
    assert done.code == 0, done.err
    assert "slat: the outline is changed: its trailing edge, 0 chords thick, is opened to 0.01" in done.err
    assert "main: the outline is changed: its trailing edge, 0.0025 chords thick, is opened" in done.err


def test_a_c_grid_keeps_the_base_that_an_edge_is_opened_to(meshonet: Meshonet) -> None:
    words = ("naca:0012-sharp", "--first-cell", "1e-4", "--topology", "c", "-o", "g.cgns")
    assert meshonet("infer", *words).code == 0
    assert len(next(iter(read_grids("g.cgns"))).blocks) == 1
    done = meshonet("infer", *words, "--base", ".01")
    assert len(next(iter(read_grids("g.cgns"))).blocks) == 2
    assert done.err.count("is opened to 0.01") == 1
