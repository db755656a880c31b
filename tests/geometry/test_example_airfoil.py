"""The airfoil file that the package ships is the formula's, and is read as such."""

from pathlib import Path

import numpy as np
import pytest

from meshonet.formats.text.airfoil_dat import parse
from meshonet.geometry.shapes.airfoil.naca import naca, naca_points

FILE = Path(__file__).parents[2] / "examples" / "naca2412.dat"


def written() -> str:
    """Return what the file has to hold: a name, then x y in Selig's order, 61 points a surface."""
    rows = (f"{x:10.7f} {y:10.7f}" for x, y in naca_points("2412", 61) + 0.0)
    return "\n".join(["NACA 2412", *rows]) + "\n"


def test_the_shipped_file_is_the_formula_s():
    """When the formula changes on purpose: FILE.write_text(written())."""
    assert FILE.read_text() == written()


def test_it_is_read_as_that_airfoil():
    got, exact = parse(FILE.read_text(), FILE.name), naca("2412")
    assert got.name == "NACA 2412"
    assert got.gap == pytest.approx(exact.gap, abs=2e-7)
    s = np.linspace(0, 1, 500)
    np.testing.assert_allclose(
        got.curve.at(s * got.curve.length), exact.curve.at(s * exact.curve.length), atol=2e-5
    )
