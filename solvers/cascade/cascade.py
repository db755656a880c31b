"""A cascade: its blade with neighbours and layers, its passage, and the cell sizes in it."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, complex_of, pairs_of
from meshonet.geometry.cached import cached_property
from meshonet.geometry.domain.check import check_domain
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_gaps
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import times
from meshonet.geometry.errors import InputError
from meshonet.geometry.reach import MOST_CELLS, check_reach
from meshonet.geometry.shapes.assembly import far_loop
from meshonet.solvers.blocking.layers.layer_rows import ring_metric
from meshonet.solvers.blocking.layers.rings import COLUMNS, THICKNESS, Ring, march_ring
from meshonet.solvers.blocking.request import CELLS
from meshonet.solvers.cascade.passage import BLADE, NEAR, Passage
from meshonet.solvers.layers.even_line import Measures
from meshonet.solvers.layers.layer_settings import LayerSettings
from meshonet.solvers.refinement.size_metric import SizeMetric

PLAIN_ROWS, PLAIN_GROWTH = 6.0, 1.1
"""Number of rows within this thickness and their growth ratio, if no first-cell height is given."""
GAP_PART = 0.25  # largest fraction of the narrowest gap between blades that layers fill
_SAMPLES = 400  # points of the blade at which the gap is measured
ACROSS = 12.0  # smallest number of cells per pitch, before the requested number of cells is distributed
COARSEST = 20.0  # largest factor by which cells along the blade may become longer
MORE = 10.0  # largest ratio of the number of cells to the requested number, for a long inlet or outlet
SHORTEST = 0.08  # smallest distance in pitches from the blade with its layers to inlet or outlet


@dataclass(frozen=True)
class Cascade:
    """A row of blades.

    Parameters
    ----------
    blade : loop (closed curve) of the blade, with the passage on its left.
    pitch : displacement from one blade to the next.
    inlet, outlet : lengths of the passage upstream and downstream of the blade, in axial chords.
    settings : layers at the blade; by default a few layers that grow slowly.
    name : name of the blade.
    near : distances upstream and downstream of the blade, in pitches, beyond which grid lines are straight.
    centre : point inside the blade from which axial distances are measured; the default is the point farthest
        from its surface.
    marched : the layers around the blade, if they are already known.
    share : factor on the thickness of layers.
    factors : (n,) factors on the first-cell height at the points of the blade; the default is 1.
    """

    blade: Loop
    pitch: tuple[float, float]
    inlet: float = 1.0
    outlet: float = 1.0
    settings: LayerSettings | None = None
    name: str = ""
    near: tuple[float, float] = (NEAR, NEAR)
    centre: complex | None = None
    marched: Ring | None = None
    factors: Floats | None = None
    share: float = 1.0

    def ending(self, near: tuple[float, float], centre: complex) -> Self:
        """Return the cascade with the same layers, and new values of its fields `near` and `centre`."""
        return replace(self, near=near, centre=centre, marched=self.ring)

    @property
    def opposite(self) -> bool:
        """Whether the vector `pitch` points to the right of the flow, which goes towards larger x."""
        return self.pitch[1] < 0.0 or (self.pitch[1] == 0.0 and self.pitch[0] > 0.0)

    @property
    def left(self) -> complex:
        """Displacement to the next blade to the left, seen in the direction of the flow."""
        pitch = complex(*self.pitch)
        return -pitch if self.opposite else pitch

    @property
    def axis(self) -> complex:
        """Unit vector from inlet to outlet."""
        return self.left / (1j * abs(self.left))

    @cached_property
    def chord(self) -> float:
        """Extent of the blade along the axis."""
        return float(np.ptp(self._axial(self.blade)))

    @property
    def extent(self) -> float:
        """Length of the passage or its pitch, whichever is larger."""
        return max((1.0 + self.inlet + self.outlet) * self.chord, abs(self.left))

    def _axial(self, loop: Loop) -> Floats:
        return np.asarray(times(complex_of(loop.curve.points), np.conj(self.axis)).real)

    @cached_property
    def blades(self) -> Domain:
        """The blade and its neighbours on both sides. Raises InputError if they intersect."""
        shift = pairs_of(np.array([-self.left, self.left]))
        beside = [_moved(self.blade, each) for each in shift]
        farthest = max(float(np.abs(loop.curve.points).max()) for loop in (self.blade, *beside))
        try:
            check_domain(Domain((far_loop(np.zeros(2), 4.0 * farthest), self.blade, *beside)))
        except InputError as error:
            problem = f"blades {abs(self.left):g} apart touch or cross"
            raise InputError(problem, "use a larger pitch", parameter="pitch") from error
        return Domain((self.blade, *beside), self.name)

    @cached_property
    def thickness(self) -> float:
        """Thickness of the layers, limited to a part of the narrowest gap between blades."""
        arcs = np.linspace(0.0, self.blade.length, _SAMPLES, endpoint=False)
        gap = float(wall_gaps(self.blades, self.blade, arcs).min())
        return self.share * min(THICKNESS * self.blade.length, GAP_PART * gap)

    @property
    def kept(self) -> float:
        """Fraction of the intended thickness that the layers reach; below 1 if thicker ones would fold."""
        return min(float(self.ring.thickness.max()) / self.thickness, 1.0)

    @cached_property
    def layers(self) -> LayerSettings:
        """Settings of the layers around the blade."""
        return self.settings or LayerSettings(self.thickness / PLAIN_ROWS, PLAIN_GROWTH)

    @cached_property
    def ring(self) -> Ring:
        """The layers around the blade, computed if they are not given."""
        if self.marched:
            return self.marched
        largest = self.blade.length / COLUMNS
        return march_ring(self.blades, 0, self.layers.first, self.thickness, largest)

    @property
    def measures(self) -> dict[int, Measures]:
        """Arc lengths along loops, by loop index; nodes are moved so that steps between them grow slowly."""
        return {BLADE: self.ring.along} if self.layers.limit else {}

    def factors_at(self, arcs: Floats) -> Floats:
        """Return the factors (k,) on the first-cell height at arc lengths `arcs` (k,) of the blade."""
        if self.factors is None:
            return np.ones(len(arcs))
        return np.interp(arcs, self.blade.curve.knots, self.factors, period=self.blade.length)

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Requested lengths from the front (the outer edge of the layers) to inlet and outlet."""
        axial, around = self._axial(self.blade), self._axial(self.ring.front)
        before = self.inlet * self.chord - float(axial.min() - around.min())
        return before, self.outlet * self.chord - float(around.max() - axial.max())

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Lengths from the layers to inlet and outlet. Raises InputError if they are too short for blocks."""
        chord, (before, behind) = self.chord, self.reach
        for length, name, chords in ((before, "inlet", self.inlet), (behind, "outlet", self.outlet)):
            least = SHORTEST * abs(self.left)
            if length < least:
                enough = chords + 1.01 * (least - length) / chord
                problem = f"{chords:g} axial chords leave no room for blocks beside the blade"
                raise InputError(problem, f"use {enough:.2g} or more", parameter=name)
        return before, behind

    @cached_property
    def passage(self) -> Passage:
        """The region around the blade and its layers, up to inlet, outlet and the neighbouring blades."""
        front = self.ring.front
        return Passage.around(front, self.left, *self.ends, self.name, self.near, self.centre)

    @cached_property
    def rows_of_layers(self) -> int:
        """Number of rows of cells in the layers around the blade."""
        return self.layers.rows(float((self.ring.thickness / self.factors_at(self.ring.arcs)).max()))

    @cached_property
    def metric(self) -> SizeMetric:
        """Target cell sizes outside the layers of the blade and of the two neighbouring blades."""
        own = self.factors_at(self.ring.arcs)
        sizes = replace(ring_metric(self.ring, self.layers, own), largest=abs(self.left) / ACROSS)
        shift = pairs_of(np.array([0.0, -self.left, self.left]))
        points = (shift[:, None] + sizes.points).reshape(-1, 2)
        normals, across, along = (
            np.concatenate([values] * 3) for values in (sizes.normals, sizes.across, sizes.along)
        )
        return replace(sizes, points=points, normals=normals, across=across, along=along)

    def check_reach(self, cells: int | None, cell_size: float | None) -> None:
        """Raise InputError if the passage is far too long for `cells` cells, or for cells of `cell_size`."""
        largest = cell_size or abs(self.left) / ACROSS * COARSEST**0.5
        length = (1.0 + self.inlet + self.outlet) * self.chord
        most = MOST_CELLS if cell_size else min(MORE * (cells or CELLS), MOST_CELLS)
        long = "inlet" if self.inlet > self.outlet else "outlet"
        check_reach(
            length / largest * (abs(self.left) / largest), "cells", f"a passage of length {length:.3g}",
            f"use a shorter {{{long}}}, or " + ("larger cells" if cell_size else "more {cells}"), most=most,
        )  # fmt: skip


def scaled(metric: SizeMetric, scale: float) -> SizeMetric:
    """Return the `metric` with target lengths along the blade multiplied by `scale`."""
    return replace(metric, along=scale * metric.along, largest=metric.largest * scale**0.5)


def _moved(blade: Loop, shift: Floats) -> Loop:
    return Loop(blade.curve.moved(shift), blade.corners, blade.names)
