"""Model files are untrusted input."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save_file

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.model_file import HEADER, STRIP, read_tensors
from meshonet.solvers.neural.registry import described, load, model_path, shipped


def tensors() -> dict[str, np.ndarray]:
    return read_tensors(model_path("airfoil-o"))[1]


def header(**changes: object) -> dict[str, str]:
    facts = {
        "kind": STRIP.text,
        "encoding": STRIP.version,
        "name": "test",
        "topology": "o",
        "scale": 1.0,
        **changes,
    }
    return {HEADER: json.dumps(facts)}


def test_the_shipped_model_loads_and_describes_itself() -> None:
    assert "airfoil-o" in shipped()
    facts = described("airfoil-o")
    assert facts["topology"] == "o"
    assert facts["recipe"]["seed"] == 0
    assert facts["figures"]["network"]["median"] < 0.5 * facts["figures"]["base"]["median"]
    assert facts["parameters"] > 100_000


def test_a_copy_is_the_same_model(tmp_path: Path) -> None:
    save_file(tensors(), tmp_path / "copy.safetensors", metadata=header())
    assert load(str(tmp_path / "copy.safetensors")).name == "test"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not a safetensors file"),
        (b"\xff" * 100, "not a safetensors file"),
        (pickle.dumps({"weights": [1.0]}), "not a safetensors file"),
        ((2**60).to_bytes(8, "little") + b"{}", "not a safetensors file"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "model.safetensors"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        load(str(path))
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "something else"}, "it holds 'something else'"),
        ({"encoding": 999}, "encoding 999"),
        ({"encoding": "one"}, "encoding one"),
        ({"encoding": None}, "encoding None"),
        ({"scale": "nan"}, "do not fit"),
        ({"encoding": 1e400}, "encoding inf"),
    ],
)
def test_foreign_headers_are_refused(tmp_path: Path, changes: dict[str, object], message: str) -> None:
    save_file(tensors(), tmp_path / "m.safetensors", metadata=header(**changes))
    with pytest.raises(InputError, match=message):
        load(str(tmp_path / "m.safetensors"))


@pytest.mark.parametrize("name", sorted(tensors()))
def test_an_array_that_is_missing_or_of_another_shape_is_named(name: str, tmp_path: Path) -> None:
    without = {key: array for key, array in tensors().items() if key != name}
    save_file(without, tmp_path / "without.safetensors", metadata=header())
    with pytest.raises(InputError, match=r"lack|missing|in place of|do not fit"):
        load(str(tmp_path / "without.safetensors"))
    for k, array in enumerate((tensors()[name][..., None], tensors()[name].T[1:].T, tensors()[name].ravel())):
        if array.shape == tensors()[name].shape:
            continue
        odd = tensors() | {name: np.ascontiguousarray(array)}
        save_file(odd, tmp_path / f"{k}.safetensors", metadata=header())
        with pytest.raises(InputError, match=r"lack|missing|in place of|do not fit"):
            load(str(tmp_path / f"{k}.safetensors"))


def test_a_header_of_brackets_is_refused(tmp_path: Path) -> None:
    save_file(tensors(), tmp_path / "m.safetensors", metadata={HEADER: "[" * 5000})
    with pytest.raises(InputError, match="not a safetensors file"):
        load(str(tmp_path / "m.safetensors"))


def test_a_name_with_escapes_is_not_taken_over(tmp_path: Path) -> None:
    save_file(tensors(), tmp_path / "m.safetensors", metadata=header(name="\x1b[2J"))
    assert load(str(tmp_path / "m.safetensors")).name == "m"


def test_arrays_of_other_shapes_or_not_finite_are_refused(tmp_path: Path) -> None:
    odd = tensors() | {"basis": np.zeros((3, 3), np.float32)}
    save_file(odd, tmp_path / "odd.safetensors", metadata=header())
    with pytest.raises(InputError, match="do not fit"):
        load(str(tmp_path / "odd.safetensors"))
    bad = tensors()
    bad["lift.bias"] = np.full_like(bad["lift.bias"], np.nan)
    save_file(bad, tmp_path / "bad.safetensors", metadata=header())
    with pytest.raises(InputError, match=r"'lift.bias' is not finite"):
        load(str(tmp_path / "bad.safetensors"))
