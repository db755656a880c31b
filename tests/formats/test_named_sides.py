"""Domains whose sides are curves of their own, with names: lists of points, WKT and GeoJSON."""

import json
from pathlib import Path

import pytest

import meshonet
from meshonet.geometry.errors import InputError

SIDES = {
    "floor": [(0, 0), (4, 0)],
    "outlet": [(4, 3), (4, 0)],  # the other way round
    "roof": [(4, 3), (2, 3)],
    "step": [(2, 3), (2, 2)],
    "shelf": [(2, 2), (0, 2)],
    "inlet": [(0, 2), (0, 0)],
}
ROD = [(1, 0.5), (1.5, 1), (2, 0.5), (1.5, 0.2), (1, 0.5)]


def written(curves: dict[str, list[tuple[float, float]]], ending: str, path: Path) -> str:
    """Write curves with their names, and return the file."""
    file = path / f"duct.{ending}"
    if ending == "csv":
        text = "".join(
            f"# {name}\n" + "".join(f"{x},{y}\n" for x, y in points) for name, points in curves.items()
        )
    elif ending == "wkt":
        lines = {name: ", ".join(f"{x} {y}" for x, y in points) for name, points in curves.items()}
        text = "".join(f"# {name}\nLINESTRING ({line})\n" for name, line in lines.items())
    else:
        features = [
            {
                "type": "Feature",
                "properties": {"name": name},
                "geometry": {"type": "LineString", "coordinates": points},
            }
            for name, points in curves.items()
        ]
        text = json.dumps({"type": "FeatureCollection", "features": features})
    file.write_text(text)
    return str(file)


@pytest.mark.parametrize("ending", ["csv", "wkt", "geojson"])
@pytest.mark.parametrize("hole", [{}, {"rod": ROD}], ids=["empty", "with a hole"])
def test_open_curves_are_the_sides_of_a_domain(ending: str, hole: dict, tmp_path: Path) -> None:
    grid = meshonet.grid(written(SIDES | hole, ending, tmp_path), cells=300)
    assert {patch.name for patch in grid.patches} == {*SIDES, *hole}
    left = [patch for patch in grid.patches if patch.name == "inlet"]
    for patch in left:  # names are where they were drawn
        nodes = grid.blocks[patch.block].nodes
        side = {"south": nodes[:, 0], "north": nodes[:, -1], "west": nodes[0], "east": nodes[-1]}[patch.side]
        assert abs(side[patch.start : patch.stop + 1, 0]).max() < 1e-12


@pytest.mark.parametrize("ending", ["csv", "wkt"])
def test_sides_that_leave_a_gap_are_refused_with_the_place(ending: str, tmp_path: Path) -> None:
    open_sides = {name: points for name, points in SIDES.items() if name != "shelf"}
    with pytest.raises(InputError, match="2"):
        meshonet.grid(written(open_sides, ending, tmp_path), cells=300)


def test_closed_curves_of_a_list_have_their_names(tmp_path: Path) -> None:
    box = {"box": [(0, 0), (4, 0), (4, 3), (0, 3), (0, 0)], "rod": ROD}
    grid = meshonet.grid(written(box, "csv", tmp_path), cells=300)
    assert {patch.name for patch in grid.patches} == {"box", "rod"}


def test_walls_of_a_channel_keep_their_names(tmp_path: Path) -> None:
    walls = {"floor": [(0, 0), (1, 0.1), (3, 0)], "roof": [(0, 1), (1, 1.2), (3, 1)]}
    for ending in ("csv", "wkt", "geojson"):
        grid = meshonet.grid(written(walls, ending, tmp_path), res=11)
        assert {patch.name for patch in grid.patches} == {"floor", "roof", "inlet", "outlet"}
