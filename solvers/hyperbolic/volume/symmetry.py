"""Planes of symmetry of a surface: detection, and nodes of its open edges moved exactly into them."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.surface.planes import FLAT, Plane, edges_in
from meshonet.geometry.surface.surface import Surface

ROUGH = 1e-3
"""Largest distance of nodes from a given plane of symmetry, relative to the size of the surface."""


def symmetry_planes(surface: Surface, axis: str | None) -> tuple[tuple[Plane, ...], Indices]:
    """Return the planes of symmetry, and a mask (p, k) of the open edges that lie in each.

    `axis` is the normal direction of the planes, ``none`` for no plane, None to detect them.

    Raises InputError: no open edge lies across the axis.
    """
    sides, nodes = surface.open_sides, surface.nodes
    if axis in (None, "none"):
        planes, slack = (surface.planes if axis is None else ()), FLAT * surface.size
    else:
        planes, slack = tuple(p for p in surface.planes if "xyz"[p.axis] == axis), FLAT * surface.size
        if not planes:
            planes, slack = (
                _named(nodes, sides, "xyz".index(str(axis)), ROUGH * surface.size),
                ROUGH * surface.size,
            )
        if not planes:
            problem = f"no open edge of the surface lies in a plane across {axis}"
            raise InputError(problem, "leave {symmetry} out, or name another axis", parameter="symmetry")
    inside = np.zeros((len(planes), len(sides)), dtype=bool)
    for k, plane in enumerate(planes):
        inside[k] = edges_in(nodes, sides, plane, slack)
    return planes, inside


def _named(nodes: Floats, sides: Indices, axis: int, slack: float) -> tuple[Plane, ...]:
    """Return the planes at the ends of the surface along `axis` in which open edges lie, within `slack`."""
    planes = []
    for end in (float(nodes[:, axis].min()), float(nodes[:, axis].max())):
        inside = edges_in(nodes, sides, Plane(axis, end), 2.0 * slack)
        if inside.any():
            planes.append(Plane(axis, float(np.median(nodes[sides[inside, :2], axis]))))
    return tuple(planes)


def in_planes(surface: Surface, planes: tuple[Plane, ...], inside: Indices) -> Floats:
    """Return the nodes (n, 3) of a surface, with open edges `inside` planes moved exactly into them."""
    nodes, edges = surface.nodes.copy(), surface.open_edges
    for plane, flags in zip(planes, inside, strict=True):
        nodes[edges[flags], plane.axis] = plane.value
    return nodes


def free_edges_note(surface: Surface, inside: Indices) -> str:
    """Return a note on open edges that lie in no plane of symmetry, an empty text if there are none."""
    edges = surface.open_edges
    free = ~inside.any(axis=0) if len(inside) else np.ones(len(edges), dtype=bool)
    if not free.any():
        return ""
    count, node = int(free.sum()), int(edges[free][0, 0])
    return (
        f"{count} open edges are in no plane of symmetry and are left free, their lines splayed, first at "
        f"{surface.place(node)}"
    )


def planes_note(planes: tuple[Plane, ...], named: str | None) -> str:
    """Return a note on the planes of symmetry that were detected, an empty text if they were named."""
    if not planes or named is not None:
        return ""
    return "open edges are in a plane of symmetry at " + " and ".join(str(plane) for plane in planes)
