"""Files of quad models are untrusted input."""

import json
from pathlib import Path

import numpy as np
import pytest
from quad_models import BLOCKS, WIDTHS, random_model
from safetensors.numpy import load_file, save_file

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.model_file import HEADER, QUAD
from meshonet.solvers.neural.quad.operator import QuadOperator
from meshonet.solvers.neural.registry import load


def header(**changes: object) -> dict[str, str]:
    return {HEADER: json.dumps({"kind": QUAD.text, "encoding": QUAD.version, **changes})}


def copied(folder: Path, metadata: dict[str, str], **arrays: np.ndarray) -> Path:
    tensors = load_file(random_model(folder / "model.safetensors")) | arrays
    save_file(tensors, folder / "copy.safetensors", metadata=metadata)
    return folder / "copy.safetensors"


def test_a_copy_is_the_same_model(tmp_path: Path) -> None:
    result = load(copied(tmp_path, header()))
    assert isinstance(result, QuadOperator)
    assert (result.name, result.widths, result.blocks) == ("copy", WIDTHS, BLOCKS)
    assert result.network().heads == 2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "meshonet strip operator"}, "it holds 'meshonet strip operator', encoding 2"),
        ({"encoding": 1}, "encoding 1"),
    ],
)
def test_files_that_do_not_fit_are_refused(tmp_path: Path, changes: dict[str, object], message: str) -> None:
    path = copied(tmp_path, header(**changes))
    with pytest.raises(InputError, match=message) as caught:
        load(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"lift": np.full((1, 17), np.nan, np.float32)}, "not finite"),
        ({"lift": np.zeros((1, 16), np.float32)}, "do not fit \\(names or shapes"),
        ({"lift": np.zeros((), np.float32)}, "do not fit \\(widths"),
        ({"lift": np.zeros((1000, 17), np.float32)}, "do not fit \\(widths"),
        ({"down.2.weight": np.zeros((2, 2, 8, 3, 3), np.float32)}, "do not fit \\(names or shapes"),
        ({"more": np.zeros(1, np.float32)}, "do not fit \\(names or shapes"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(
    tmp_path: Path, arrays: dict[str, np.ndarray], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        load(copied(tmp_path, header(), **arrays))
