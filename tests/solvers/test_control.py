"""Control functions: the compiled scheme against numpy, exact maps, and those of Thomas and Middlecoff."""

import numpy as np
import pytest
from solver_shapes import arch, bump, folded, hexagon, hole, naca, quad, seamount, segment
from winslow_reference import metric_terms, residual

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import SolverError
from meshonet.geometry.spacing.growth import growing_steps
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic import solve as module
from meshonet.solvers.elliptic.control import Controls, Factors, step_ratios, thomas_middlecoff
from meshonet.solvers.elliptic.multigrid import Multigrid
from meshonet.solvers.elliptic.solve import solve, solve_thomas_middlecoff


def edges_of(nodes: Floats, topology: str = "quad") -> Boundary:
    return Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], topology)  # type: ignore[arg-type]


def clustered(boundary: Boundary, first: float) -> Boundary:
    """The same four straight-sided boundary with west and east growing from `first` at the south."""
    sides = []
    for edge in (boundary.west, boundary.east):
        length = float(np.hypot(*(edge[-1] - edge[0])))
        steps = np.concatenate([[0.0], np.cumsum(growing_steps(first, length, boundary.nj - 1))]) / length
        sides.append(edge[0] + steps[:, None] * (edge[-1] - edge[0]))
    return quad(boundary.south, boundary.north, *sides, boundary.name)


@pytest.mark.parametrize("boundary", [arch(31, 24), hole(41, 19)], ids=lambda b: b.name)
def test_the_compiled_residual_is_that_of_the_equations(boundary: Boundary) -> None:
    rng = np.random.default_rng(2)
    ni, nj, periodic = boundary.ni, boundary.nj, boundary.topology == "o"
    nodes = tfi(boundary).nodes.copy(order="K")
    phi, psi = (Factors(0.2 * rng.normal(size=(2, ni)), rng.normal(size=(2, nj))) for _ in range(2))
    if periodic:
        for field in (phi, psi):
            field.along[:, -1] = field.along[:, 0]
    work = nodes.copy(order="K")
    edges = (boundary.south, boundary.north, boundary.west, boundary.east)
    result = Multigrid(work, edges, periodic, controls=Controls(phi, psi)).residual()
    wide = np.concatenate([nodes[-2:-1], nodes]) if periodic else nodes
    alpha, _, gamma = metric_terms(wide)
    rows = slice(0, -1) if periodic else slice(1, -1)
    sources = [-2 * np.tanh(0.5 * field.values()[rows, 1:-1]) for field in (phi, psi)]
    first = (wide[2:, 1:-1] - wide[:-2, 1:-1]) / 2, (wide[1:-1, 2:] - wide[1:-1, :-2]) / 2
    expected = (
        residual(wide)
        + (alpha * sources[0])[..., None] * first[0]
        + (gamma * sources[1])[..., None] * first[1]
    )
    assert result == pytest.approx(np.sqrt((expected**2).sum() / (ni * nj)), rel=1e-3)


def stretched(t: Floats) -> tuple[Floats, Floats]:
    """A monotone map of 0..1 and the quotient of its second derivative by its first."""
    return t + 0.12 * np.sin(np.pi * t) ** 2, 0.24 * np.pi**2 * np.cos(2 * np.pi * t) / (
        1 + 0.12 * np.pi * np.sin(2 * np.pi * t)
    )


@pytest.mark.parametrize("periodic", [False, True])
def test_error_against_a_stretched_conformal_map_is_of_second_order(periodic: bool) -> None:
    """z = exp(a(ξ) + i b(η)) has the sources φ = -a''/a', ψ = -b''/b' exactly."""
    counts, errors = np.array([17, 33, 65, 129]), []
    for n in counts:
        xi, eta = np.linspace(0, 1, 2 * n - 1), np.linspace(0, 1, n)
        (a, a_ratio), (b, b_ratio) = stretched(xi), stretched(eta)
        zeta = b[None, :] - 2j * np.pi * a[:, None] if periodic else 1.5 * a[:, None] + 1j * b[None, :]
        z = np.exp(zeta)
        z = z / (1 - 0.15 * z) if periodic else z
        nodes = np.stack([z.real, z.imag], axis=-1)
        if periodic:
            nodes[-1] = nodes[0]
        one = np.ones
        controls = Controls(
            Factors((a_ratio / (2 * n - 2))[None], one((1, n))),
            Factors(one((1, 2 * n - 1)), (b_ratio / (n - 1))[None]),
        )
        boundary = edges_of(nodes, "o" if periodic else "quad")
        result = solve(boundary, tol=1e-10, max_cycles=60, controls=controls).grid.nodes
        errors.append(np.abs(result - nodes).max())
    slope = -np.polyfit(np.log(counts - 1), np.log(errors), 1)[0]
    assert 1.9 < slope < 2.3
    assert errors[-1] < 1e-3


def test_geometric_growth_in_a_rectangle_is_met_exactly() -> None:
    """By central differences a smooth law is met to second order only; these differences know the law."""
    laws = (5e-3, 2.0, 64), (1e-5, 1.0, 48)
    x, y = (np.concatenate([[0.0], np.cumsum(growing_steps(*law))]) for law in laws)
    nodes = np.stack(np.broadcast_arrays(x[:, None], y), axis=-1)
    boundary = edges_of(nodes)
    work = np.moveaxis(np.empty((2, 65, 49)), 0, -1)
    levels = Multigrid(
        work,
        (boundary.south, boundary.north, boundary.west, boundary.east),
        False,
        controls=thomas_middlecoff(boundary),
    )
    work[...] = nodes
    work[1:-1, 1:-1] *= 1.0 + 0.05 * np.sin(7.0 * nodes[1:-1, 1:-1])
    for _ in range(20):
        levels.cycle()
    np.testing.assert_allclose(work, nodes, atol=1e-6)
    np.testing.assert_allclose(work[:, 1], nodes[:, 1], rtol=1e-5)


