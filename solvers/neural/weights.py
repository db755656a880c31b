"""Model files: safetensors with a header that says what the model is, checked before anything is used."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.strip import LEVELS, smoothing
from meshonet.solvers.neural.encoding import CHANNELS, SCALARS, VERSION, decode, encode
from meshonet.solvers.neural.network import Reals, StripNetwork, misfit

DEFAULT = "airfoil-o"
FOLDER = Path(__file__).parent / "pretrained"
KIND = "meshonet strip operator"
HEADER = "meshonet"  # the metadata entry that holds the header as JSON
LARGEST = 64 * 1024 * 1024  # bytes; a file above this is not one of ours


@dataclass(frozen=True)
class Model:
    """A trained strip operator.

    `network` answers for a strip in the unit size that `encode` gives it, by its `weights`. `basis`
    (Q, LEVELS - 2) and `scale` are those of its targets; `header` is what the file says of itself: recipe and
    held-out figures.
    """

    name: str
    network: StripNetwork
    weights: Mapping[str, Reals]
    basis: Floats
    scale: float
    header: Mapping[str, Any]

    def residual(self, wall: Complexes, far: Complexes, hand: NDArray[np.intp] | None = None) -> Complexes:
        """Return modes (batch, 2 MODES + 1, LEVELS) of Winslow - harmonic for modes (batch, 2 MODES + 1).

        `hand` (batch,) is that of `meshonet.geometry.polygon.mirror.handedness`: of a strip and its mirror image, whose modes
        are conjugate, the network sees the same one, and the answer for a symmetric strip is made symmetric.
        Modes that Picard's steps would not correct are left out.
        """
        flip = np.zeros((len(wall), 1), bool) if hand is None else hand[:, None] < 0
        channels, scalars, size = encode(np.where(flip, wall.conj(), wall), np.where(flip, far.conj(), far))
        answer = decode(self.network(channels, scalars).astype(np.float64), self.basis, self.scale, size)
        answer.imag[flip[:, 0]] *= -1.0
        if hand is not None:
            answer.imag[hand == 0] = 0.0
        return answer * smoothing()[:, None]


SECOND = {"quad-winslow": "quad-general", "hole-winslow": "hole-o"}
"""Models that are another answer of a network, by the name of its file."""


NEVER = {"airfoil-c": "leave --model out: --topology c is marched from wall and wake, better than by a model"}
"""Models that one may look for and that are not made, and what serves instead."""


def shipped() -> tuple[str, ...]:
    """Return the names of the models in the package."""
    files = {path.stem for path in FOLDER.glob("*.safetensors")}
    return tuple(sorted(files | {name for name, file in SECOND.items() if file in files}))


def model_path(name: str | None) -> Path:
    """Return the file of a shipped model's name, of a path, or of the default."""
    name = name or DEFAULT
    if name in shipped():
        return FOLDER / f"{SECOND.get(name, name)}.safetensors"
    path = Path(name)
    if path.is_file():
        return path
    if name in NEVER:
        raise InputError(f"there is no model {name!r}", NEVER[name])
    raise InputError(f"no model {name!r}", "use a .safetensors file or one of: base, " + ", ".join(shipped()))


def load_model(name: str | None = None) -> Model:
    """Return a shipped model by name, a model by path, or the default.

    Raises
    ------
    InputError
        no such model; a file that is not safetensors, not one of ours or of another version.
    """
    return _load(str(model_path(name)))


@lru_cache(maxsize=4)
def _load(path: str) -> Model:
    header, tensors = read_tensors(Path(path))
    try:
        if header["kind"] != KIND or int(header["encoding"]) != VERSION:
            raise InputError(
                f"it holds {str(header['kind'])[:60]!r}, encoding {str(header['encoding'])[:20]}",
                f"use a model of encoding {VERSION} or train one",
                source=path,
            )
        basis = tensors.pop("basis").astype(np.float64)
        scale = float(header["scale"])
        inputs = tensors["lift.weight"].shape[1]
        outputs = tensors["project.weight"].shape[0]
    except (KeyError, IndexError, ValueError, TypeError, OverflowError) as error:
        raise InputError(
            f"its header or arrays lack {error}", "use a file made by meshonet train", source=path
        ) from None
    if basis.shape != (outputs // 2, LEVELS - 2) or inputs != CHANNELS + SCALARS or not np.isfinite(scale):
        raise InputError("its arrays do not fit this version's network", "train it again", source=path)
    weights: dict[str, Reals] = {name: array.astype(np.float64) for name, array in tensors.items()}
    problem = misfit(weights)
    if problem:
        raise InputError(problem, "use a file made by meshonet train", source=path)
    name = header.get("name")
    called = name if isinstance(name, str) and name.isprintable() else Path(path).stem
    return Model(called, StripNetwork(weights), weights, basis, scale, header)


def kind_of(path: Path) -> str:
    """Return what the header of a model file says it is; nothing when it says nothing or cannot be read."""
    try:
        with path.open("rb") as file:
            length = int.from_bytes(file.read(8), "little")
            head = json.loads(file.read(min(length, LARGEST)))
        return str(json.loads(head["__metadata__"][HEADER])["kind"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ""


def read_tensors(path: Path) -> tuple[dict[str, Any], dict[str, Floats]]:
    """Return the header and the arrays of a model file, size and finiteness checked."""
    from safetensors import SafetensorError, safe_open

    if path.stat().st_size > LARGEST:
        raise InputError(
            f"it is larger than {LARGEST >> 20} MiB", "use a file made by meshonet train", source=str(path)
        )
    try:
        with safe_open(path, framework="numpy") as file:
            header = json.loads((file.metadata() or {}).get(HEADER, "{}"))
            tensors = {key: file.get_tensor(key) for key in file.keys()}  # noqa: SIM118 - not a mapping
    except (SafetensorError, OSError, ValueError, TypeError, RecursionError) as error:
        raise InputError(
            f"not a safetensors file ({error})", "use a file made by meshonet train", source=str(path)
        ) from None
    if not isinstance(header, dict):
        raise InputError("its header is not an object", "use a file made by meshonet train", source=str(path))
    for key, array in tensors.items():
        if not np.issubdtype(array.dtype, np.floating) or not np.isfinite(array).all():
            raise InputError(
                f"array {key!r} is not finite floating point", "train it again", source=str(path)
            )
    return header, tensors


def write_tensors(path: Path, arrays: Mapping[str, Floats], header: Mapping[str, Any]) -> None:
    """Write a model file that `read_tensors` reads, whole or not at all; each array in its own precision."""
    from safetensors.numpy import save

    # safetensors takes an array's memory as it lies: C order, or it comes back scrambled
    tensors = {key: np.ascontiguousarray(value) for key, value in arrays.items()}
    part = path.with_name(path.name + ".part")
    # one entry: safetensors writes several in an order that changes from run to run
    part.write_bytes(save(tensors, metadata={HEADER: json.dumps(header, sort_keys=True)}))
    part.replace(path)


def described(name: str) -> dict[str, Any]:
    """Return what a shipped model says of itself: name, topology, recipe, figures, file."""
    path = model_path(name)
    header, tensors = read_tensors(path)
    told = ("name", "topology", "recipe", "figures")
    facts: dict[str, Any] = {key: header[key] for key in told if key in header} | {"name": name}
    facts["parameters"] = int(sum(array.size for array in tensors.values()))
    facts["file"] = str(path)
    return facts
