"""The table of what applies to what: it knows every option, and every option reaches code that reads it."""

import ast
import functools
import inspect
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.aircraft.request import AircraftRequest
from meshonet.solvers.blocking.request import BlockRequest
from meshonet.solvers.pipeline.deformations import DeformRequest
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.named import method_named
from meshonet.solvers.pipeline.request import GridRequest, ManyBlocks, OneBlock, Volume
from meshonet.solvers.pipeline.uses import ALWAYS, COUNTED, FOR_MANY, IN_SPACE, MANY, ONE, USES, refuse
from meshonet.solvers.rows.request import RowRequest
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.sweeping.sweep import Sweep
from meshonet_cli.app import application
from meshonet_cli.batch.settings import Engine, Files

ROOT = Path(__file__).parents[2]
ONLY_CHECKED = ("check_request.py", "uses.py")
"""Files that say what may be asked for: to be named there is not to have an effect."""
OF_REQUESTS = {
    each.name
    for kind in (Sampling, GridRequest, StackRequest, RowRequest, AircraftRequest, DeformRequest, Sweep)
    for each in fields(kind)
}
OF_RUNS = {each.name for kind in (Files, Engine) for each in fields(kind)} | {
    "as_json", "quiet", "debug", "pick", "shard", "fail_on", "profile", "leave_out_failed", "engine",
}  # fmt: skip
OTHERS = {
    "boundary", "domain", "sections", "names", "grid",  # what is read
    "assemble", "tip", "surface",  # parameters of functions beside the request
    "wall", "rotate", "shift",  # walls of a deformed grid
    "res",
}  # fmt: skip
"""Parameters of commands that are no fields."""
MAKERS = ("tfi", "solve-pde", "infer", "layout", "stack", "sweep", "deform")


@functools.cache
def names_read() -> frozenset[str]:
    """Attributes that code in `solvers` and `geometry` reads, and beginnings of those put together."""
    return frozenset(names_in_code())


def names_in_code() -> Iterator[str]:
    """Yield them, one by one."""
    for room in ("solvers", "geometry"):
        for path in (ROOT / room).rglob("*.py"):
            if path.name in ONLY_CHECKED:
                continue
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
                    yield node.attr
                elif isinstance(node, ast.JoinedStr) and isinstance(node.values[0], ast.Constant):
                    yield str(node.values[0].value)


def settings() -> set[str]:
    """Settings of all methods."""
    known: set[str] = set()
    for name in METHODS:
        method = method_named(name)
        function = getattr(method, "function", type(method))
        known |= set(inspect.signature(function).parameters)
    return known


@pytest.mark.parametrize("kind", [Sampling, GridRequest, BlockRequest, StackRequest, DeformRequest, Sweep])
def test_every_field_of_a_request_is_read(kind: type) -> None:
    read = names_read()
    unread = {each.name for each in fields(kind)} - read  # type: ignore[arg-type]
    assert {name for name in unread if name.rpartition("_")[0] + "_" not in read} == set()


def test_the_table_has_every_option_and_no_other() -> None:
    named = set().union(*USES.values())
    own = {each.name for each in fields(GridRequest)} - ALWAYS
    sampled = {"res" if each.name in COUNTED else each.name for each in fields(Sampling)} - {"viscous"}
    assert own | sampled <= named
    assert named <= own | sampled | settings() | {"energy"}


def test_options_of_a_way_are_fields_of_its_request() -> None:
    sampled = {each.name for each in fields(Sampling)} | {"res"}
    for kind, way in ((OneBlock, ONE), (ManyBlocks, MANY)):
        assert USES[way] - sampled - {"blocks"} <= {each.name for each in fields(kind)}
    assert set(IN_SPACE) <= {each.name for each in fields(Volume)}
    assert set(FOR_MANY) <= {each.name for each in fields(BlockRequest)}


@pytest.mark.parametrize("command", MAKERS)
def test_every_option_of_a_command_that_makes_grids_is_a_field(command: str) -> None:
    options = {option.name for option in application().commands[command].params}
    assert options - OF_REQUESTS - OF_RUNS - OTHERS - settings() - {"help"} == set()


def test_what_is_chosen_is_what_is_not_by_default() -> None:
    assert GridRequest().chosen == ()
    request = GridRequest(
        Sampling(9, 9, te="wedge"), "winslow", {"tol": 1e-3, "blending": "arclength"}, refine=1
    )
    assert request.chosen == ("res", "te", "refine", "tol")


def test_an_option_of_no_use_is_refused_by_name() -> None:
    refuse(["res", "cells"], MANY)
    with pytest.raises(InputError, match="spacing is of no use to a domain of many blocks; drop spacing"):
        refuse(["res", "spacing"], MANY)
