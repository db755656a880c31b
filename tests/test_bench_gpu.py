"""The script that measures on a GPU, run on the CPU, where everything but its figures can be checked."""

import importlib
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from meshonet.formats.registry import read_grids

pytest.importorskip("torch")


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "benchmarks")
    return importlib.import_module("bench_gpu")


@pytest.fixture(params=["stood in for", pytest.param("itself", marks=pytest.mark.client("c++"))])
def compiler(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """torch's compiler, whose C++ compiler takes half a minute, or one that leaves steps as they are."""
    if request.param != "itself":
        monkeypatch.setattr("torch.compile", lambda step, **_: step)


@pytest.mark.usefixtures("compiler")
@pytest.mark.filterwarnings("ignore:.*")  # of torch, while it compiles
def test_it_measures_every_function_operator_and_model(script: ModuleType, tmp_path: Path) -> None:
    page = script.main(["--device", "cpu", "--quick", "--page", str(tmp_path / "gpu.md")])
    lines = [line for line in page.splitlines() if line[:3] == "| `"]
    rows = [[cell.strip() for cell in line.split("|")] for line in lines]
    layers, operators, training = rows[:14], rows[14:17], rows[17:]
    functions = ["quad-general", "winslow", "variational"]
    functions += ["quad-general", "winslow", "winslow, coarse=65", "variational, coarse=65"]
    assert [row[1] for row in layers] == [f"`{name}`" for name in functions for _ in range(2)]
    assert [row[3] for row in layers] == ["2", "4"] * 3 + ["1"] * 8
    assert all(float(row[4]) > 0 and row[7] == "yes" for row in layers)
    assert all(float(row[5]) > 0 for row in layers[:6])
    assert [row[1] for row in operators] == [f"`{name}`" for name in script.FAMILIES]
    assert all(float(row[4]) > 0 for row in operators)
    assert [row[1].strip("`") for row in training] == ["meshonet"] * 3 + ["fno2d"] * 2 + ["quad"] * 2
    ways = [["off", "off"], ["on", "off"], ["off", "on"]]
    assert [row[3:5] for row in training] == ways + ways[:2] * 2
    assert all(float(row[5]) > 0 and float(row[7]) > 0 for row in training), "amp and compile too"
    assert not any("TOO FAR" in line or script.LEFT_OUT in line for line in lines)
    assert (tmp_path / "gpu.md").read_text(encoding="utf-8") == page


def test_what_does_not_fit_into_the_time_is_left_out(script: ModuleType) -> None:
    extent = replace(script.QUICK, limit=0.0, trainings=replace(script.QUICK.trainings, shapes=2))
    left = script.Time(0.0)
    rows = [*script.layer_rows("cpu", extent, left), *script.operator_rows("cpu", extent, left)]
    assert sum("left out" in row for row in rows) == len(rows) - 4 == 17


def test_the_trainings_of_a_gpu_are_those_that_the_models_take(script: ModuleType, tmp_path: Path) -> None:
    """The quad operator takes grids of 33 x 33 nodes only, whatever the others are trained on."""
    files = importlib.import_module("device_training").datasets(tmp_path, 6, 41)
    sizes = [[next(iter(read_grids(file))).ni for file in files[name]] for name in ("meshonet", "quad")]
    assert sizes == [[41], [33, 33]]


def test_without_a_gpu_the_page_says_so(script: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(script.torch.cuda, "is_available", lambda: False)
    assert script.main([]).startswith(f"{script.TITLE}\n{script.NONE}\n")
