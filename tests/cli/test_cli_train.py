"""`meshonet train`: what it refuses, and with torch a run of seconds that is cut and goes on."""

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Meshonet

TORCH = importlib.util.find_spec("torch") is not None
SMALL = ("--epochs", "2", "--batch", "4", "--held-out", "4", "--rate", "0.001", "--threads", "1")


@pytest.fixture
def strips_h5(meshonet: Meshonet) -> str:
    """Twelve random airfoils."""
    words = ("--family", "procedural", "--count", "12", "--seed", "3", "--res", "129x5")
    assert meshonet("sample-boundary", *words, "-o", "strips.h5", "--quiet").code == 0
    return "strips.h5"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("-o", "model.pt"), "model.pt: a model file ends in .safetensors; rename the output"),
        (("-o", "nowhere/m.safetensors"), "no folder nowhere; make it first"),
        (("-o", "m.safetensors", "--epochs", "0"), "epochs"),
        (("-o", "m.safetensors", "--batch", "0"), "batch"),
        (("-o", "m.safetensors", "--held-out", "-1"), "held-out"),
        (("-o", "m.safetensors", "--checkpoint-every", "0"), "checkpoint-every"),
        (("-o", "m.safetensors", "--threads", "0"), "threads"),
        (("-o", "m.safetensors", "--patience", "0"), "patience"),
        (("-o", "m.safetensors", "--schedule", "linear"), "schedule"),
        (("-o", "m.safetensors", "--device", "tpu"), "device"),
    ],
)
def test_mistakes_get_a_line(meshonet: Meshonet, words: tuple[str, ...], message: str) -> None:
    done = meshonet("train", "strips.h5", *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_without_torch_it_says_what_to_install(meshonet: Meshonet, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    done = meshonet("train", "strips.h5", "-o", "m.safetensors")
    assert done.code == 2
    assert done.err.startswith("error: training needs torch; install it: pip install 'meshonet[train]'")
    assert "without a GPU install PyTorch's CPU wheel first" in done.err
    assert done.err.count("\n") == 1


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_the_same_seed_gives_the_same_model_cut_or_not(meshonet: Meshonet, strips_h5: str) -> None:
    report = meshonet("train", strips_h5, "-o", "one.safetensors", *SMALL, "--seed", "5", "--json").only
    assert (report["output"], report["shapes"]) == ("one.safetensors", 12)
    assert report["figures"]["network"]["median"] > 0
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
    assert "epoch 2/2: loss " in done.err
    rows = Path("train.csv").read_text().splitlines()
    assert rows[0].startswith("epoch,")
    assert len(rows) == 3


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_a_trained_model_makes_grids(meshonet: Meshonet, strips_h5: str) -> None:
    meshonet("train", strips_h5, "-o", "mine.safetensors", *SMALL, "--quiet")
    words = ("--model", "mine.safetensors", "--res", "80x40", "-o", "g.vts", "--json")
    report = meshonet("infer", "naca:2412", *words).only
    assert (report["folded"], report["model"]) == (0, "mine")


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_too_few_shapes_are_refused(meshonet: Meshonet, strips_h5: str) -> None:
    done = meshonet("train", strips_h5, "-o", "m.safetensors", "--held-out", "20")
    assert done.code == 2
    assert done.err.splitlines()[-1].startswith("error: ")


@pytest.fixture
def arches_h5(meshonet: Meshonet) -> str:
    """Eight solved arches, split."""
    words = ("--family", "arch", "--count", "8", "--res", "17", "--split", "interpolation", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "edges.h5").code == 0
    assert meshonet("solve-pde", "edges.h5", "-o", "arches.h5", "--quiet").code == 0
    return "arches.h5"


BRIEF = ("--epochs", "4", "--points", "60", "--batch", "4")


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_from_a_family_to_an_error(meshonet: Meshonet, arches_h5: str) -> None:
    words = ("--model", "meshonet-hard", *BRIEF, "--set", "sensors=20", "--set", "hidden=[16]")
    report = meshonet("train", arches_h5, "-o", "m.safetensors", *words, "--json").only
    assert (report["model"], report["shapes"]) == ("meshonet-hard", 8)
    assert (report["figures"]["train"]["grids"], report["figures"]["test"]["grids"]) == (7, 1)
    assert report["figures"]["test"]["boundary"] <= 1e-12
    answer = (
        "infer",
        "edges.h5#test",
        "--model",
        "m.safetensors",
        "--answer",
        "raw",
        "-o",
        "own.h5",
        "--json",
    )
    made = meshonet(*answer).only
    assert (made["method"], made["model"]) == ("operator", "m")
    graded = meshonet("quality", "own.h5", "--compare", "arches.h5#test", "--json").only
    assert graded["compare"]["relative_l2"] == pytest.approx(report["figures"]["test"]["median"], rel=1e-5)


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_compile_goes_through_the_compiler(
    meshonet: Meshonet, arches_h5: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    compiled = []

    def compiler(step: object, **_: object) -> object:
        compiled.append(step)
        return step

    monkeypatch.setattr(torch, "compile", compiler)
    words = ("train", arches_h5, *BRIEF, "--quiet")
    assert meshonet(*words, "-o", "plain.safetensors").code == 0
    assert compiled == []
    assert meshonet(*words, "--compile", "-o", "compiled.safetensors").code == 0
    assert compiled
    plain, same = arrays("plain.safetensors"), arrays("compiled.safetensors")
    assert all(np.array_equal(plain[key], same[key]) for key in plain)


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_without_a_compiler_compile_is_refused(
    meshonet: Meshonet, arches_h5: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """torch's compiler says so at the first step, by an error of its own."""
    import torch
    from torch._inductor.exc import InvalidCxxCompiler

    def compiler(_: object, **__: object) -> object:
        def step(*_: object) -> object:
            raise InvalidCxxCompiler

        return step

    monkeypatch.setattr(torch, "compile", compiler)
    done = meshonet("train", arches_h5, *BRIEF, "--compile", "-o", "m.safetensors")
    assert done.code == 2
    assert "--compile: torch.compile cannot (No working C++ compiler found" in done.err.splitlines()[-1]
    assert "leave it out, or install a C++ compiler" in done.err.splitlines()[-1]
    assert not Path("m.safetensors").exists()


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_a_model_of_one_family_is_not_for_another_topology(meshonet: Meshonet, arches_h5: str) -> None:
    meshonet("train", arches_h5, "-o", "m.safetensors", *BRIEF, "--quiet")
    done = meshonet("infer", "naca:2412", "--model", "m.safetensors", "-o", "g.vts")
    assert done.code == 2
    assert "model m makes quad grids, and this boundary is o; use another model" in done.err
    assert not Path("g.vts").exists()


@pytest.mark.skipif(not TORCH, reason="needs torch")
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--model", "perceptron"), "model 'perceptron' is not known; use one of strip, quad, meshonet"),
        (("--split", "halves"), "--split: 'halves' is neither a way to split nor a file"),
        (
            ("--split", "words.txt"),
            "--split: words.txt has 2 words for 8 grids; write train or test for each",
        ),
        (("--points", "few"), "--points: 'few' is not a number of points; use all or e.g. 1200"),
        (("--set", "sensors"), "--set: 'sensors' is not NAME=VALUE"),
        (("--set", "colour=1"), "meshonet has no setting 'colour'; use one of sensors"),
        (("--rate", "7"), "--rate: 7 is no learning rate"),
        (("--patience", "3"), "--patience: stopping early needs shapes held out; use --held-out"),
        (("--held-out", "9"), "grids to train on; give at least 2, or hold fewer out"),
        (("--model", "strip"), "the strip operator takes no --split or --points; leave them out"),
        (("--model", "strip", "--set", "folds=3"), "the strip operator takes no --set; leave it out"),
    ],
)
def test_mistakes_about_grids_get_a_line(
    meshonet: Meshonet, arches_h5: str, words: tuple[str, ...], message: str
) -> None:
    Path("words.txt").write_text("train test")
    done = meshonet("train", arches_h5, "-o", "m.safetensors", *BRIEF, *words)
    assert done.code == 2
    assert message in done.err.splitlines()[-1]
    assert not Path("m.safetensors").exists()


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_boundaries_are_not_grids(meshonet: Meshonet, arches_h5: str) -> None:
    done = meshonet("train", "edges.h5", "--model", "meshonet", "-o", "m.safetensors")
    assert done.code == 2
    assert "holds boundaries, not grids; make grids of them first: meshonet solve-pde" in done.err


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_the_log_of_a_resumed_run_is_that_of_a_whole_one(meshonet: Meshonet, arches_h5: str) -> None:
    words = ("train", arches_h5, *BRIEF, "--checkpoint-every", "1", "--held-out", "1", "--schedule", "cosine")
    meshonet(*words, "-o", "a.safetensors", "--log-csv", "a.csv")
    rows = Path("a.csv").read_text().splitlines()
    assert rows[0] == "epoch,seen,loss,interior,boundary,held_out_loss,held_out_mean_square,rate,seconds"
    Path("b.csv").write_text("\n".join([*rows, "5,1,1,1,1,1,1,1,1"]) + "\n")
    meshonet(*words, "-o", "b.safetensors", "--log-csv", "b.csv", "--resume", "--amp", "--device", "cpu")
    assert [row.split(",")[0] for row in Path("b.csv").read_text().splitlines()] == ["epoch", *"1234"]


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_a_cut_run_goes_on_from_its_checkpoint(
    meshonet: Meshonet, arches_h5: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from meshonet_cli.report.training import Log

    words = ("train", arches_h5, *BRIEF, "--checkpoint-every", "2", "-o", "m.safetensors")
    assert meshonet(*words, "--quiet").code == 0
    whole = arrays("m.safetensors")
    Path("m.safetensors").unlink()
    report, record = Log.__call__, []

    def cut(log: Log, progress: Any) -> None:
        record.append(progress.epoch)
        if progress.epoch == 3 and record.count(3) == 1:
            raise KeyboardInterrupt
        report(log, progress)

    monkeypatch.setattr(Log, "__call__", cut)
    assert meshonet(*words).code == 130
    assert not Path("m.safetensors").exists()
    assert meshonet(*words, "--resume").code == 0
    assert record == [1, 2, 3, 3, 4]
    assert all(np.array_equal(array, whole[name]) for name, array in arrays("m.safetensors").items())


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_patience_ends_a_run(meshonet: Meshonet, arches_h5: str) -> None:
    words = ("train", arches_h5, *BRIEF, "--epochs", "60", "--held-out", "2", "--rate", "0.5")
    done = meshonet(*words, "--patience", "1", "--log-csv", "log.csv", "-o", "m.safetensors")
    assert done.code == 0
    assert len(Path("log.csv").read_text().splitlines()) < 61


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_threads_are_those_of_torch(meshonet: Meshonet, arches_h5: str) -> None:
    import torch

    for count in (2, 1):
        words = ("train", arches_h5, *BRIEF, "--epochs", "1", "--threads", count, "-o", "m.safetensors")
        assert meshonet(*words, "--quiet").code == 0
        assert torch.get_num_threads() == count


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_the_device_is_that_of_torch(meshonet: Meshonet, arches_h5: str) -> None:
    import torch

    words = ("train", arches_h5, *BRIEF, "-o", "m.safetensors", "--device")
    assert meshonet(*words, "cpu", "--quiet").code == 0
    done = meshonet(*words, "cuda")
    assert done.code == (0 if torch.cuda.is_available() else 2), done.err


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_amp_multiplies_in_bfloat16(
    meshonet: Meshonet, arches_h5: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    kinds, autocast = [], torch.autocast

    def noted(*words: object, **settings: Any) -> object:
        kinds.append((torch.bfloat16 in words, settings.get("enabled", True)))
        return autocast(*words, **settings)

    monkeypatch.setattr(torch, "autocast", noted)
    words = ("train", arches_h5, *BRIEF, "-o", "m.safetensors", "--quiet")
    assert meshonet(*words).code == 0
    assert (True, True) not in kinds
    assert meshonet(*words, "--amp").code == 0
    assert (True, True) in kinds


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_an_empty_dataset_is_refused(meshonet: Meshonet, arches_h5: str) -> None:
    import h5py

    with h5py.File(arches_h5) as full, h5py.File("empty.h5", "w") as empty:
        empty.attrs.update(full.attrs)
        for side in ("south", "north", "west", "east", "nodes"):
            empty[side] = full[side][:0]
    for words in ((), ("--model", "meshonet"), ("--model", "quad")):
        done = meshonet("train", "empty.h5", *words, "-o", "m.safetensors")
        assert done.code == 2
        assert "internal error" not in done.err
        assert done.err.count("\n") == 1, done.err


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_datasets_of_one_method_are_trained_on_together(meshonet: Meshonet) -> None:
    for name, seed in (("a", 1), ("b", 2)):
        words = ("--family", "four-sided", "--count", "8", "--seed", seed, "--res", "33", "--quiet")
        assert meshonet("sample-boundary", *words, "-o", f"{name}.h5").code == 0
        for method in ("winslow", "variational"):
            words = ("--method", method, "--max-cycles", "20", "--allow-invalid", "-q")
            assert meshonet("solve-pde", f"{name}.h5", *words, "-o", f"{name}-{method}.h5").code == 0
    datasets = [f"{name}-{method}.h5" for name in "ab" for method in ("winslow", "variational")]
    words = ("--model", "quad", "--epochs", "1", "--held-out", "4", "--batch", "4", "-o", "q.safetensors")
    assert meshonet("train", *datasets, *words, "--json").only["shapes"] == 16


@pytest.mark.skipif(not TORCH, reason="needs torch")
def test_a_split_file_decides(meshonet: Meshonet, arches_h5: str) -> None:
    Path("words.txt").write_text("test train " * 4)
    report = meshonet(
        "train", arches_h5, "-o", "m.safetensors", *BRIEF, "--split", "words.txt", "--json"
    ).only
    assert report["figures"]["test"]["grids"] == 4


def arrays(path: str) -> dict[str, np.ndarray]:
    from safetensors.numpy import load_file

    return dict(load_file(path))


def test_the_quad_operator_learns_from_grids_by_both_methods(meshonet: Meshonet) -> None:
    words = ("--family", "four-sided", "--count", "24", "--res", "33", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "b.h5").code == 0
    for method in ("winslow", "variational"):
        words = ("solve-pde", "b.h5", "--method", method, "--allow-invalid", "-q", "-o", f"{method}.h5")
        assert meshonet(*words).code == 0
    words = ("--model", "quad", "--epochs", "1", "--held-out", "4", "--batch", "8", "--set", "folds=3")
    words += ("-o", "q.safetensors")
    done = meshonet("train", "winslow.h5", "variational.h5", *words)
    assert done.code == 0, done.err
    assert "24 domains solved by both methods" in done.err
    assert "held-out distance to winslow grids" in done.err
    assert Path("q.safetensors").stat().st_size > 10_000
    refused = meshonet("train", "winslow.h5", "--model", "quad", "-o", "r.safetensors")
    assert refused.code == 2
    assert "grids by winslow for the quad operator; give grids of the same boundaries" in refused.err
    assert not Path("r.safetensors").exists()


def test_the_quad_operator_learns_around_bodies_from_a_model_that_is_there(meshonet: Meshonet) -> None:
    words = ("--family", "bodies", "--count", "10", "--res", "65x33", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "b.h5").code == 0
    for method, source in (("winslow", "b.h5"), ("variational", "winslow.h5")):
        words = ("solve-pde", source, "--method", method, "--max-cycles", "20", "--allow-invalid", "-q")
        meshonet(*words, "-o", f"{method}.h5")
    words = ("--model", "quad", "--epochs", "1", "--held-out", "2", "--batch", "4", "-o", "o.safetensors")
    done = meshonet("train", "winslow.h5", "variational.h5", *words, "--initial", "quad-general", "--json")
    assert done.code == 0, done.err
    assert done.only["shapes"] == 10
    grids = meshonet("infer", "b.h5", "--model", "o.safetensors", "-o", "g.h5", "--json").objects
    assert [(grid["topology"], grid["model"]) for grid in grids] == 10 * [("o", "o")]
    refused = meshonet("train", "b.h5", "--model", "strip", "--initial", "airfoil-o", "-o", "r.safetensors")
    assert refused.code == 2
    assert "--initial is of no use to strip; leave it out, or use --model quad" in refused.err