def test_a_start_does_not_spoil_what_interpolation_solves() -> None:
    t = np.linspace(0, 1, 12)
    nodes = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1)
    start = nodes.copy()
    start[1:-1, 1:-1] += 0.02
    result = solve(edges_of(nodes), initial=Grid.from_nodes(start)).grid.nodes
    np.testing.assert_allclose(result, nodes, atol=1e-14)


def test_the_ratio_of_steps_on_an_edge_is_minus_the_middlecoff_quotient() -> None:
    """-(x_ξ·x_ξξ)/(x_ξ·x_ξ) by central differences, on a curve that bends and stretches."""
    t = np.linspace(0, 1, 401)
    s, _ = stretched(t)
    edge = np.stack([np.sin(s), s**2], axis=1)
    first, second = (edge[2:] - edge[:-2]) / 2, edge[2:] - 2 * edge[1:-1] + edge[:-2]
    quotient = (first * second).sum(axis=1) / (first**2).sum(axis=1)
    np.testing.assert_allclose(step_ratios(edge, periodic=False)[1:-1], quotient, atol=1e-5)


def test_controls_meet_the_edges_and_are_linear_in_between() -> None:
    boundary = clustered(arch(21, 33), 1e-3)
    controls = thomas_middlecoff(boundary)
    psi, phi = controls.psi.values(), controls.phi.values()
    np.testing.assert_allclose(psi[0], step_ratios(boundary.west, periodic=False))
    np.testing.assert_allclose(psi[10], 0.5 * (psi[0] + psi[-1]))
    np.testing.assert_allclose(phi[:, -1], step_ratios(boundary.north, periodic=False))
    np.testing.assert_allclose(phi[:, 16], 0.5 * (phi[:, 0] + phi[:, -1]))


def test_a_ring_takes_the_ratio_across_its_seam() -> None:
    edge = naca(41, 9).south
    ratios, steps = step_ratios(edge, periodic=True), np.hypot(*np.diff(edge, axis=0).T)
    assert ratios[0] == ratios[-1] == pytest.approx(np.log(steps[0] / steps[-1]))


@pytest.mark.parametrize("make", [arch, hexagon, bump, seamount])
@pytest.mark.parametrize("first", [1e-3, 1e-5])
def test_the_spacing_of_the_sides_reaches_the_middle(make, first: float) -> None:  # type: ignore[no-untyped-def]
    """At once, at multigrid speed, however thin the first cell; Winslow's equations alone lose it."""
    boundary = clustered(make(101, 81), first)
    solution = solve_thomas_middlecoff(boundary, tol=1e-8)
    assert solution.notes == ()
    assert solution.residual is not None
    assert solution.cycles is not None
    assert solution.residual ** (1 / solution.cycles) < 0.35
    nodes = solution.grid.nodes
    assert folded(nodes) == 0
    heights = np.hypot(*(nodes[:, 1] - nodes[:, 0]).T)
    plain = solve(boundary, tol=1e-8).grid.nodes
    away = np.hypot(*(plain[:, 1] - plain[:, 0]).T)
    assert np.median(heights) < 5 * first
    assert np.median(away) > 2 * np.median(heights)
    assert solution.method == solution.grid.provenance["method"] == "thomas-middlecoff"


def test_divergence_brings_the_controls_in_little_by_little(monkeypatch: pytest.MonkeyPatch) -> None:
    honest, parts = module._attempt, []

    def spoiled(*arguments: object) -> tuple[Floats, float, int]:
        (controls,) = (one for one in arguments if isinstance(one, Controls))
        parts.append(float(np.abs(controls.psi.values()).max()))
        if len(parts) <= len(module.ATTEMPTS):
            raise module._DivergedError("spoiled")
        return honest(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "_attempt", spoiled)
    boundary = clustered(arch(41, 41), 1e-3)
    solution = solve_thomas_middlecoff(boundary, tol=1e-8)
    whole = float(np.abs(thomas_middlecoff(boundary).psi.values()).max())
    np.testing.assert_allclose(parts, whole * np.array([*[1.0] * len(module.ATTEMPTS), *module.CONTINUATION]))
    assert len(solution.notes) == len(module.ATTEMPTS)
    assert folded(solution.grid.nodes) == 0


def test_controls_that_diverge_from_every_start_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def spoiled(self: module.Multigrid, k: int = 0, forced: bool = False) -> float:
        self.levels[0].x[1, 1] = np.nan
        return 1.0

    monkeypatch.setattr(module.Multigrid, "cycle", spoiled)
    with pytest.raises(
        SolverError, match=r"thomas-middlecoff diverged from every start .* more nodes, variational or tfi"
    ):
        solve_thomas_middlecoff(clustered(arch(129, 129), 1e-3))


def test_equal_steps_need_no_control() -> None:
    square = quad(
        segment((0, 0), (1, 0), 9),
        segment((0, 1), (1, 1), 9),
        segment((0, 0), (0, 1), 9),
        segment((1, 0), (1, 1), 9),
    )
    assert np.abs(thomas_middlecoff(square).psi.values()).max() < 1e-12
