"""Boundaries that have no grid: every way to one ends with 2, one line, and nothing written."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, dataset, duct

Edges = dict[str, np.ndarray]


def straight() -> Edges:
    return duct(31, 21, bump=0.0)


def crossing() -> Edges:
    """The floor rises through the roof."""
    edges = straight()
    edges["south"][1:-1, 1] += 1.4 * np.exp(-30 * (edges["south"][1:-1, 0] - 1) ** 2)
    return edges


def touching() -> Edges:
    """One node of the floor lies on the roof."""
    edges = straight()
    edges["south"][15, 1] = 1.0
    return edges


def backwards() -> Edges:
    """A third of the floor runs the other way."""
    edges = straight()
    edges["south"][10:21, 0] = edges["south"][10:21, 0][::-1]
    return edges


def without_a_number() -> Edges:
    edges = straight()
    edges["south"][5, 0] = np.nan
    return edges


def repeated() -> Edges:
    edges = straight()
    edges["south"][5] = edges["south"][6]
    return edges


def clockwise() -> Edges:
    edges = straight()
    edges["south"], edges["north"] = edges["north"], edges["south"]
    for side in ("west", "east"):
        edges[side] = edges[side][::-1]
    return edges


CASES: dict[Callable[[], Edges], str] = {
    crossing: "south and north cross at (0.896159, 1), behind node 13 of south and node 13 of north",
    touching: "south and north cross at (1, 1), behind node 14 of south and node 15 of north",
    backwards: "south crosses itself at (1.26667, 0), behind its nodes 9 and 10; correct these points",
    without_a_number: "south node 5 is not finite; check the input for NaN or infinity",
    repeated: "south nodes 5 and 6 are the same point",
    clockwise: "runs clockwise or has no area; swap south and north or reverse the edges",
}
WAYS = [
    ("sample-boundary",),
    ("tfi", "--allow-invalid"),
    ("infer",),
    ("infer", "--model", "quad-general", "--allow-invalid"),
    ("infer", "--model", "quad-winslow", "--polish", "off"),
    ("solve-pde", "--method", "winslow"),
    ("solve-pde", "--method", "thomas-middlecoff"),
    ("solve-pde", "--method", "steger-sorenson"),
    ("solve-pde", "--wall-spacing", "1e-4"),
    ("solve-pde", "--wall-spacing", "1e-4", "--slide"),
    ("solve-pde", "--spacing-west", "1e-3", "--constant-layers", "2"),
]


@pytest.mark.parametrize("make", CASES, ids=lambda make: make.__name__)
@pytest.mark.parametrize("words", WAYS, ids=" ".join)
def test_no_grid_no_file_one_line(
    meshonet: Meshonet, tmp_path: Path, make: Callable[[], Edges], words: tuple[str, ...]
) -> None:
    source = dataset(tmp_path / "bad.h5", "quad", make())
    done = meshonet(*words[:1], source, *words[1:], "-o", "g.h5")
    assert done.code == 2
    assert CASES[make] in done.err
    assert done.err.count("\n") == 1
    assert "Traceback" not in done.err
    assert not Path("g.h5").exists()
