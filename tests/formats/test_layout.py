"""Layouts as JSON: written, read back, damaged."""

import contextlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from domains import ring_layout, step_layout
from format_shapes import memory

from meshonet.formats.layout.read import read_grids, read_layout, read_shapes
from meshonet.formats.layout.write import as_dict, as_text, write_layouts
from meshonet.formats.registry import format_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.shapes.airfoil.naca import naca


def read(text: str) -> Layout:
    return read_layout(memory(text.encode(), "layout.json"))


@pytest.mark.parametrize(
    "layout", [step_layout(), ring_layout(), ring_layout(cuts=3)], ids=["step", "o", "ring"]
)
def test_a_layout_is_read_as_it_was_written(layout: Layout) -> None:
    again = read(as_text(layout))
    assert len(again.blocks) == len(layout.blocks)
    for block, other in zip(layout.blocks, again.blocks, strict=True):
        nodes, others = layout.mesh.nodes[block], again.mesh.nodes[other]
        assert nodes.shape == others.shape
        np.testing.assert_allclose(nodes, others, rtol=0, atol=1e-12)
        for name in ("loop", "cells"):
            own, read_back = (getattr(each.mesh.places, name) for each in (layout, again))
            assert np.array_equal(own[block], read_back[other]), name
        np.testing.assert_allclose(again.mesh.places.arc[other], layout.mesh.places.arc[block], atol=1e-12)
    assert len(again.mesh.nodes) == len(layout.mesh.nodes), "shared nodes are written once"
    assert as_text(again) == as_text(read(as_text(again))), "what was read is written the same"
    own, other = layout.mesh.domain, again.mesh.domain
    assert [loop.names for loop in own.loops] == [loop.names for loop in other.loops]
    assert own.area == other.area


def test_a_layout_says_vertices_edges_and_faces() -> None:
    facts = as_dict(step_layout())
    assert [len(facts[key]) for key in ("vertices", "edges", "faces")] == [8, 10, 3]
    assert sorted(edge["cells"] for edge in facts["edges"]) == [3, 3, 3, 4, 4, 4, 4, 8, 8, 8]
    inner = [edge for edge in facts["edges"] if "loop" not in edge]
    assert len(inner) == 2, "between the blocks above, and between those behind the step"
    assert {vertex["place"] for vertex in facts["vertices"] if "place" in vertex} >= {0, 1, 2, 3, 4, 5}
    assert [face["cells"] for face in facts["faces"]] == [[4, 3], [8, 3], [8, 4]]


def test_a_smooth_curve_with_corners_comes_back_bitwise() -> None:
    curve = naca("2412").curve
    layout = ring_layout()
    corners = tuple(int(k) for k in curve.corner_index)
    circle = layout.mesh.domain.loops[0]
    text = json.loads(as_text(layout))
    domain = Domain((circle, Loop(curve, corners, ("wing",))))
    text["loops"] = as_dict(replace(layout, mesh=replace(layout.mesh, domain=domain)))["loops"]
    wing = text["loops"][1]
    assert wing["kinks"] == list(corners)
    loop = Loop(curve, corners, ("wing",))
    again = read_loops(text)[1]
    places = np.linspace(0, loop.length, 999)
    assert np.array_equal(loop.at(places), again.at(places))


def read_loops(facts: dict[str, Any]) -> tuple[Loop, ...]:
    from meshonet.formats.layout.read import _loop
    from meshonet.formats.layout.values import Values

    return tuple(_loop(row) for row in Values(facts).rows("loops"))


def test_a_layout_is_a_grid_and_a_domain(tmp_path: Path) -> None:
    path = tmp_path / "step.json"
    write_layouts(path, [step_layout()])
    source = memory(path.read_bytes(), "step.json")
    assert format_of(source).name == "layout"
    (grid,) = read_grids(source)
    assert (len(grid.blocks), len(grid.connections)) == (3, 2)
    assert measure(grid).folded == 0
    assert {patch.name for patch in grid.patches} == {"floor", "step", "bottom", "outlet", "roof", "inlet"}
    (shape,) = read_shapes(source)
    assert (shape.many, shape.name, len(shape.domain.loops)) == (True, "step", 1)
    with pytest.raises(InputError, match="a file holds one layout and there are 2"):
        write_layouts(path, [step_layout()] * 2)


