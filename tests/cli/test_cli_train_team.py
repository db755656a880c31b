"""Two processes under torchrun share each step, and the losses are those of one with the whole batch."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import ROOT, Meshonet

pytestmark = pytest.mark.skipif(importlib.util.find_spec("torch") is None, reason="needs torch")


def losses(path: str) -> np.ndarray:
    return np.genfromtxt(path, delimiter=",", names=True)["loss"]


@pytest.mark.parametrize("batch", [4])
def test_two_processes_train_as_one(meshonet: Meshonet, tmp_path: Path, batch: int) -> None:
    """Seven shapes in batches of 4 and 3: shares are unequal, and the last ones differ from the first."""
    words = ("--family", "arch", "--count", "7", "--res", "11", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "edges.h5").code == 0
    assert meshonet("solve-pde", "edges.h5", "-o", "g.h5", "--quiet").code == 0
    given = [
        "train",
        "g.h5",
        "--epochs",
        "6",
        "--batch",
        str(batch),
        "--points",
        "60",
        "--set",
        "hidden=[16]",
    ]
    given += ["--set", "hidden=[16]", "--device", "cpu", "--model", "meshonet"]
    assert meshonet(*given, "-o", "one.safetensors", "--log-csv", "one.csv").code == 0
    team = [sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc-per-node", "2"]
    more = ["-m", "meshonet_cli", *given, "-o", "two.safetensors", "--log-csv", "two.csv", "--resume"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [*team, *more], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    np.testing.assert_allclose(losses("two.csv"), losses("one.csv"), rtol=2e-5)
    assert len(losses("two.csv")) == 6
    assert done.stderr.count("epoch 6/6") == 1, "one process speaks"
    assert not Path("two.safetensors.checkpoint").exists()
