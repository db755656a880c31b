"""Task of `deform`."""

from collections.abc import Mapping, Sequence
from functools import partial

from meshonet.api.deform import rotation
from meshonet.api.files import only, read_all
from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.criteria import Criteria
from meshonet.solvers.deformation.targets import NewWall
from meshonet.solvers.pipeline.deformations import DeformRequest, make_deformed
from meshonet.solvers.pipeline.result import Result
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.options.groups import bad_value
from meshonet_cli.tasks.grids import made_by


def write_deformed(
    batch: Batch, walls: Mapping[str, NewWall] | NewWall, criteria: Criteria | None, *, allow_invalid: bool,
    threads: int | None,
) -> int:  # fmt: skip
    """Deform the grids of a batch to new `walls`, write them, and return the exit code."""
    percentiles = criteria is not None and criteria.percentiles
    request = DeformRequest(allow_invalid, percentiles, batch.engine.threads(threads))
    batch.session.judges = criteria is not None
    make = each(made_by, solve=partial(_deformed, walls=walls, request=request), criteria=criteria)
    return batch.run(BatchTask(partial(read_grids, fmt=batch.files.from_format), make))


def _deformed(grid: Grid, walls: Mapping[str, NewWall] | NewWall, request: DeformRequest) -> Result:
    """Return the deformed grid; errors name the option that moves the walls, if it is one."""
    try:
        return make_deformed(grid, walls=walls, request=request)
    except InputError as error:
        if error.parameter == "wall" and isinstance(walls, Mapping):
            options = {_option(new) for new in walls.values()}
            error.parameter = options.pop() if len(options) == 1 else ""
        raise


def _option(new: NewWall) -> str:
    return "wall" if not isinstance(new, Motion) else "rotate" if new.turn else "shift"


def walls_of(
    wall: Sequence[str], rotate: Sequence[str], shift: Sequence[str]
) -> Mapping[str, NewWall] | NewWall:
    """Return the new walls that options describe, by name; or a single new wall if it has no name.

    Raises InputError if a text is invalid, a wall is named twice, or a file is unreadable.
    """
    if not (wall or rotate or shift):
        raise InputError("nothing is moved", "give {wall}, {rotate} or {shift}", source="deform")
    named = [text.partition("=") for text in wall]
    if len(wall) == 1 and not named[0][1] and not (rotate or shift):
        return _read(wall[0], wall[0])
    walls: dict[str, NewWall] = {}
    for text, (name, _, file) in zip(wall, named, strict=True):
        if not (name and file):
            raise bad_value(text, "NAME=FILE", "name the wall of each file, as flap=flap.dat", "wall")
        _put(walls, name, _read(file, text), "wall")
    motions: dict[str, Motion] = {}
    for text in rotate:
        name, motion = _turn(text)
        _put(motions, name, motion, "rotate")
    for name, motion in _shifts(shift).items():
        turn = motions.get(name, Motion())
        first = turn.shift or (0.0,) * len(motion.shift)
        if len(first) != len(motion.shift):
            raise InputError(f"{name!r} is turned in the plane", "shift it by DX,DY", parameter="shift")
        moved = tuple(a + b for a, b in zip(first, motion.shift, strict=True))
        motions[name] = Motion(moved, turn.turn)
    for name, motion in motions.items():
        _put(walls, name, motion, _option(motion))
    return walls


def _put(walls: dict[str, NewWall] | dict[str, Motion], name: str, new: NewWall, option: str) -> None:
    if name in walls:
        raise InputError(f"{name!r} is moved twice", "name every wall once", parameter=option)
    walls[name] = new  # type: ignore[assignment]


def _read(file: str, text: str) -> NewWall:
    if not file.strip():
        raise bad_value(text, "a file", "give the new shape of a wall", "wall")
    return only(read_all(file), file, "the new shape of a wall")


def _turn(text: str) -> tuple[str, Motion]:
    name, _, rest = text.partition("=")
    degrees, _, about = rest.partition("@")
    numbers = _numbers([degrees, *about.split(",")])
    if not name or len(numbers) != 3:
        raise bad_value(text, "NAME=DEGREES@X,Y", "use e.g. flap=-5@0.9,0.02", "rotate")
    return name, rotation(numbers[0], numbers[1:])


def _shifts(texts: Sequence[str]) -> dict[str, Motion]:
    motions: dict[str, Motion] = {}
    for text in texts:
        name, _, rest = text.partition("=")
        numbers = _numbers(rest.split(","))
        if not name or len(numbers) not in (2, 3):
            raise bad_value(text, "NAME=DX,DY", "use e.g. flap=0.01,-0.02", "shift")
        _put(motions, name, Motion(tuple(numbers)), "shift")
    return motions


def _numbers(words: Sequence[str]) -> list[float]:
    """Return words as finite numbers; empty if one is not a number."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return []
    return numbers if all(abs(number) < 1e12 for number in numbers) else []
