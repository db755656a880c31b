"""The script that measures on a GPU, run on the CPU, where everything but its figures can be checked."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

pytest.importorskip("torch")


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    path = Path(__file__).parents[1] / "benchmarks" / "bench_gpu.py"
    spec = importlib.util.spec_from_file_location("bench_gpu", path)
    assert spec is not None
    assert spec.loader is not None
    monkeypatch.syspath_prepend(path.parent)  # where what scripts share is
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_it_measures_every_operator_and_model(script: ModuleType, tmp_path: Path) -> None:
    page = script.main(["--device", "cpu", "--quick", "--page", str(tmp_path / "gpu.md")])
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    layers = ["quad-general", "winslow", "variational", "quad-general", "winslow"]
    names = [re.findall(r"`([^`]+)`", row)[0] for row in rows]
    assert names == [*script.FAMILIES, *layers, *script.TRAINED]
    assert all(float(row.split("|")[4]) > 0 for row in rows[:8])
    assert all(row.split("|")[7].strip() == "yes" for row in rows[3:8])
    assert all(float(row.split("|")[5]) > 0 for row in rows[8:])
    assert "TOO FAR" not in page
    assert (tmp_path / "gpu.md").read_text(encoding="utf-8") == page


def test_without_a_gpu_the_page_says_so(script: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(script.torch.cuda, "is_available", lambda: False)
    assert script.main([]).endswith(f"{script.NONE}\n")