def change(facts: dict[str, Any], at: tuple[Any, ...], value: Any) -> None:
    for key in at[:-1]:
        facts = facts[key]
    facts[at[-1]] = value


DAMAGED = {
    "format": (("format",), "other", "is no layout; write one: meshonet layout DOMAIN -o"),
    "version": (("version",), 2, "is a layout of version 2; this program reads version 1"),
    "name": (("name",), 5, "name is no text"),
    "no loops": (("loops",), [], "loops are no list of objects; write the layout again"),
    "points": (("loops", 0, "points"), [[0, 0], [1, 0]], r"loops\[0\]: points are not points x, y"),
    "huge": (("loops", 0, "points", 0), [0, 1e200], r"loops\[0\]: points are not finite or far too large"),
    "text": (("loops", 0, "points", 0), ["a", 1], r"loops\[0\]: points are no numbers"),
    "corner": (("loops", 0, "corners", 0), 17, r"loops\[0\]: corners has '17', which is none of 0 to 5"),
    "order": (("loops", 0, "corners"), [1, 0], r"loops\[0\]: its corners do not ascend"),
    "names": (("loops", 0, "names"), ["a", "b"], r"loops\[0\]: 2 names for 6 stretches"),
    "vertex": (("vertices", 0, "place"), 6.5, r"vertices\[0\]: a place is not on a loop of 6 corners"),
    "no place": (("vertices", 0, "place"), None, r"vertices\[0\]: its places are no|not finite"),
    "nowhere": (("vertices", 0, "loop"), 3, r"vertices\[0\]: loop has '3', which is none of 0 to 0"),
    "end": (("edges", 0, "vertices"), [0, 99], r"edges\[0\]: vertices has '99', which is none of 0 to 7"),
    "cells": (("edges", 0, "cells"), 2, r"edges\[0\]: has 2 cells and \d nodes between its ends"),
    "true": (("edges", 0, "cells"), True, r"edges\[0\]: cells is no count"),
    "side": (("faces", 0, "south"), [], r"faces\[0\]: has no edges on south"),
    "no edge": (("faces", 0, "south"), [-77], r"faces\[0\]: names edge -77 of 10"),
    "counts": (("faces", 0, "south"), [1], r"faces\[0\]: opposite sides have different counts|do not meet"),
    "size": (("faces", 0, "cells"), [3, 4], r"faces\[0\]: its sides have 4 x 3 cells, and it says otherwise"),
    "inside": (("faces", 0, "points"), [], r"faces\[0\]: has 0 nodes inside, not 6"),
    "twice": (
        ("faces", 1),
        None,
        "is a side of 2 faces, not 1|of 1 faces, not 2",
    ),
    "list": (("faces",), [3], "faces are no list of objects"),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_a_damaged_layout_is_refused_with_the_place(case: str) -> None:
    facts = as_dict(step_layout())
    at, value, message = DAMAGED[case]
    if case == "twice":
        value = facts["faces"][0]
    facts = json.loads(json.dumps(facts))
    change(facts, at, value)
    with pytest.raises(InputError, match=message):
        read(json.dumps(facts))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON"),
        ("[" * 100_000, "is not JSON"),
        ("[]", "is no layout"),
        ("\xff", "is not JSON|is no layout"),
        ('{"format": "meshonet-layout", "version": 1}', "loops are no list of objects"),
    ],
)
def test_what_is_no_layout_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_layout(memory(text.encode("latin-1"), "layout.json"))


def test_any_value_turned_into_another_is_a_layout_or_one_line() -> None:
    """Every value of the file replaced by strange ones: no other error than an InputError."""
    facts = json.loads(as_text(step_layout()))
    places = list(leaves(facts))
    rng = np.random.default_rng(1)
    for at in [places[k] for k in rng.choice(len(places), 25, replace=False)]:
        for value in (None, -1, 1e308, "x", [], {}, [[[]]], 10**400, float("nan")):
            damaged = json.loads(json.dumps(facts))
            change(damaged, at, value)
            with contextlib.suppress(InputError):
                read(json.dumps(damaged))


def leaves(value: Any, at: tuple[Any, ...] = ()) -> Any:
    """Places of everything in a JSON value."""
    if at:
        yield at
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, each in items:
        yield from leaves(each, (*at, key))
