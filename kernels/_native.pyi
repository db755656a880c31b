from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Complexes: TypeAlias = NDArray[np.complex128]
Whole: TypeAlias = NDArray[np.int64]
Indices: TypeAlias = NDArray[np.intp]
Reals: TypeAlias = NDArray[Any]
Edges: TypeAlias = tuple[Floats, ...]
Placed: TypeAlias = tuple[Indices, Floats]
TriangleMap: TypeAlias = tuple[Floats, Indices, Indices, Indices]

# elementary
def elementary(name: bytes, x: Floats, out: Floats) -> None: ...
def angles_of(y: Floats, x: Floats, out: Floats) -> None: ...
def powers_of(x: Floats, y: Floats, out: Floats) -> None: ...
def matrix_product(a: Floats, b: Floats, out: Floats) -> None: ...
def solve_systems(matrices: Floats, right: Floats) -> bool: ...

# geometry
def count_folded(x: Floats, y: Floats, threads: int = 1) -> int: ...
def folded_cells(x: Floats, y: Floats) -> Whole: ...
def measure_cells(
    x: Floats, y: Floats, periodic: bool, wake: int, summary: Floats, where: Whole, keep: int, kept: Floats,
    threads: int = 1,
) -> None: ...  # fmt: skip
def curve_locate(
    s: Floats, table: Floats, start: Floats, stop: Floats, pieces: int, closed: bool, interval: Indices,
    place: Floats,
) -> None: ...  # fmt: skip
def curve_points(cubic: Floats, interval: Indices, place: Floats, end: Floats, points: Floats) -> None: ...
def curve_slopes(cubic: Floats, interval: Indices, place: Floats, derivatives: Floats) -> None: ...
def curve_speeds(cubic: Floats, places: Floats, lengths: Floats) -> None: ...
def cubic_values(knots: Floats, values: Floats, bends: Floats, places: Floats, out: Floats) -> None: ...
def solve_tridiagonal(lower: Floats, diagonal: Floats, upper: Floats, right: Floats) -> None: ...
def lattice_values(table: Floats, u: Floats, v: Floats, out: Floats) -> None: ...
def crossing_segments(
    points: Floats, order: Indices, low: Floats, top: Floats, limit: int, budget: int
) -> tuple[list[tuple[int, int]], bool]: ...

# algebraic
def tfi(x: Floats, y: Floats, xs: Edges, ys: Edges, parameters: Edges, threads: int = 1) -> None: ...
def resample(
    coarse: Floats, sides: Edges, fine: tuple[Placed, Placed], opened: Floats, near: float, far: float,
    reach: float, nodes: Floats, straight: NDArray[np.uint8] | None = None, threads: int = 1,
) -> None: ...  # fmt: skip
def add_spline_rows(
    x: Floats, first: Indices, weights: Floats, values: Floats, bends: Floats, rim: bool, threads: int = 1
) -> None: ...

# elliptic
def multigrid_scratch(mi: int, mj: int, threads: int = 1) -> int: ...

class MultigridLevel:
    x: Floats
    y: Floats
    x0: Floats
    y0: Floats
    fx: Floats
    fy: Floats
    def __init__(
        self, x: Floats, y: Floats, xi: Edges, eta: Edges, periodic: bool, scratch: Floats, coarse: bool,
        threads: int = 1,
    ) -> None: ...  # fmt: skip
    def transfer(self, xi: Edges, eta: Edges) -> None: ...
    def control(self, phi: Edges, psi: Edges, xi_reach: Floats, eta_reach: Floats) -> None: ...
    def smooth(self, forced: bool, sweeps: int = 1) -> None: ...
    def residual(self, forced: bool) -> float: ...
    def restrict(self, coarse: MultigridLevel, forced: bool) -> None: ...
    def correct(self, coarse: MultigridLevel) -> float: ...

# energy
def variational_energy(
    z: Floats, aspect: float, shape: float, smoothness: float, epsilon: float, periodic: bool,
    relief: Floats | None, gradient: Floats, threads: int = 1,
) -> tuple[float, float]: ...  # fmt: skip
def newton(z: Floats, aspect: float, shape: float, smoothness: float, most: int, won: float = 0.0) -> int: ...

class Modes:
    def __init__(self, matrix: Floats) -> None: ...

class Stiffness:
    usable: bool
    def __init__(self, z: Floats, aspect: float, shape: float, smoothness: float) -> None: ...

