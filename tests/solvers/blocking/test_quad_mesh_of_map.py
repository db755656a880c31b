"""Motorcycle graph, T-mesh and quad mesh of maps that are known, and of those of any domain."""

import numpy as np
import pytest
from flat_maps import cone, flat, logarithm, seamless_of

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap, seamless_map
from meshonet.solvers.blocking.decomposition.quads.motorcycle import motorcycle_graph
from meshonet.solvers.blocking.decomposition.quads.quad_mesh import quad_mesh
from meshonet.solvers.blocking.decomposition.quads.t_mesh import t_mesh


def box(x: float, y: float, width: float, height: float) -> np.ndarray:
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


def circle(x: float, y: float, radius: float, count: int = 96) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def room_with_pillars(seed: int) -> Domain:
    """A room with a pillar in some of its 3 x 3 places, no two walls of which are in line."""
    rng = np.random.default_rng(seed)
    pillars = []
    for i, j in np.ndindex(3, 3):
        if rng.random() < 0.7:
            size = rng.uniform(0.15, 0.5, 2)
            low = np.array([i, j]) + rng.uniform(0.15, 0.3, 2)
            pillars.append(box(*low, *size))
    return Domain.of_polygons([box(0, 0, 3.0, 3.0), *pillars])


L_SHAPE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2.0]])


def star_of_squares(valence: int) -> Domain:
    """As many unit squares of the map as meet at the origin, drawn in the plane."""
    side = np.linspace(0, 1, 20, endpoint=False)
    edge = np.concatenate([1 + 1j * side, 1 - side + 1j]) ** (4 / valence)
    ring = np.concatenate([edge * np.exp(2j * np.pi * k / valence) for k in range(valence)])
    points = np.stack([ring.real, ring.imag], axis=1)
    return Domain((Loop.of_polygon(points, corners=tuple(range(20, len(points), 40))),))


def checked(mesh: QuadMesh) -> QuadMesh:
    """Assert what every mesh must be: conforming, of the domain's topology, wall nodes in order on loops."""
    loops = mesh.domain.loops
    quads_of = np.bincount(mesh.edge_of.ravel(), minlength=len(mesh.edges))
    assert set(quads_of) <= {1, 2}
    assert len(mesh.nodes) - len(mesh.edges) + len(mesh.quads) == 2 - len(loops)
    assert len(np.unique(mesh.quads)) == len(mesh.nodes)
    assert np.array_equal(mesh.wall_nodes, mesh.places.loop >= 0)
    pairs = {tuple(sorted(pair)) for pair in mesh.edges[mesh.on_wall].tolist()}
    for number, loop in enumerate(loops):
        nodes = np.flatnonzero(mesh.places.loop == number)
        nodes = nodes[np.argsort(mesh.places.arc[nodes])]
        assert np.abs(loop.at(mesh.places.arc[nodes]) - mesh.nodes[nodes]).max() < 1e-9 * loop.length
        assert np.diff(mesh.places.arc[nodes]).min() > 0
        around = {
            tuple(sorted(pair)) for pair in zip(nodes.tolist(), np.roll(nodes, -1).tolist(), strict=True)
        }
        assert around <= pairs
        pairs -= around
        fixed = nodes[mesh.places.cells[nodes] > 0]
        assert np.allclose(mesh.places.arc[fixed], loop.corner_arcs, atol=1e-9 * loop.length)
        assert np.array_equal(mesh.places.cells[fixed], loop.corner_cells)
    assert not pairs
    return mesh


def areas(mesh: QuadMesh) -> np.ndarray:
    z = mesh.nodes[mesh.quads] @ np.array([1, 1j])
    return 0.5 * ((z[:, 2] - z[:, 0]).conj() * (z[:, 3] - z[:, 1])).imag


def jacobians(mesh: QuadMesh) -> np.ndarray:
    z = mesh.nodes[mesh.quads] @ np.array([1, 1j])
    step = np.roll(z, -1, axis=1) - z
    return (step.conj() * -np.roll(step, 1, axis=1)).imag


@pytest.mark.parametrize(
    ("domain", "faces"),
    [
        (Domain.of_polygons([box(0, 0, 3, 1)]), 1),
        (Domain.of_polygons([L_SHAPE]), 3),
        (Domain.of_polygons([box(0, 0, 3, 2), box(1.1, 0.6, 0.7, 0.5)]), 8),
    ],
    ids=["rectangle", "L", "room with a pillar"],
)
def test_right_angled_domain_is_cut_at_its_inner_corners(domain: Domain, faces: int) -> None:
    seamless = seamless_of(domain, flat)
    mesh = t_mesh(motorcycle_graph(seamless))
    assert len(mesh.faces) == faces
    fine = checked(quad_mesh(seamless, 300))
    assert not np.any(fine.irregular & ~fine.wall_nodes)
    assert areas(fine).sum() == pytest.approx(domain.area, rel=1e-12)
    angles = np.degrees(np.arcsin(np.clip(jacobians(fine) / _edge_products(fine), -1, 1)))
    assert np.median(angles) == pytest.approx(90.0, abs=1e-4)
    assert 200 < len(fine.quads) < 450


def _edge_products(mesh: QuadMesh) -> np.ndarray:
    z = mesh.nodes[mesh.quads] @ np.array([1, 1j])
    length = np.abs(np.roll(z, -1, axis=1) - z)
    return length * np.roll(length, 1, axis=1)


