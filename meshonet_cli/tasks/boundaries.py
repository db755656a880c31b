"""Task of `sample-boundary`: boundaries from files, or drawn from a family."""

from collections.abc import Iterator
from functools import partial
from typing import Any

from meshonet.formats.registry import format_for_output, is_cad, read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.cad.model import CadModel
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.draw import Draw
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.stages import stage
from meshonet_cli.batch.drawn import DrawnInputs
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.report.delivered import Delivered, delivered, part_names

EDGE_NODES = 1000  # typical number of nodes on the edges of a boundary


def write_boundaries(batch: Batch, sampling: Sampling, sensors: int | None = None) -> int:
    """Place boundary nodes on the shapes of a batch, write the boundaries, and return the exit code.

    `sensors` nodes are also stored, as input of neural operators. Raises InputError if it is given for CAD
    files, or for output that is not HDF5.
    """
    files = batch.files
    drawn = isinstance(batch.inputs, DrawnInputs)
    if not drawn and is_cad(batch.inputs.first(), files.from_format):
        if sensors is not None:
            raise InputError("patches have no sensors", "drop {sensors}", parameter="sensors")
        return batch.run(
            BatchTask(partial(read_shapes, fmt=files.from_format), each(_patched, sampling=sampling))
        )
    if sensors is not None and format_for_output(files.output, files.to_format, "boundaries").name != "hdf5":
        raise InputError("only HDF5 keeps sensors", "write an .h5 file", parameter="sensors")
    read: Any = itself if drawn else partial(read_shapes, fmt=files.from_format)
    make = each(_sampled, sampling=sampling, sensors=sensors)
    return batch.run(BatchTask(read, make, "boundaries", nodes=EDGE_NODES))


def itself(member: Draw) -> Iterator[Draw]:
    """Yield `member`, a random shape, unchanged: for such shapes, this takes the place of reading a file."""
    return iter([member])


def _patched(item: Item[Shape], sampling: Sampling) -> tuple[Grid, Delivered]:
    from meshonet.solvers.cad.patches import patches_on

    if not isinstance(item.what, CadModel):
        raise InputError("is no CAD file, and the first input is one", "sample it by a command of its own")
    solution = patches_on(item.what, sampling)
    report = delivered(item, solution.grid, {}, "patches of a surface", notes=solution.notes)
    report.seconds |= solution.seconds
    return solution.grid, report


def _sampled(item: Item[Shape], sampling: Sampling, sensors: int | None) -> tuple[Boundary, Delivered]:
    seconds: dict[str, float] = {}
    with stage("boundary", seconds):
        boundary = edges_of(item.what, sampling)
        if sensors is not None:
            boundary = boundary.with_sensors(sensors)
    report = delivered(item, boundary, part_names(boundary), notes=boundary.notes)
    report.seconds |= seconds
    return boundary, report
