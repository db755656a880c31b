"""Inputs made by hand, and the command line called in this process or in a fresh one."""

import os
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import ROOT, Meshonet, Outcome, Process, dataset, duct, ellipse, wave

from meshonet.solvers.neural.model_file import QUAD, write_model
from meshonet.solvers.neural.quad.encoding import HEADS
from meshonet.solvers.neural.quad.network import shapes
from meshonet_cli import app
from meshonet_cli.commands import COMMANDS, Command

_MADE = app.application


@cache
def _parser(commands: tuple[Command, ...], overview: bool) -> Any:
    return _MADE(commands, overview=overview)


@pytest.fixture
def meshonet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Meshonet:
    """The program, called in this process, in a folder of its own; parsers are made once for all tests."""
    monkeypatch.chdir(tmp_path)

    def parser(commands: Sequence[Command] = COMMANDS, *, overview: bool = False) -> Any:
        return _parser(tuple(commands), overview)

    monkeypatch.setattr(app, "application", parser)

    def call(*words: object) -> Outcome:
        arguments = [str(word) for word in words]
        monkeypatch.setattr(sys, "argv", ["meshonet", *arguments])
        capsys.readouterr()
        code = app.run(arguments)
        out, err = capsys.readouterr()
        return Outcome(code, out, err)

    return call


@pytest.fixture
def process(tmp_path: Path) -> Process:
    """The program in a fresh process, in a folder of its own."""

    def call(*words: object, **options: Any) -> subprocess.CompletedProcess[bytes]:
        command = [sys.executable, "-m", "meshonet_cli", *(str(word) for word in words)]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, timeout=60, **options
        )

    return call


@pytest.fixture
def duct_h5(tmp_path: Path) -> Path:
    """One channel, 21 x 11."""
    return dataset(tmp_path / "duct.h5", "quad", duct())


@pytest.fixture
def body_h5(tmp_path: Path) -> Path:
    """One ellipse in a far field, 41 x 15."""
    return dataset(tmp_path / "body.h5", "o", ellipse())


@pytest.fixture
def three_h5(tmp_path: Path) -> Path:
    """Three named channels."""
    samples = [duct(bump=bump) for bump in (0.0, 0.1, 0.3)]
    return dataset(tmp_path / "three.h5", "quad", *samples, names=("flat", "low", "high"))


@pytest.fixture
def folding_h5(tmp_path: Path) -> Path:
    """A boundary that transfinite interpolation folds."""
    return dataset(tmp_path / "wave.h5", "quad", wave())


@pytest.fixture
def quad_model(tmp_path: Path) -> str:
    """A quad model with random weights."""
    rng = np.random.default_rng(0)
    weights = {
        name: 0.1 * rng.normal(size=shape).astype(np.float32)
        for name, shape in shapes((1, 2), (0, 1), len(HEADS)).items()
    }
    path = tmp_path / "quads.safetensors"
    write_model(path, QUAD, weights, name="random", topology="quad", recipe={}, figures={})
    return str(path)