class VariationalDescent:
    def __init__(
        self, ni: int, nj: int, periodic: bool, rows: tuple[Modes, Modes], columns: tuple[Modes, Modes],
        scale: Floats, rest: float, threads: int = 1,
    ) -> None: ...  # fmt: skip
    def steer(self, stiffness: Stiffness, along: Floats, across: Floats) -> None: ...
    def run(
        self, z: Floats, aspect: float, shape: float, smoothness: float, epsilon: float,
        relief: Floats | None, still: float, reach: float, most: int,
        told: Callable[[int, float, float], None] | None = None,
    ) -> tuple[float, float, int]: ...  # fmt: skip

# hyperbolic
def hyperbolic_march(
    x: Floats, y: Floats, steps: Floats, dissipation: float, even: float, tolerated: float, bend: float,
    implicit: float, volume: float, sweeps: int, rise: int, ends: Floats | None = None,
    widening: Floats | None = None, ratios: Floats | None = None, threads: int = 1,
) -> None: ...  # fmt: skip

# layers
def layer_steps(steps: Floats, length: float, first: float, last: float, constant: int) -> float: ...
def layer_lines(
    x: Floats, y: Floats, X: Floats, Y: Floats, first: float, last: float, constant: int, threads: int = 1
) -> float: ...
def layer_law(wanted: Floats, slopes: Floats, most: float, steeper: float, cells: Floats) -> None: ...
def sampled_lines(lines: Floats, arcs: Floats, at: Floats, points: Floats) -> None: ...
def even_line(
    measures: tuple[Floats, Floats, Floats], closed: bool,
    terms: tuple[Floats, Floats, Indices, Floats, Floats, float, float, float],
    steps: tuple[Floats, float, float, float, int, int], pattern: SparsePattern, slot: Indices,
    unknown: Indices, place: Floats,
) -> int: ...  # fmt: skip
def redistribute(x: Floats, y: Floats, first: Floats, fade: Floats, threads: int = 1) -> None: ...

# rows
def chebyshev_sums(coefficients: Floats, heights: Floats, out: Floats) -> None: ...
def channel_points(tables: tuple[Floats, Floats], s: Floats, h: Floats, points: Floats) -> None: ...
def channel_space(tables: tuple[Floats, Floats], values: Floats, space: Floats) -> None: ...
def channel_nodes(tables: tuple[Floats, Floats], values: Floats, ids: Indices, space: Floats) -> None: ...
def way_ahead(behind: Floats, slope: Floats, keys: Floats, parts: Floats) -> None: ...
def stacked_block(nodes: Floats, ids: Indices, block: Floats) -> None: ...
def spline_crossings(
    values: Floats, bends: Floats, knots: Floats, heights: Floats, points: Floats
) -> None: ...
def columns_on_blade(tables: tuple[Floats, Floats], wall: Floats, first: float, columns: Floats) -> None: ...
def lengthen_cells(tables: tuple[Floats, Floats], begin: Floats, sizes: Floats, end: Floats) -> None: ...

# conformal: `maps` are a geometry.conformal.lift.Lift
Removed: TypeAlias = tuple[complex, complex, complex, complex, float]

def lift_body(
    wall: Complexes, swap: bool
) -> tuple[complex, complex, list[Removed], complex, float, Complexes, tuple[int, ...], float]: ...
def lift_to_strip(maps: Any, z: Complexes) -> Complexes: ...
def lift_follow(wall: Complexes, centre: complex, quarter: complex) -> Complexes: ...
def lift_bisect(
    maps: Any, corner: complex, ahead: complex, behind: complex, w: complex, start: float, limit: float
) -> float: ...
def fourier_columns(modes: Complexes, gain: Floats, unit: Complexes, columns: Floats) -> None: ...
def picard_step(c: Floats, height: float, matrices: Floats, eigenvalues: Floats, smooth: Floats) -> float: ...
def strip_rows(
    x: Floats, y: Floats, order: Indices, lift: Any, sums: Sequence[tuple[int, int, Floats]],
    sharpness: float, along: Floats, across: Floats, matrix: Floats, cuts: Indices, begin: int,
    axis: tuple[complex, complex] | None, threads: int = 1,
) -> bool: ...  # fmt: skip

# neural
LINE: int

def winslow_steps(
    planes: Floats, turns: Floats, harmonic: bool, steps: int, share: float, growth: float,
    xi: tuple[Floats, Floats], eta: tuple[Floats, Floats], around: bool, last: Floats,
) -> None: ...  # fmt: skip
def grid_features(planes: Floats, steps: Floats, out: Reals) -> None: ...

class LayerProgram:
    def run(self, x: Reals, out: Reals) -> None: ...

def convolve(
    x: Reals, w: Reals, bias: Reals, size: int, stride: int, add: Reals | None, out: Reals,
    later: LayerProgram | None = None,
) -> None: ...  # fmt: skip
def activate(x: Reals, out: Reals, around: bool = False, later: LayerProgram | None = None) -> None: ...
def upsample(
    x: Reals, add: Reals, out: Reals, around: bool = False, later: LayerProgram | None = None
) -> None: ...

