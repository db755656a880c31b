"""Planes of symmetry of a surface, and its open edges moved exactly into them.

A plane that walls face is none if the march would reach it before the far field. In a plane of symmetry walls
turn away from it, or end at right angles.
"""

from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, norms
from meshonet.geometry.errors import InputError
from meshonet.geometry.surface.planes import FLAT, Plane, edges_in
from meshonet.geometry.surface.surface import Surface

ROUGH = 1e-3  # largest distance of nodes from a given plane of symmetry, relative to the size of the surface
_FACING = 0.1  # largest net area that faces a plane of symmetry, as a fraction of the surface


class Symmetry(NamedTuple):
    """Planes of symmetry of a surface, the open edges (edges of one face only) in each, and notes."""

    planes: tuple[Plane, ...]
    inside: Bools  # (p, k) whether open edge k is in plane p
    notes: tuple[str, ...]


def symmetry_of(surface: Surface, axis: str | None, far: float) -> Symmetry:
    """Return the planes of symmetry of a surface that is marched to the distance `far`.

    `axis` is the normal of the planes (x, y or z), ``none`` for no plane, or None to detect planes. If much
    of the surface faces a plane and is nearer to it than `far`, grid lines would cross the plane. A detected
    plane is then left out; if `axis` was given, InputError is raised. It is also raised if no plane normal to
    the given axis contains open edges of the surface.
    """
    planes, inside = symmetry_planes(surface, axis)
    kept, notes = [], []
    for k, plane in enumerate(planes):
        distance = closes_in(surface, plane)
        if distance >= far:
            kept.append(k)
            continue
        facing = f"walls {distance:.4g} away face it, and the far field is {far:.4g} away"
        if axis is not None:
            remedy = "give {symmetry} none or a nearer {far_field}"
            problem = f"the plane {plane} closes in before the far field: {facing}"
            raise InputError(problem, remedy, parameter="symmetry")
        notes.append(f"the open edges at {plane} are not in a plane of symmetry: {facing}")
    planes, inside = tuple(planes[k] for k in kept), inside[kept]
    every = (planes_note(planes, axis), *notes, free_edges_note(surface, inside))
    return Symmetry(planes, inside, tuple(note for note in every if note))


def closes_in(surface: Surface, plane: Plane) -> float:
    """Return the mean distance from a plane to the walls that face it; infinite if their area is small."""
    a, b, c, d = (surface.nodes[surface.quads[:, k]] for k in range(4))
    area = 0.5 * np.cross(c - a, d - b)
    away = (0.25 * (a + b + c + d))[:, plane.axis] - plane.value
    facing = -np.sign(away) * area[:, plane.axis]
    if facing.sum() <= _FACING * norms(area).sum():
        return np.inf
    towards = np.maximum(facing, 0.0)
    return float((towards * np.abs(away)).sum() / towards.sum())


def symmetry_planes(surface: Surface, axis: str | None) -> tuple[tuple[Plane, ...], Bools]:
    """Return planes normal to `axis` that contain open edges of a surface, and the edges in each plane.

    The edges are a mask (p, k) for p planes and all k open edges. For `axis` see `symmetry_of`. Raises
    InputError if no open edge is in a plane normal to it.
    """
    sides, nodes = surface.open_sides, surface.nodes
    if axis in (None, "none"):
        planes, slack = (surface.planes if axis is None else ()), FLAT * surface.size
    else:
        planes, slack = tuple(p for p in surface.planes if "xyz"[p.axis] == axis), FLAT * surface.size
        if not planes:
            slack = ROUGH * surface.size
            planes = _named(nodes, sides, "xyz".index(str(axis)), slack)
        if not planes:
            problem = f"no open edge of the surface lies in a plane across {axis}"
            raise InputError(problem, "leave {symmetry} out, or name another axis", parameter="symmetry")
    inside = np.zeros((len(planes), len(sides)), dtype=bool)
    for k, plane in enumerate(planes):
        inside[k] = edges_in(nodes, sides, plane, slack)
    return planes, inside


def _named(nodes: Floats, sides: Indices, axis: int, slack: float) -> tuple[Plane, ...]:
    """Return the planes at the ends of the surface along `axis` with open edges within `slack`."""
    planes = []
    for end in (float(nodes[:, axis].min()), float(nodes[:, axis].max())):
        inside = edges_in(nodes, sides, Plane(axis, end), 2.0 * slack)
        if inside.any():
            planes.append(Plane(axis, float(np.median(nodes[sides[inside, :2], axis]))))
    return tuple(planes)


def in_planes(surface: Surface, planes: tuple[Plane, ...], inside: Bools) -> Floats:
    """Return the nodes (n, 3), those of open edge k moved exactly into plane p where ``inside[p, k]``."""
    nodes, edges = surface.nodes.copy(), surface.open_edges
    for plane, flags in zip(planes, inside, strict=True):
        nodes[edges[flags], plane.axis] = plane.value
    return nodes


def free_edges_note(surface: Surface, inside: Bools) -> str:
    """Return a note on open edges that are in no plane of symmetry; empty if there are none."""
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
    """Return a note on the planes of symmetry; empty if the user `named` them."""
    if not planes or named is not None:
        return ""
    return "open edges are in a plane of symmetry at " + " and ".join(str(plane) for plane in planes)
