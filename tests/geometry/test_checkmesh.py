"""Face measures against a plain transcription of OpenFOAM's, in 3D on a mesh of merged nodes."""

from collections.abc import Callable

import numpy as np
import pytest
from block_grids import joined
from test_grid import c_grid

from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality import growth as steps
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import FACE_NAMES

HEIGHT = 0.3


class Mesh:
    """Cells one thick in z, as faces with an owner and a neighbour; nodes that coincide are one."""

    def __init__(self, grid: Grid) -> None:
        flat = grid.nodes.reshape(-1, 2)
        _, number = np.unique(flat, axis=0, return_inverse=True)
        self.number = (
            number.reshape(grid.ni, grid.nj)
            if grid.topology != "quad"
            else np.arange(len(flat)).reshape(grid.ni, grid.nj)
        )
        self.where = {int(n): flat[k] for k, n in enumerate(self.number.ravel())}
        self.cells: list[tuple[tuple[int, int], list[int]]] = []
        self.faces: dict[frozenset[int], list[int]] = {}
        for i in range(grid.ni - 1):
            for j in range(grid.nj - 1):
                ring = [
                    self.number[i, j],
                    self.number[i + 1, j],
                    self.number[i + 1, j + 1],
                    self.number[i, j + 1],
                ]
                self.cells.append(((i, j), [int(n) for n in ring]))
                for k in range(4):
                    self.faces.setdefault(frozenset((int(ring[k]), int(ring[k - 1]))), []).append(
                        len(self.cells) - 1
                    )

    def centre(self, cell: int) -> np.ndarray:
        """Centre of a cell from pyramids over its faces, as OpenFOAM takes it."""
        ring = [np.append(self.where[n], 0.0) for n in self.cells[cell][1]]
        top = np.array([0, 0, HEIGHT])
        polygons = [ring[::-1], [p + top for p in ring]]
        polygons += [[ring[k], ring[(k + 1) % 4], ring[(k + 1) % 4] + top, ring[k] + top] for k in range(4)]
        areas, centres = zip(*(self.face(polygon) for polygon in polygons), strict=True)
        guess = np.mean(centres, axis=0)
        volumes = [area @ (centre - guess) / 3 for area, centre in zip(areas, centres, strict=True)]
        parts = [v * (0.75 * c + 0.25 * guess) for v, c in zip(volumes, centres, strict=True)]
        return np.asarray(np.sum(parts, axis=0) / np.sum(volumes))

    def face(self, polygon: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Area vector and centre of a polygon, from triangles around the mean of its points."""
        middle = np.mean(polygon, axis=0)
        area, moment, size = np.zeros(3), np.zeros(3), 0.0
        total = sum(np.cross(polygon[k - 1] - middle, polygon[k] - middle) for k in range(len(polygon)))
        for k in range(len(polygon)):
            a, b = polygon[k - 1], polygon[k]
            vector = 0.5 * np.cross(a - middle, b - middle)
            signed = float(vector @ total) / np.linalg.norm(total)
            area, moment, size = area + vector, moment + signed * (a + b + middle) / 3, size + signed
        return area, moment / size

    def measures(self) -> tuple[list[float], list[float]]:
        angles, skews = [], []
        for nodes, cells in self.faces.items():
            a, b = (np.append(self.where[n], 0.0) for n in nodes)
            top = np.array([0, 0, HEIGHT])
            points = [a, b, b + top, a + top]
            area, centre = self.face(points)
            own = self.centre(cells[0])
            way = centre - own
            if len(cells) == 2:
                d = self.centre(cells[1]) - own
                area = area * np.sign(area @ d)
                cosine = area @ d / np.linalg.norm(area) / np.linalg.norm(d)
                angles.append(np.degrees(np.arccos(min(cosine, 1.0))))
                least = 0.2 * np.linalg.norm(d)
            else:
                normal = area / np.linalg.norm(area)
                d = normal * (normal @ way)
                least = 0.4 * np.linalg.norm(d)
            off = way - (area @ way) / (area @ d) * d
            unit = off / (np.linalg.norm(off) + 1e-150)
            reach = max(abs(unit @ (p - centre)) for p in points)
            skews.append(np.linalg.norm(off) / max(least, reach))
        return angles, skews


def shaken(ni: int = 9, nj: int = 7) -> Grid:
    x, y = np.meshgrid(np.arange(float(ni)), 0.4 * np.arange(nj), indexing="ij")
    return Grid.from_nodes(
        np.stack([x, y], axis=-1) + np.random.default_rng(4).uniform(-0.12, 0.12, (ni, nj, 2))
    )


def ring() -> Grid:
    turn = -2 * np.pi * (np.geomspace(1, 2, 14) - 1)
    radius = 1.3 ** np.arange(6)
    nodes = np.stack([np.outer(np.cos(turn + 0.3), radius), np.outer(np.sin(turn), 0.4 * radius)], axis=-1)
    nodes[-1] = nodes[0]
    return Grid.from_nodes(nodes, "o")


@pytest.mark.slow
@pytest.mark.parametrize("make", [shaken, ring, c_grid])
@pytest.mark.parametrize("rows", [3, 128])
def test_they_are_those_of_openfoam(make: object, rows: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steps, "ROWS", rows)
    grid = make()  # type: ignore[operator]
    angles, skews = Mesh(grid).measures()
    result = faces(grid)
    assert result.non_orthogonality is not None
    assert result.face_skewness is not None
    assert result.non_orthogonality.max == pytest.approx(max(angles), rel=1e-9, abs=2e-6)
    mean = np.degrees(np.arccos(np.mean(np.cos(np.radians(angles)))))
    assert result.non_orthogonality.mean == pytest.approx(mean, rel=1e-9)
    assert result.face_skewness.max == pytest.approx(max(skews), rel=1e-9)
    assert result.face_skewness.mean == pytest.approx(np.mean(skews), rel=1e-9, abs=1e-12)


def test_a_parallelogram_is_as_oblique_as_it_looks() -> None:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    result = faces(Grid.from_nodes(np.stack([x + 3 * y, y], axis=-1)))
    assert result.non_orthogonality is not None
    assert result.non_orthogonality.max == pytest.approx(np.degrees(np.arctan(3)))
    assert result.box_ratio is not None
    assert result.box_ratio.max == pytest.approx((2 * 1 + 2 * 3) / 2)


def test_a_face_the_wrong_way_round_is_beyond_90() -> None:
    nodes = shaken().nodes.copy()
    nodes[4:6] = nodes[5:3:-1]
    result = faces(Grid.from_nodes(nodes))
    assert result.non_orthogonality is not None
    assert result.non_orthogonality.max > 90


def test_one_cell_has_no_faces_inside() -> None:
    result = faces(Grid.from_nodes(shaken().nodes[:2, :2]))
    assert result.non_orthogonality is None
    assert result.face_skewness is not None


@pytest.mark.parametrize("name", FACE_NAMES)
@pytest.mark.parametrize(
    "make",
    [
        shaken,
        ring,
        c_grid,
        lambda: joined([shaken().nodes[:5], shaken().nodes[4:]], lambda _: "wall"),
        lambda: extruded(shaken(), [0.0, 0.3, 1.0]),
    ],
)
def test_cells_have_the_measure_of_their_worst_face(make: Callable[[], Grid], name: str) -> None:
    grid = make()
    values = per_cell_of_blocks(grid, name)
    extreme = getattr(faces(grid), name)
    assert [each.shape for each in values] == [tuple(n - 1 for n in b.counts) for b in grid.blocks]
    assert max(float(each.max()) for each in values) == extreme.max
    block, *at = extreme.at if grid.topology == "blocks" or grid.form == "volume" else (0, *extreme.at)
    assert values[block][tuple(at)] == extreme.max
