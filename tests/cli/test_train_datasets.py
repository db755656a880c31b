"""Datasets of one method add up, and one without grids is refused with a remedy."""

from pathlib import Path

import h5py
import pytest
from command_line import Meshonet

pytest.importorskip("torch")


def solved(meshonet: Meshonet, family: str, seed: int) -> list[str]:
    """Return a dataset of Winslow's grids and one of variational grids."""
    words = ("--family", family, "--count", "4", "--res", "33", "--seed", seed, "--quiet")
    assert meshonet("sample-boundary", *words, "-o", f"b{seed}.h5").code == 0
    files = [f"{method}{seed}.h5" for method in ("winslow", "variational")]
    for method, file in zip(("winslow", "variational"), files, strict=True):
        words = ("--method", method, "--allow-invalid", "-q", "-o", file)
        assert meshonet("solve-pde", f"b{seed}.h5", *words).code == 0
    return files


def test_two_datasets_of_one_method_are_both_trained_on(meshonet: Meshonet) -> None:
    files = [file for seed in (1, 2) for file in solved(meshonet, "four-sided", seed)]
    words = ("--model", "quad", "--epochs", "1", "--held-out", "2", "--batch", "2", "--json")
    done = meshonet("train", *files, *words, "-o", "q.safetensors")
    assert done.code == 0, done.err
    assert done.only["shapes"] == 8


def test_a_dataset_without_grids_is_refused(meshonet: Meshonet) -> None:
    solved(meshonet, "four-sided", 1)
    with h5py.File("winslow1.h5", "r+") as file:
        for name in list(file):
            data, attributes = file[name][:0], dict(file[name].attrs)
            shape = data.shape
            del file[name]
            made = file.create_dataset(name, data=data, maxshape=(None, *shape[1:]))
            made.attrs.update(attributes)
    done = meshonet("train", "winslow1.h5", "--model", "quad", "-o", "q.safetensors")
    assert done.code == 2
    assert "internal error" not in done.err
    assert not Path("q.safetensors").exists()


def test_the_help_names_every_model_that_can_be_trained(meshonet: Meshonet) -> None:
    from meshonet.solvers.neural.models.architectures import MODELS

    text = " ".join(meshonet("train", "--help").out.replace("│", " ").split())
    text = text.replace("- ", "-")  # lines end at hyphens too
    assert all(name in text for name in MODELS)