def test_corners_in_line_are_joined_by_one_line() -> None:
    slot = np.array([[0, 0], [4, 0], [4, 1], [3, 1], [3, 2], [1, 2], [1, 1], [0, 1.0]])
    graph = motorcycle_graph(seamless_of(Domain.of_polygons([slot]), flat))
    between = [trail for trail in graph.stations if len(trail) == 2 and trail[0][1] < 8 and trail[1][1] < 8]
    assert len(between) == 1, "the corners at (1, 1) and (3, 1) share the line y = 1"
    assert len(t_mesh(graph).faces) == 4


@pytest.mark.parametrize("seed", range(8))
def test_pillars_anywhere(seed: int) -> None:
    domain = room_with_pillars(seed)
    seamless = seamless_of(domain, flat, seed=seed)
    mesh = t_mesh(motorcycle_graph(seamless))
    # rays from 4 corners of each pillar, 2 each, of which each ends somewhere: so many rectangles there are
    assert len(mesh.faces) == 1 + 7 * (len(domain.loops) - 1)
    assert _faces_are_rectangles(seamless, mesh)
    fine = checked(quad_mesh(seamless, 700))
    assert areas(fine).sum() == pytest.approx(domain.area, rel=1e-12)


def _faces_are_rectangles(seamless: SeamlessMap, mesh: object) -> bool:
    spans = mesh.span[:, 1] - mesh.span[:, 0]  # type: ignore[attr-defined]
    for face in mesh.faces:  # type: ignore[attr-defined]
        south, east, north, west = (sum(spans[half // 2] for half in side) for side in face)
        if abs(south - north) > 1e-9 * south or abs(east - west) > 1e-9 * east:
            return False
    return True


def test_annulus_is_cut_once() -> None:
    domain = Domain.of_polygons([circle(0, 0, 1), circle(0, 0, 0.4)])
    seamless = seamless_of(domain, logarithm)
    mesh = t_mesh(motorcycle_graph(seamless))
    assert len(mesh.faces) == 1
    assert len(mesh.nodes) == 3
    fine = checked(quad_mesh(seamless, 600))
    assert not fine.irregular.any()
    radii = np.hypot(*fine.nodes.T)
    lines = np.unique(np.round(np.log(radii), 2))
    assert len(lines) < 30, "nodes lie on circles, as the inverse of the map has it"
    assert jacobians(fine).min() > 0


@pytest.mark.parametrize("valence", [3, 5])
def test_squares_around_a_singular_vertex(valence: int) -> None:
    domain = star_of_squares(valence)
    seamless = seamless_of(domain, cone(valence), count=800, centre=True)
    assert seamless.valence[seamless.singular].tolist() == [valence]
    mesh = t_mesh(motorcycle_graph(seamless))
    assert len(mesh.faces) == valence
    fine = checked(quad_mesh(seamless, 300))
    inner = np.flatnonzero(fine.irregular & ~fine.wall_nodes)
    assert fine.valence[inner].tolist() == [valence]
    assert np.abs(fine.nodes[inner]).max() < 1e-12
    # the inverse map: unit squares of the map have equal steps there
    w = np.abs(fine.nodes @ np.array([1, 1j])) ** (valence / 4)
    assert w.max() == pytest.approx(np.sqrt(2), rel=1e-3)
    assert jacobians(fine).min() > 0


def test_same_input_same_bits() -> None:
    domain = room_with_pillars(3)
    seamless = seamless_of(domain, flat, seed=3)
    one, two = quad_mesh(seamless), quad_mesh(seamless)
    assert np.array_equal(one.nodes, two.nodes)
    assert np.array_equal(one.quads, two.quads)
    assert np.array_equal(one.places.arc, two.places.arc)


DOMAINS = {
    "disc": [circle(0, 0, 1)],
    "annulus": [circle(0, 0, 1), circle(0.3, 0.1, 0.4)],
    "channel with cylinder": [box(0, 0, 2.2, 0.41), circle(0.2, 0.2, 0.05)],
    "plate with holes": [box(0, 0, 4, 3), circle(1, 0.8, 0.3), circle(3, 0.7, 0.4), circle(2, 2, 0.35)],
    "triangle": [np.array([[0, 0], [1, 0], [0.5, 0.9]])],
    "T": [np.array([[0, 0], [3, 0], [3, 1], [2, 1], [2, 3], [1, 3], [1, 1], [0, 1.0]])],
}


@pytest.mark.parametrize("name", DOMAINS)
def test_any_domain(name: str) -> None:
    domain = Domain.of_polygons(DOMAINS[name])
    seamless = seamless_map(domain, 900)
    mesh = t_mesh(motorcycle_graph(seamless))
    assert _faces_are_rectangles(seamless, mesh)
    fine = checked(quad_mesh(seamless, 600))
    assert np.mean(jacobians(fine).min(axis=1) <= 0) < 0.03
    inner = fine.irregular & ~fine.wall_nodes
    missing = np.where(fine.places.cells > 0, fine.places.cells, 2) - fine.valence
    # inner and wall irregularities balance: Poincare and Hopf
    total = (4 - fine.valence[~fine.wall_nodes]).sum() + (2 - fine.valence[fine.wall_nodes]).sum()
    assert total == 4 * (2 - len(domain.loops))
    assert inner.sum() == len(seamless.singular)
    if domain.loops[0].corners:
        assert np.abs(missing[fine.places.cells > 0]).max() == 0


@pytest.mark.parametrize("seed", range(6))
def test_random_polygons_with_holes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle = (np.arange(8) + rng.uniform(-0.3, 0.3, 8)) * np.pi / 4
    outer = (2 + rng.uniform(-0.5, 0.5, 8))[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    holes = [circle(-0.5, 0.2, 0.25), box(0.3, -0.4, 0.4, 0.3)][: seed % 3]
    seamless = seamless_map(Domain.of_polygons([outer, *holes]), 900)
    checked(quad_mesh(seamless, 600))
