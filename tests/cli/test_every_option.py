"""Every spelling of every option has an effect: a run with it differs from one without it where it should."""

import hashlib
import resource
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from command_line import Meshonet
from effects import EFFECTS, ELSEWHERE
from option_inputs import THERE, TORCH, write_inputs

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet_cli.app import application


def spellings() -> Iterator[tuple[str, str, str]]:
    """Command, option by the name that `EFFECTS` has for it, and each long spelling of it."""
    for name, command in application().commands.items():
        for option in command.params:
            long = [word for word in option.opts if word.startswith("--")]
            for word in (*long, *option.secondary_opts):
                known = word if word in option.secondary_opts else long[0]
                if (name, known) not in ELSEWHERE:
                    yield name, known, word


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the runs read."""
    folder = tmp_path_factory.mktemp("inputs")
    write_inputs(folder)
    return folder


@pytest.fixture(scope="module")
def runs() -> dict[tuple[str, str], dict[str, Any]]:
    """What runs without an option left behind, by command and words: many options are added to the same."""
    return {}


def observed(
    meshonet: Meshonet, command: str, words: list[str], inputs: Path, folder: Path
) -> dict[str, Any]:
    """What a run leaves behind."""
    for path in inputs.iterdir():
        if path.name in THERE:
            shutil.copy(path, folder)
        else:  # only read: a link is made ten times as fast as a copy
            (folder / path.name).hardlink_to(path)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = meshonet(command, *words)
    after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    appeared = sorted({path.name for path in folder.iterdir()} - {path.name for path in inputs.iterdir()})
    written = [folder / name for name in appeared] or [folder / name for name in THERE]
    written = [path for path in written if path.is_file()]
    content = b"".join(path.read_bytes() for path in written if path.suffix != ".h5")
    return {
        "code": done.code,
        "says": bool(done.err),
        "prints": bool(done.out),
        "out": done.out,
        "error": done.err,
        "files": appeared,
        "layout": [layout(path) for path in written],
        "bytes": hashlib.sha256(content).hexdigest(),
        "nodes": [nodes(path) for path in written if path.suffix == ".h5"],
        "weights": [weights(path) for path in written if path.suffix == ".safetensors"],
        "workers": after > before,
    }


def layout(path: Path) -> object:
    """How a file begins; of HDF5 the names of what is in it."""
    import h5py

    start = path.read_bytes()[:4]
    if start != b"\x89HDF":
        return start
    with h5py.File(path) as file:
        return sorted(file)


def nodes(path: Path) -> list[bytes]:
    """Coordinates of every grid or boundary of a file."""
    if layout(path) == b"mine":
        return []
    try:
        grids = list(read_grids(str(path)))
        return [b"".join(block.nodes.tobytes() for block in grid.blocks) for grid in grids]
    except ValueError:
        raise
    except Exception:  # a file of boundaries
        boundaries = [shape for shape in read_shapes(str(path)) if isinstance(shape, Boundary)]
        return [b"".join(getattr(each, side).tobytes() for side in ("south", "north")) for each in boundaries]


def weights(path: Path) -> dict[str, bytes]:
    """Arrays of a model."""
    from safetensors.numpy import load_file

    return {name: array.tobytes() for name, array in load_file(path).items()}


@pytest.mark.parametrize(("command", "known", "option"), list(spellings()))
def test_every_spelling_of_an_option_has_its_effect(
    meshonet: Meshonet,
    inputs: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    runs: dict[tuple[str, str], dict[str, Any]],
    command: str,
    known: str,
    option: str,
) -> None:
    assert known in EFFECTS.get(command, {}), f"say in EFFECTS what {command} {known} changes"
    base, more, differs = EFFECTS[command][known]
    if not TORCH and (".safetensors" in base or command == "train"):
        pytest.skip("needs torch")

    def run(name: str, words: list[str]) -> dict[str, Any]:
        folder = tmp_path / name
        folder.mkdir()
        monkeypatch.chdir(folder)
        return observed(meshonet, command, words, inputs, folder)

    if (command, base) not in runs:
        runs[command, base] = run("without", base.split())
    without = runs[command, base]
    with_it = run("with", [*base.split(), *more.replace("OPTION", option).split()])
    message = f"{command} {base} {more}: {without['error']} {with_it['error']}"
    assert with_it["code"] != 2 or differs in ("code", "error"), message
    assert with_it[differs] != without[differs], f"{differs} is the same: {message}"


def test_what_is_tested_elsewhere_is_there() -> None:
    tests = "".join(path.read_text() for path in Path(__file__).parent.glob("test_*.py"))
    missing = [
        name for name in ELSEWHERE.values() if name.startswith("test_") and f"def {name}(" not in tests
    ]
    assert not missing