# formats
INTEGER_BYTES: int
FLOAT_BYTES: int

def count_words(text: NDArray[np.int8]) -> int: ...
def take_numbers(text: NDArray[np.int8], out: Floats) -> tuple[int, int]: ...
def put_rows(out: NDArray[np.int8], rows: Reals, text: bytes, at: Indices) -> int: ...
def inner_faces(
    nodes: NDArray[np.int32], beyond: Sequence[NDArray[np.int32]], first: int, faces: NDArray[np.int32],
    owner: NDArray[np.int32], neighbour: NDArray[np.int32],
) -> int: ...  # fmt: skip

# collapse
def connect_quads(quads: Indices, n: int) -> tuple[Indices, Indices, Indices, bool]: ...
def joined_classes(pairs: Indices, n: int) -> tuple[Indices, int]: ...
def split_quads(
    quads: Indices, edge: Indices, twin: Indices, irregular: NDArray[np.bool_], marked: NDArray[np.bool_]
) -> tuple[list[Indices], Indices, int] | None: ...  # fmt: skip

# motorcycle
def probe_rays(
    tables: TriangleMap, node: Indices, port: Indices, nodes: int, ports: int, near: float, starts: Indices,
    limit: int,
) -> Indices: ...  # fmt: skip
def trace_rays(
    tables: TriangleMap, node: Indices, port: Indices, nodes: int, ports: int, near: float, starts: Indices,
    limit: int, room: int,
) -> tuple[Indices, Floats, Indices, Floats] | None: ...  # fmt: skip
def nearest_ahead(
    walls: Floats, points: Floats, along: Floats, cosine: float, same: float, distances: Floats
) -> None: ...
def nearest_points(places: Floats, points: Floats) -> tuple[Indices, Floats]: ...

# quads
def quad_images(twin: Indices, quad: int, image: int, corner: int) -> tuple[Indices, Indices] | None: ...
def smallest_corners(nodes: Floats, quads: Indices) -> Floats: ...
def line_neighbours(
    quads: Indices, edge_of: Indices, node: Indices, edge: Indices
) -> tuple[Indices, int]: ...

class QuadDescent:
    def __init__(
        self, nodes: Floats, cells: tuple[Indices, Floats, Floats],
        lines: tuple[Indices, Indices, int, Floats], eased: tuple[Indices, Floats], inner: Indices,
        tied: tuple[Indices, Floats], unknown: Indices, wall: Indices,
        wall_nodes: tuple[Indices, Indices, Floats], wall_edges: tuple[Indices, Floats],
        loops: tuple[tuple[object, ...], ...], bent: float, allowed: float, crossed: Indices,
    ) -> None: ...  # fmt: skip
    def run(
        self,
        shape: float,
        smoothness: float,
        epsilon: float,
        size: float,
        gain: float,
        most: int,
        renew: bool,
        steep: float = ...,
        limit: float = ...,
    ) -> tuple[float, float, int]: ...
    def evaluate(
        self,
        shape: float,
        smoothness: float,
        epsilon: float,
        size: float,
        gradient: Floats,
        steep: float = ...,
        limit: float = ...,
    ) -> float: ...

# sparse: `pattern` is the symbolic factorisation: order, parent, start, row, fill, block
SparsePattern: TypeAlias = tuple[Reals, Reals, Indices, Reals, Indices, int]

def sparse_analyse(n: int, rows: Indices, columns: Indices, block: int) -> tuple[SparsePattern, Indices]: ...
def sparse_factor(pattern: SparsePattern, values: Floats) -> tuple[tuple[Reals, Floats, Floats], int]: ...
def sparse_solve(pattern: SparsePattern, factor: tuple[Reals, Floats, Floats], x: Floats) -> None: ...
def sparse_multiply(pattern: SparsePattern, values: Floats, x: Floats, product: Floats) -> None: ...
def normal_terms(
    unknowns: Indices,
    places: Indices,
    derivatives: Floats,
    weight: Floats,
    slope: Floats,
    values: Floats,
    right: Floats,
) -> None: ...

# blocking: a surface is (vertices, neighbours, number of the edge in each neighbour), (t, 3) each
Surface: TypeAlias = tuple[Indices, Indices, Indices]

def surface_fans(surface: Surface, vertices: int) -> tuple[Indices, Indices, int]: ...
def surface_comb(surface: Surface, vertices: int, quarters: Indices) -> tuple[Indices, NDArray[np.uint8]]: ...
def surface_prune(
    surface: Surface, start: Indices, fan: Indices, keep: NDArray[np.uint8], cut: NDArray[np.uint8]
) -> None: ...

