"""Every model there is: those shipped or in files by `load`, those that can be trained by `MODELS`."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError, meant
from meshonet.solvers.neural.model_file import OURS, PAPER, QUAD, STRIP, Kind, read_model
from meshonet.solvers.neural.operator import Operator

if TYPE_CHECKING:
    from meshonet.solvers.neural.models.architecture import Architecture

FOLDER = Path(__file__).parent / "pretrained"

BASE = "base"  # the harmonic base with no network, where a strip operator can be named
DEFAULTS: dict[Topology, str] = {"o": "airfoil-o", "quad": "quad-general"}  # where none is named

HEADS = {"quad-winslow": ("quad-general", 0), "hole-winslow": ("hole-o", 0)}
"""Models that are another answer of a network: the name of its file, and the number of the answer."""

NEVER = {"airfoil-c": "leave {model} out: {topology} c is marched from wall and wake, better than by a model"}
"""Models that one may look for and that are not made, and what serves instead."""

OPERATORS: dict[Kind, tuple[str, str]] = {
    STRIP: ("strip.operator", "StripOperator"),
    QUAD: ("quad.operator", "QuadOperator"),
    PAPER: ("models.operator", "PaperOperator"),
}
"""Module and class of each kind of file."""

ARCHITECTURES: dict[str, tuple[str, str]] = {
    "meshonet": ("branch_trunk", "MeshONet"),
    "meshonet-hard": ("meshonet_hard", "MeshONetHard"),
    "deeponet": ("branch_trunk", "DeepONet"),
    "pod-deeponet": ("branch_trunk", "PODDeepONet"),
    "fno1d": ("fourier", "FNO1D"),
    "fno2d": ("fourier", "FNO2D"),
    "mionet": ("branch_trunk", "MIONet"),
    "mgnet": ("mgnet", "MGNet"),
    "meshnet": ("mgnet", "MeshNet"),
}
"""Module and class of the models that are trained on solved grids, in the order of the help."""

MODELS = ("strip", "quad", *ARCHITECTURES)
"""What can be trained: the airfoil operator in the periodic strip, trained from boundaries; the operator for
four-sided domains or bodies, from Winslow's and variational grids; the paper's, from solved grids."""


def shipped() -> tuple[str, ...]:
    """Return the names of the models in the package."""
    files = {path.stem for path in FOLDER.glob("*.safetensors")}
    return tuple(sorted(files | {name for name, (file, _) in HEADS.items() if file in files}))


def model_path(name: str) -> Path:
    """Return the file of a shipped model's name, or of a path. Raises InputError when there is none."""
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
    """Return a shipped operator by name, one of a file by path, or ``base``.

    Raises InputError: no such model; a file that is not one of ours, or whose arrays are not those of the
    model it names.

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


@lru_cache(maxsize=4)
def _load(path: Path, _modified: int) -> Operator:
    kind, header, arrays = read_model(path)
    own = header.get("name")
    name = own if isinstance(own, str) and own.isprintable() else path.stem
    module, made = OPERATORS[kind]
    cls: type[Operator] = getattr(importlib.import_module(f"{__package__}.{module}"), made)
    try:
        return cls.of_file(name, header, arrays)
    except InputError as error:
        error.source = str(path)
        raise
    except (KeyError, IndexError, ValueError, TypeError, AttributeError, OverflowError) as error:
        raise InputError(f"its header or arrays do not fit ({error})", OURS, source=str(path)) from None


def described(name: str) -> dict[str, Any]:
    """Return what a shipped model says of itself: name, topology, recipe, figures, parameters, file."""
    path = model_path(name)
    _, header, arrays = read_model(path)
    facts: dict[str, Any] = {key: header[key] for key in ("topology", "recipe", "figures") if key in header}
    parameters = int(sum(array.size for array in arrays.values()))
    return {"name": name, **facts, "parameters": parameters, "file": str(path)}


def architecture(name: str, topology: Topology, settings: Mapping[str, Any] | None = None) -> Architecture:
    """Return the model `name` of the paper's with `settings` in place of its defaults.

    Raises InputError: no such model or setting, or a value of another type than the setting's.

    >>> architecture("meshonet", "quad", {"sensors": 80}).sensors
    80
    """
    if name not in ARCHITECTURES:
        raise InputError(
            f"model {name!r} is not known", meant(name, MODELS) + "use one of " + ", ".join(MODELS)
        )
    module, made = ARCHITECTURES[name]
    cls = getattr(importlib.import_module(f"{__package__}.models.{module}"), made)
    defaults = {field.name: field.default for field in dataclasses.fields(cls)}
    if "periodic" in defaults:
        defaults["periodic"] = topology == "o"
    changed = {key: _fitting(name, defaults, key, value) for key, value in (settings or {}).items()}
    return cls(**{**defaults, **changed})


def name_of(model: Architecture) -> str:
    """Return the name of a model of the paper's."""
    return next(name for name, (_, cls) in ARCHITECTURES.items() if cls == type(model).__name__)


def settings_of(model: Architecture) -> dict[str, Any]:
    """Return the settings of a model as JSON keeps them."""
    return {key: list(v) if isinstance(v, tuple) else v for key, v in dataclasses.asdict(model).items()}


def _fitting(name: str, defaults: Mapping[str, Any], key: str, value: Any) -> Any:
    """Return a setting's value. Raises InputError unless it is like the setting's default."""
    if key not in defaults:
        raise InputError(f"{name} has no setting {key!r}", "use one of " + ", ".join(defaults))
    default = defaults[key]
    if isinstance(default, tuple) and isinstance(value, list | tuple) and value:
        return tuple(_fitting(name, {key: default[0]}, key, item) for item in value)
    right = type(value) is type(default) or (isinstance(default, float) and isinstance(value, int))
    if not right or (isinstance(value, int) and not isinstance(value, bool) and not 0 <= value <= 4096):
        raise InputError(f"{key}={value!r} does not suit {name}", f"use something like {key}={default!r}")
    return value
