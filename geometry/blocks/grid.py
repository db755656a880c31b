"""A structured grid.

::

         north (j = nj-1)                    o: i runs clockwise around the body from the trailing
        +----------------+                      edge: lower side, leading edge, upper side;
        |                |                      south is the body, north the far field, and
   west |   eta          | east                 column ni-1 repeats column 0 bitwise
  (i=0) |    ^           | (i = ni-1)        c: south is wake, body, wake; the two wakes
        |    |           |                      coincide bitwise
        |    +--> xi     |
        +----------------+
         south (j = 0)

Nodes are ``[i, j] = (x, y)`` at (xi_i, eta_j); a valid grid is right-handed: every corner of every cell
has a positive Jacobian.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import InitVar, dataclass, field, replace
from typing import Any

import numpy as np

from meshonet.geometry.arrays import TOPOLOGIES, Floats, Topology, as_planar
from meshonet.geometry.blocks.metadata import UNKNOWN, Origin
from meshonet.geometry.blocks.patches import Patch, check_patches, known_patches
from meshonet.geometry.errors import InputError


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes, topology and named parts; validates itself.

    Parameters
    ----------
    nodes : (ni, nj, 2) float64, any unit of length, kept in planar layout (see `meshonet.geometry.arrays`).
    topology : ``quad``, ``o`` or ``c``.
    patches : named stretches of the sides; empty means those of `meshonet.geometry.blocks.patches.known_patches`.
    name : what the input called this shape.
    provenance : how the grid was made: method, settings, version.
    origin : that of its boundary.
    finite : the nodes are known to be finite: they are not read through, which takes a tenth of making some.

    Raises
    ------
    InputError
        nodes of the wrong shape, fewer than 2 along a direction, or not finite; an open O seam.
    """

    nodes: Floats
    topology: Topology = "quad"
    patches: tuple[Patch, ...] = ()
    name: str = ""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    origin: Origin = UNKNOWN
    finite: InitVar[bool] = False

    def __post_init__(self, finite: bool) -> None:
        nodes = np.asarray(self.nodes)
        if nodes.ndim != 3 or nodes.shape[2] != 2 or min(nodes.shape[:2]) < 2:
            raise InputError(
                f"grid nodes have shape {nodes.shape}", "give (ni, nj, 2) with ni and nj at least 2"
            )
        nodes = as_planar(nodes)
        if self.topology not in TOPOLOGIES:
            raise InputError(f"topology {self.topology!r} is not known", "use " + "/".join(TOPOLOGIES))
        if not finite:
            _check_finite(nodes)
        if self.topology == "o" and not np.array_equal(nodes[0], nodes[-1]):
            j = int(np.argmax((nodes[0] != nodes[-1]).any(axis=-1)))
            raise InputError(
                f"column ni-1 differs from column 0 at j={j}", "close the O grid or call it quad"
            )
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(
            self, "patches", tuple(self.patches) or known_patches(self.topology, nodes[:, 0], self.nj)
        )
        check_patches(self.patches, self.ni, self.nj)

    @classmethod
    def from_nodes(cls, *args: Any, **settings: Any) -> Grid:
        """Return the grid of one block of nodes."""
        return cls(*args, **settings)

    @property
    def ni(self) -> int:
        """Nodes along xi."""
        return int(self.nodes.shape[0])

    @property
    def nj(self) -> int:
        """Nodes along eta."""
        return int(self.nodes.shape[1])

    @property
    def x(self) -> Floats:
        """(ni, nj) x coordinates, C-contiguous, a view."""
        return self.nodes[..., 0]

    @property
    def y(self) -> Floats:
        """(ni, nj) y coordinates, C-contiguous, a view."""
        return self.nodes[..., 1]

    def with_provenance(self, **facts: Any) -> Grid:
        """Return the same grid with `facts` added to its provenance."""
        return replace(self, provenance={**self.provenance, **facts}, finite=True)


def _check_finite(nodes: Floats) -> None:
    # sums are finite exactly when (overflow aside) their terms are: one pass, no temporary, by BLAS
    ones = np.ones(nodes.shape[1])
    with np.errstate(invalid="ignore"):  # infinity less infinity
        total = (nodes[..., 0] @ ones).sum() + (nodes[..., 1] @ ones).sum()
    if not np.isfinite(total):
        finite = np.isfinite(nodes).all(axis=-1)
        if not finite.all():
            i, j = (int(k) for k in np.argwhere(~finite)[0])
            raise InputError(f"node i={i}, j={j} is not finite", "check the file for NaN or infinity")
