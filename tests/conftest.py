"""Fixtures of all tests; the mark of those that run Debian's programs, from ``make test-clients``."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator

import pytest

from meshonet.geometry import threads


@pytest.fixture
def silent_gmsh() -> Iterator[None]:
    """Gmsh itself, which prints nothing."""
    import gmsh

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.AbortOnError", 2)
    yield
    gmsh.finalize()


@pytest.fixture
def eager_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have threads work on grids of any size."""
    monkeypatch.setattr(threads, "NODES_EACH", 16)


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "client(program): runs a program that is not from PyPI")
    config.addinivalue_line("markers", "solver(program): runs a program that Debian does not have either")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test whose program is not there, unless it was promised to be."""
    for mark in item.iter_markers("client"):
        program = str(mark.args[0])
        if shutil.which(program) is None:
            missing = f"{program} is not installed: make test-clients"
            if os.environ.get("MESHONET_CLIENTS"):
                pytest.fail(missing)
            pytest.skip(missing)
    for mark in item.iter_markers("solver"):
        if shutil.which(str(mark.args[0])) is None:
            pytest.skip(f"{mark.args[0]} is not installed")
