"""The trained models, shipped or in files; `load` returns one."""

import dataclasses
from functools import lru_cache
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError, meant
from meshonet.solvers.neural.model_file import OURS, PAPER, QUAD, STRIP, VOLUME, Kind, read_model
from meshonet.solvers.neural.operator import Operator

FOLDER = Path(__file__).parent / "pretrained"  # of the shipped files

BASE = "base"  # the harmonic base with no network, where a strip operator can be named
DEFAULTS: dict[Topology, str] = {"o": "airfoil-o", "quad": "quad-general"}  # where none is named

HEADS = {"quad-winslow": ("quad-general", 0), "hole-winslow": ("hole-o", 0)}
"""Models that are a further output of a network: the name of its file, and the index of the output."""

NEVER = {"airfoil-c": "leave {model} out: {topology} c is marched from wall and wake, better than by a model"}
"""Models that do not exist but users may expect, with the remedy in the error message."""

OPERATORS: dict[Kind, str] = {
    STRIP: "meshonet.solvers.neural.strip.operator:StripOperator",
    QUAD: "meshonet.solvers.neural.quad.operator:QuadOperator",
    PAPER: "meshonet.solvers.neural.models.operator:PaperOperator",
}
"""Class of each kind of file."""


def shipped() -> tuple[str, ...]:
    """Return the names of the models that the package contains."""
    files = {path.stem for path in FOLDER.glob("*.safetensors")}
    return tuple(sorted(files | {name for name, (file, _) in HEADS.items() if file in files}))


def model_path(name: str) -> Path:
    """Return the file of the model with this name or path. Raises InputError if there is none."""
    if name in shipped():
        return FOLDER / f"{HEADS.get(name, (name, 0))[0]}.safetensors"
    path = Path(name)
    if path.is_file():
        return path
    if name in NEVER:
        raise InputError(f"there is no model {name!r}", NEVER[name])
    known = (BASE, *shipped())
    remedy = f"{meant(name, known)}use a .safetensors file or one of: {', '.join(known)}"
    raise InputError(f"no model {name!r}", remedy)


def load(name: str | Path) -> Operator:
    """Return the operator of a shipped model by name, or of a model file by path.

    The name ``base`` gives the solver of Winslow's equations around airfoils, without a network. Raises
    InputError for unknown names and wrong files.

    >>> operator = load("quad-general")
    >>> operator.name, operator.topology
    ('quad-general', 'quad')
    """
    name = str(name)
    if name == BASE:
        from meshonet.solvers.neural.strip.operator import StripOperator

        return StripOperator(BASE, "o", {})
    path = model_path(name)
    operator = _load(path, path.stat().st_mtime_ns)
    if name in shipped():
        head: dict[str, Any] = {"head": HEADS[name][1]} if name in HEADS else {}
        operator = dataclasses.replace(operator, name=name, **head)
    return operator


def makes_volumes(name: str) -> bool:
    """Return whether a model is for volumes inside six faces (`meshonet.solvers.neural.volumes`).

    Raises InputError if there is no such model, or if the file is no model file.
    """
    return name not in (BASE, *shipped()) and read_model(model_path(name))[0] == VOLUME


@lru_cache(maxsize=4)
def _load(path: Path, _modified: int) -> Operator:
    kind, header, arrays = read_model(path)
    own = header.get("name")
    name = own if isinstance(own, str) and own.isprintable() else path.stem
    if kind == VOLUME:
        remedy = "give six faces, or use another {model}"
        raise InputError("this model makes volumes only", remedy, source=str(path))
    cls: type[Operator] = resolve_name(OPERATORS[kind])
    try:
        return cls.of_file(name, header, arrays)
    except InputError as error:
        error.source = str(path)
        raise
    except (KeyError, IndexError, ValueError, TypeError, AttributeError, OverflowError) as error:
        raise InputError(f"its header or arrays do not fit ({error})", OURS, source=str(path)) from None


def described(name: str) -> dict[str, Any]:
    """Return name, topology, training settings, errors, parameter count and file of a shipped model."""
    path = model_path(name)
    _, header, arrays = read_model(path)
    facts: dict[str, Any] = {key: header[key] for key in ("topology", "recipe", "figures") if key in header}
    parameters = int(sum(array.size for array in arrays.values()))
    return {"name": name, **facts, "parameters": parameters, "file": str(path)}
