"""A surface of patches in space with one table of nodes: seams, poles and folds need no special treatment."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, extent_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.surface.bases import with_bases
from meshonet.geometry.surface.checks import (
    check_gaps,
    check_manifold,
    check_quads,
    check_seams,
    check_sides,
    node_place,
)
from meshonet.geometry.surface.half_edges import ends_of, open_sides, paired, rings
from meshonet.geometry.surface.merge import merged
from meshonet.geometry.surface.orient import closing_axes, outward_sign, turned_alike
from meshonet.geometry.surface.planes import SLANT_DEG, Plane, planes_of, slant
from meshonet.geometry.surface.poles import without_poles


@dataclass(frozen=True, eq=False)
class Surface:
    """Patches that share nodes, with consistent orientation.

    Parameters
    ----------
    nodes : (n, 3) the table of nodes, in any unit of length.
    lattices : for each patch, the indices (ni, nj) of its nodes; the normal i x j points outwards.
    names : names of the patches, ``wall`` if the file has no names.
    twin : (4 m,) opposite half-edge of each half-edge (edge of one quad); -1 at open edges.
    ring, valence : (n, w) neighbours in order around each node, and (n,) the number of neighbours.
    planes : planes of symmetry, normal to an axis, in which open edges lie.
    notes : sentences on what was changed or assumed.
    """

    nodes: Floats
    lattices: tuple[Indices, ...]
    names: tuple[str, ...]
    twin: Indices
    ring: Indices
    valence: Indices
    planes: tuple[Plane, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> float:
        """Greatest extent of the nodes along any axis."""
        return extent_of(self.nodes)

    @property
    def quads(self) -> Indices:
        """Nodes (m, 4) of all quads, patch after patch, i fastest; counter-clockwise seen from outside."""
        return lattice_quads(self.lattices)

    @property
    def open_sides(self) -> Indices:
        """Corners (k, 4) of the quads at open edges; both ends of the open edge come first."""
        return open_sides(self.quads, self.twin)

    @property
    def open_edges(self) -> Indices:
        """Nodes (k, 2) of open edges, which belong to only one quad."""
        return self.open_sides[:, :2]

    def place(self, node: int) -> str:
        """Return the place of a node as text: its patch, i, j, x, y, z."""
        return node_place(self.nodes, self.lattices, node)


def surface_of(grid: Grid, *, poles: Literal["replace", "refuse"] = "replace") -> Surface:
    """Return the surface that the patches (ni, nj, 3) of a grid form together.

    Where a side is a single point (a pole), new patches replace the cells around it; if `poles` is
    ``refuse``, a pole is an error. Open trailing edges are closed. Patches with the opposite orientation are
    reversed along i. Notes report these changes. Normals point outwards if the surface is closed, or
    becomes closed by parallel planes of symmetry. Otherwise most cells keep their orientation. Raises
    InputError: a block that is not a patch; an edge of no length; an edge that three quads share; parts that
    touch only at a node; sides that meet with different nodes or a narrow gap; no consistent orientation; an
    open trailing edge with different numbers of nodes across its thickness at its two spanwise ends.
    """
    if any(block.nodes.ndim != 3 or block.nodes.shape[-1] != 3 for block in grid.blocks):
        problem = "a surface is made of patches (ni, nj, 3), and a block of this grid is none"
        raise InputError(problem, "give patches of a surface in space")
    patches, owners, cores = without_poles([block.nodes for block in grid.blocks], replace=poles == "replace")
    patches, above, bases = with_bases(patches)
    owners += [owners[patch] for patch in above]
    nodes, lattices = merged(patches)
    quads = lattice_quads(lattices)
    check_quads(nodes, lattices, quads)
    twin, crowded = paired(quads, len(nodes))
    check_manifold(nodes, lattices, ends_of(quads)[0][crowded])
    opened = open_sides(quads, twin)[:, :2]
    check_seams(nodes, lattices, opened)
    check_gaps(nodes, lattices, opened)
    lattices, quads, planes, notes = _turned(nodes, lattices, quads, twin)
    twin, _ = paired(quads, len(nodes))
    ring, valence = rings(quads, twin, len(nodes))
    check_sides(nodes, lattices, quads, twin, valence)
    zones = grid.provenance.get("zones") or ()
    named = len(zones) == len(grid.blocks) and all(isinstance(name, str) and name for name in zones)
    names = tuple(zones[owner] if named else "wall" for owner in owners)
    return Surface(nodes, lattices, names, twin, ring, valence, planes, (*cores, *bases, *notes))


def _turned(
    nodes: Floats, lattices: tuple[Indices, ...], quads: Indices, twin: Indices
) -> tuple[tuple[Indices, ...], Indices, tuple[Plane, ...], tuple[str, ...]]:
    """Return lattices and quadrilaterals oriented consistently and outwards, planes of open edges, notes."""
    counts = [(k.shape[0] - 1) * (k.shape[1] - 1) for k in lattices]
    patch = np.repeat(np.arange(len(lattices)), counts)
    component, signs, torn = turned_alike(np.repeat(patch, 4), ends_of(quads), twin, len(lattices))
    if torn is not None:
        problem = f"the surface has one side only: patches {torn[0]} and {torn[1]} cannot face the same way"
        raise InputError(problem, "leave one of the patches out")
    alike = np.where(np.array(signs)[patch, None] < 0, quads[:, ::-1], quads)
    notes: list[str] = []
    planes: list[Plane] = []
    final = np.array(signs)
    for part in range(max(component) + 1):
        members = [k for k, c in enumerate(component) if c == part]
        own = np.isin(patch, members)
        mine = np.flatnonzero(twin < 0)
        opened = open_sides(quads, twin)[own[mine // 4]]
        flat = planes_of(nodes, opened)
        axes = closing_axes(nodes, opened, flat)
        sign = outward_sign(nodes, alike[own], axes)
        if sign is None:
            faces = sum(signs[k] * counts[k] for k in members)
            sign = -1 if faces < 0 else 1
            notes.append("the surface encloses nothing: it is taken to face as its patches do, i x j")
            slanted = {plane: slant(nodes, opened, plane) for plane in flat}
            notes += [_slant_note(plane, angle) for plane, angle in slanted.items() if angle > SLANT_DEG]
            flat = tuple(plane for plane in flat if slanted[plane] <= SLANT_DEG)
        planes += [plane for plane in flat if plane.axis in axes and plane not in planes]
        final[members] *= sign
    lattices = tuple(k[::-1] if sign < 0 else k for k, sign in zip(lattices, final, strict=True))
    turned = [str(k) for k, sign in enumerate(final) if sign < 0]
    if turned:
        notes.append(_turned_note(turned, len(lattices)))
    return lattices, lattice_quads(lattices), tuple(planes), tuple(notes)


def _slant_note(plane: Plane, angle: float) -> str:
    problem = f"the open edges at {plane} are not in a plane of symmetry"
    return f"{problem}: the surface meets it at {90.0 - angle:.0f} degrees and encloses nothing"


def _turned_note(turned: list[str], count: int) -> str:
    if len(turned) == count:
        return "all patches faced inwards and were turned round (i reversed)"
    which = "patches " + ", ".join(turned[:12]) + (" ..." if len(turned) > 12 else "")
    were = "was" if len(turned) == 1 else "were"
    if len(turned) == 1:
        which = f"patch {turned[0]}"
    return f"{which} faced the other way than the rest and {were} turned round (i reversed)"