# triangulation
def wall_gaps(
    points: Floats, normals: Floats, piece: Indices, beside: Indices, corner: Floats, part: float,
    cone: float, size: Floats,
) -> None: ...  # fmt: skip
def wall_growth(points: Floats, growth: float, size: Floats) -> None: ...

class DelaunayMesh:
    def insert(self, places: Whole, sizes: Floats, order: Indices) -> NDArray[np.bool_]: ...
    def are_edges(self, pairs: NDArray[np.int32]) -> NDArray[np.bool_]: ...
    def force(self, pairs: NDArray[np.int32]) -> NDArray[np.int32]: ...
    def set_walls(self, pairs: NDArray[np.int32], wall: bool) -> None: ...
    def refine(
        self, walls: NDArray[np.int32], largest: float, growth: float, sources: Floats, source_sizes: Floats,
        most: int,
    ) -> None: ...  # fmt: skip
    def smooth(self, first: int, part: float) -> None: ...
    def shake(self, first: int, part: float, seed: int) -> None: ...
    def nodes(self) -> tuple[Whole, Floats]: ...
    def triangles(self) -> tuple[Indices, Indices, Indices]: ...

# hexes
class HexDescent:
    def __init__(
        self, nodes: Floats, blocks: Whole,
        tables: tuple[NDArray[np.int32], NDArray[np.float32], Floats, NDArray[np.uint8], NDArray[np.bool_]],
        places: tuple[Indices, Indices, NDArray[np.int32], Floats], slides: tuple[Indices, Floats],
        cells: float, threads: int, over: tuple[float, float, float] | None = None,
    ) -> None: ...  # fmt: skip
    def weigh(
        self, shape: float, smoothness: float, power: int = 2, epsilon: float = 0.0, size: float = 0.0
    ) -> None: ...  # fmt: skip
    def run(
        self, gain: float, most: int, renewal: int, still: float = ..., reach: float = ...,
        farthest: float = ...,
    ) -> tuple[float, float, int]: ...  # fmt: skip
    def smallest(self) -> float: ...
    def evaluate(self, gradient: Floats) -> tuple[float, float]: ...

# surfaces
def surface_march(
    levels: Floats, heights: Floats, graph: Any, settings: Sequence[float], threads: int
) -> tuple[int, int, int]: ...
def respace_lines(
    marched: Floats, steps: Floats, fade: Floats, order: Indices, sweeps: int, lines: Floats, threads: int
) -> None: ...
def limit_line_growth(
    lines: Floats, most: float, used: float, longest: float, first: float, threads: int
) -> None: ...

# solids
def solids_folded(nodes: Floats, test: int, threads: int, counts: Whole) -> None: ...
def solids_places(nodes: Floats, test: int, counts: Whole, places: Whole) -> None: ...
def solids_volumes(nodes: Floats, threads: int, volumes: Floats) -> None: ...
def solids_chunks(nodes: Floats) -> int: ...
def solids_run(
    nodes: Floats, volumes: Floats, summary: Floats, where: Whole, keep: int, kept: Floats, threads: int,
) -> None: ...  # fmt: skip
def solids_lines(
    nodes: Floats, threads: int, summary: Floats, where: Whole, values: NDArray[np.float32] | None = None,
) -> None: ...  # fmt: skip

# volumes
def tfi_volume(
    nodes: Floats, faces: tuple[Floats, ...], laws: tuple[Floats, Floats, Floats], threads: int,
    spline: tuple[Floats, tuple[Indices, ...], tuple[Floats, ...]] | None = None,
) -> None: ...  # fmt: skip
def closed_node(
    walls: tuple[tuple[Floats, int, int], ...], ranges: tuple[tuple[int, int], ...], threads: int
) -> int: ...
def winslow_room(counts: tuple[int, ...], threads: int) -> int: ...
def winslow_smooth(x: Floats, right: Floats | None, factor: float, threads: int, room: Floats) -> None: ...
def winslow_residual(
    x: Floats, right: Floats | None, residual: Floats, threads: int, room: Floats
) -> float: ...  # fmt: skip
def combine_along(
    source: Floats, axis: int, first: Indices, weights: Floats, add: bool, threads: int, to: Floats
) -> None: ...  # fmt: skip
def volume_lines(
    nodes: Floats, axis: int, low: Floats | None, high: Floats | None, reach: float, threads: int
) -> None: ...  # fmt: skip

# deformation
def blend_motions(
    places: Floats, areas: Floats, motions: Floats, near: float, points: Floats, threads: int, moved: Floats
) -> None: ...
def blend_transposed(
    places: Floats, areas: Floats, near: float, points: Floats, pull: Floats, gathered: Floats
) -> None: ...
