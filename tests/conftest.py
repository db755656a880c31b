"""Fixtures of all tests; the mark of those that run Debian's programs, from ``make test-clients``."""

import compileall
import contextlib
import gc
import os
import shutil
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from meshonet.geometry import threads

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session", autouse=True)
def _children_heed_signals() -> None:
    """Have processes that tests start heed signals, also where the tests themselves are to ignore them.

    Who starts tests in the background (``nohup``, a shell's ``&``) has them ignore signals, and children
    inherit that. They do not inherit a handler, even one that does nothing.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


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
    if not hasattr(config, "workerinput"):
        _compile()
    gc.disable()  # tests are collected in three quarters of the time without searches for cycles
    config.addinivalue_line("markers", "client(program): runs a program that is not from PyPI")
    config.addinivalue_line("markers", "solver(program): runs a program that Debian does not have either")
    config.addinivalue_line("markers", "slow: takes a second or more; make test-fast leaves it out")
    config.addinivalue_line("markers", "browser: opens pages in Chromium")


def _compile() -> None:
    """Compile once what hundreds of processes of tests import, where Python is told to keep nothing too.

    What is compiled already is left as it is.
    """
    for room in ("geometry", "formats", "solvers", "kernels", "meshonet", "meshonet_cli"):
        compileall.compile_dir(ROOT / room, quiet=2)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems() -> None:
    """Have hypothesis draw no constants of this project's modules, all of which it would parse: 5 s.

    What its tests draw then does not depend on the modules that other tests load either.
    """
    if "hypothesis" in sys.modules:
        with contextlib.suppress(ImportError):  # an older one has none
            from hypothesis.internal.conjecture import providers

            providers._get_local_constants = providers.Constants


def pytest_collection_finish() -> None:
    """Search for cycles again, but not among what has been collected."""
    gc.freeze()
    gc.enable()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test whose program is not there, unless it was promised to be."""
    for program in _missing(item, "client"):
        missing = f"{program} is not installed: make test-clients"
        if os.environ.get("MESHONET_CLIENTS"):
            pytest.fail(missing)
        pytest.skip(missing)
    for program in _missing(item, "solver"):
        pytest.skip(f"{program} is not installed")
    if item.get_closest_marker("browser") and not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("Chromium is not installed")


def _missing(item: pytest.Item, mark: str) -> list[str]:
    programs = [str(each.args[0]) for each in item.iter_markers(mark)]
    return [program for program in programs if shutil.which(program) is None]
