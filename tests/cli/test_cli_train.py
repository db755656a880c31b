"""`meshonet train`: what it refuses, and with torch a run of seconds that is cut and goes on."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from conftest import Meshonet

TORCH = importlib.util.find_spec("torch") is not None
SMALL = ("--epochs", "2", "--batch", "4", "--held-out", "4", "--rate", "0.001", "--threads", "1")


@pytest.fixture
def strips_h5(meshonet: Meshonet) -> str:
    """Twelve random airfoils."""
    words = ("--family", "procedural", "--count", "12", "--seed", "3", "--res", "129x5")
    assert meshonet("sample-boundary", *words, "-o", "strips.h5", "--quiet").code == 0
    return "strips.h5"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("-o", "model.pt"), "model.pt: a model file ends in .safetensors; rename the output"),
        (("-o", "nowhere/m.safetensors"), "no folder nowhere; make it first"),
        (("-o", "m.safetensors", "--epochs", "0"), "epochs"),
        (("-o", "m.safetensors", "--batch", "0"), "batch"),
        (("-o", "m.safetensors", "--held-out", "0"), "held-out"),
        (("-o", "m.safetensors", "--checkpoint-every", "0"), "checkpoint-every"),
        (("-o", "m.safetensors", "--threads", "0"), "threads"),
    ],
)
def test_mistakes_get_a_line(meshonet: Meshonet, words: tuple[str, ...], told: str) -> None:
    done = meshonet("train", "strips.h5", *words)
    assert done.code == 2
    assert told in done.err
    assert done.err.count("\n") == 1


@pytest.mark.skipif(TORCH, reason="torch is here")
def test_without_torch_it_says_what_to_install(meshonet: Meshonet) -> None:
    done = meshonet("train", "strips.h5", "-o", "m.safetensors")
    assert done.code == 2
    assert done.err == "error: training needs torch; install it: pip install 'meshonet[train]'\n"


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_the_same_seed_gives_the_same_model_cut_or_not(meshonet: Meshonet, strips_h5: str) -> None:
    told = meshonet("train", strips_h5, "-o", "one.safetensors", *SMALL, "--seed", "5", "--json").only
    assert (told["output"], told["shapes"]) == ("one.safetensors", 12)
    assert told["figures"]["network"]["median"] > 0
    meshonet("train", strips_h5, "-o", "two.safetensors", *SMALL, "--seed", "5", "--quiet")
    meshonet("train", strips_h5, "-o", "other.safetensors", *SMALL, "--seed", "6", "--quiet")
    models = [arrays(f"{name}.safetensors") for name in ("one", "two", "other")]
    assert all(np.array_equal(models[0][key], models[1][key]) for key in models[0])
    assert not all(np.array_equal(models[0][key], models[2][key]) for key in models[0])


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_the_log_has_a_line_an_epoch(meshonet: Meshonet, strips_h5: str) -> None:
    words = ("--log-csv", "train.csv", "--checkpoint-every", "1", "--resume")
    done = meshonet("train", strips_h5, "-o", "one.safetensors", *SMALL, *words)
    assert done.code == 0
    assert "epoch 2/2" in done.err
    rows = Path("train.csv").read_text().splitlines()
    assert rows[0].startswith("epoch,")
    assert len(rows) == 3


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_a_trained_model_makes_grids(meshonet: Meshonet, strips_h5: str) -> None:
    meshonet("train", strips_h5, "-o", "mine.safetensors", *SMALL, "--quiet")
    words = ("--model", "mine.safetensors", "--res", "80x40", "-o", "g.vts", "--json")
    told = meshonet("infer", "naca:2412", *words).only
    assert (told["folded"], told["model"]) == (0, "mine")


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_too_few_shapes_are_refused(meshonet: Meshonet, strips_h5: str) -> None:
    done = meshonet("train", strips_h5, "-o", "m.safetensors", "--held-out", "20")
    assert done.code == 2
    assert done.err.splitlines()[-1].startswith("error: ")


def arrays(path: str) -> dict[str, np.ndarray]:
    from safetensors.numpy import load_file

    return dict(load_file(path))
