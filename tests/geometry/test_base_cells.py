"""A note where the cells on a blunt base and beside it are unlike, and a size that puts it right."""

import re

import numpy as np
import pytest

from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling


def notes(name: str, te_spacing: float | None, **more: str) -> str:
    boundary = naca(name).boundary(Sampling(200, 60, "o", "curvature", te_spacing=te_spacing, **more))  # type: ignore[arg-type]
    return "; ".join(boundary.notes)


@pytest.mark.parametrize("name", ["0012", "2424", "4415"])
def test_unlike_cells_at_a_base_are_noted_with_their_ratio_and_a_size_that_fits(name: str) -> None:
    note = notes(name, 1e-3)
    result = re.search(
        r"base are (\S+) times smaller than those beside it: use {te_spacing} near (\S+),", note
    )
    assert result is not None
    ratio, fits = map(float, result.groups())
    wall = naca(name).boundary(Sampling(200, 60, "o", "curvature", te_spacing=1e-3)).south
    steps = np.hypot(*np.diff(wall[:40], axis=0).T)
    assert ratio == pytest.approx((steps[1:] / steps[:-1]).max(), rel=0.03)
    assert "on the base" not in notes(name, fits)


def test_like_cells_and_bases_that_are_none_are_not_noted() -> None:
    assert "on the base" not in notes("0012", None)
    assert "on the base" not in notes("0012", 1e-3, te="round")
    assert "on the base" not in notes("0012-sharp", 1e-3)
