"""Makes the multi-block grid of the passage of a cascade."""

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.make import grid_of, settings_of
from meshonet.solvers.blocking.request import BlockRequest
from meshonet.solvers.cascade.cascade import Cascade
from meshonet.solvers.cascade.cascade_layout import cascade_layout
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import Timings


def make_passage(shape: DomainShape, request: BlockRequest) -> Solution:
    """Return the grid of a blade passage; the only hole of `shape` is the blade, and `request` has the pitch.

    Raises InputError as `make_blocks`, and for options that do not apply to cascades. Raises NoValidGridError
    if cells are folded.
    """

    def passage(domain: Domain, timings: Timings) -> Layout:
        if request.layout is not None:
            problem = "{layout} beside {pitch}"
            raise InputError(problem, "drop {layout}: the blocks of a cascade are always the same")
        if request.count:
            raise InputError(
                "{count} beside {pitch}", "give {cells}: the counts of a cascade follow from its sizes"
            )
        height, settings, size = request.height(shape.unit), None, request.cell_size
        if height is not None:
            settings = settings_of(request, height)
            if size is not None or request.res is not None:
                raise InputError(
                    "a size of cells beside layers", "give {cells}: sizes follow from the layers"
                )
        inlet, outlet = (1.0 if each is None else each for each in (request.inlet, request.outlet))
        assert request.pitch is not None  # noqa: S101 - the caller looked
        cascade = Cascade(domain.loops[1], request.pitch, inlet, outlet, settings, domain.name)
        if request.res is not None:
            size = cascade.extent / request.res
        cells = request.cells or request.usual_cells(bodies=1)
        return cascade_layout(cascade, cells=cells, cell_size=size, timings=timings)

    return grid_of(shape, request, passage)
