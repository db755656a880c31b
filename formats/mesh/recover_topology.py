"""The outer edges of a grid as a boundary, and the topology of grids whose file does not state it."""

import numpy as np

from meshonet.formats.source import LARGEST
from meshonet.geometry.arrays import TOPOLOGIES, Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.connection import wake_nodes
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.shape import Shape, SpatialShape

_SEAM = 1e-6  # largest distance between joined sides, relative to their first edge


def boundary_of(grid: Grid) -> Shape:
    """Return the outer edges of `grid` as a boundary with its topology, patches and name.

    A multi-block grid gives a domain, with the block layout if blocks share complete sides. A
    three-dimensional grid gives a `SpatialShape`. Raises InputError if edges or blocks do not fit together.
    """
    if grid.form != "plane":
        return SpatialShape(grid)
    if grid.topology == "blocks":
        from meshonet.geometry.blocks.families import joins_whole_sides
        from meshonet.geometry.layout.from_grid import layout_of
        from meshonet.geometry.shapes.domain_shape import DomainShape

        layout = layout_of(grid)
        whole = all(joins_whole_sides(grid, each) for each in grid.connections)
        return DomainShape(layout.mesh.domain, layout=layout if whole else None, grid=grid)
    nodes = grid.nodes
    edges = nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1]
    return Boundary(*edges, grid.topology, grid.patches, grid.name, origin=grid.origin)


def recovered(nodes: Floats, name: str = "") -> Grid:
    """Return the grid of `nodes` (ni, nj, 2); its topology follows from nodes that coincide.

    In an O grid the first and the last column coincide, and the smaller closed side becomes south. If the
    first and the last row coincide, i and j are exchanged. In a C grid the last nodes of a side are its first
    nodes in reverse; this side becomes south. Left-handed nodes are reversed along i.
    """
    nodes = usable(nodes)
    nodes = nodes[::-1] if is_left_handed(nodes) else nodes
    if not _closed(nodes) and _closed(_quarter_turn(nodes)):
        nodes = _quarter_turn(nodes)
    if _closed(nodes):
        if abs(polygon_area(nodes[:-1, 0])) > abs(polygon_area(nodes[:-1, -1])):
            nodes = nodes[::-1, ::-1]
        if not np.array_equal(nodes[0], nodes[-1]):
            nodes = np.concatenate([nodes[:-1], nodes[:1]])
        return Grid.from_nodes(nodes, "o", name=name)
    turned = nodes
    for _ in range(4):
        if wake_nodes(turned[:, 0]) > 1:
            return Grid.from_nodes(turned, "c", name=name)
        turned = _quarter_turn(turned)
    return Grid.from_nodes(nodes, "quad", name=name)


def usable(nodes: Floats) -> Floats:
    """Check `nodes` (ni, nj, 2), (ni, nj, 3) or (ni, nj, nk, 3) of a grid, and return them unchanged.

    Raises InputError if a direction has only one node, or if a coordinate is NaN or larger than `LARGEST`.
    """
    if min(nodes.shape[:-1]) < 2:
        counts = " x ".join(map(str, nodes.shape[:-1]))
        raise InputError(f"{counts} nodes", "give at least two along every direction")
    if not -LARGEST < nodes.min() <= nodes.max() < LARGEST:  # NaN passes through min and compares false
        place = tuple(np.argwhere(~(np.abs(nodes) < LARGEST))[0].tolist())
        node = ", ".join(f"{name}={k}" for name, k in zip("ijk", place[:-1], strict=False))
        problem = f"node {node} has {'xyz'[place[-1]]} = {nodes[place]:.6g}"
        raise InputError(problem, "check the file for wrong numbers")
    return nodes


def is_left_handed(nodes: Floats) -> bool:
    """Return whether the signed area of a block of `nodes` (ni, nj, 2) is negative."""
    outline = np.concatenate([nodes[:-1, 0], nodes[-1, :-1], nodes[:0:-1, -1], nodes[0, :0:-1]])
    return polygon_area(outline) < 0


def known_topology(text: str) -> Topology:
    """Return `text` as a topology. Raises InputError if it is none of quad, o and c."""
    for topology in TOPOLOGIES:
        if text == topology:
            return topology
    raise InputError(f"topology {text[:20]!r} is not known", "use quad, o or c")


def _closed(nodes: Floats) -> bool:
    """Return whether columns ni-1 and 0 of `nodes` (ni, nj, 2) coincide within the digits of a file."""
    gap = np.abs(nodes[-1] - nodes[0]).max(axis=1)
    step = np.abs(nodes[1] - nodes[0]).max(axis=1)
    return len(nodes) > 3 and bool((gap <= _SEAM * step).all())


def _quarter_turn(nodes: Floats) -> Floats:
    """Return `nodes` with i and j exchanged; right-handed nodes stay right-handed."""
    return np.swapaxes(nodes, 0, 1)[:, ::-1]
