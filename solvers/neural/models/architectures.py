"""The architectures of the paper and of its references, by name; `MODELS` is all that can be trained."""

import dataclasses
from collections.abc import Mapping
from pkgutil import resolve_name
from typing import Any, TypeVar

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError, meant
from meshonet.solvers.neural.models.architecture import Architecture

M = TypeVar("M")

ARCHITECTURES: dict[str, str] = {
    "meshonet": "meshonet.solvers.neural.models.branch_trunk:MeshONet",
    "meshonet-hard": "meshonet.solvers.neural.models.meshonet_hard:MeshONetHard",
    "deeponet": "meshonet.solvers.neural.models.branch_trunk:DeepONet",
    "pod-deeponet": "meshonet.solvers.neural.models.branch_trunk:PODDeepONet",
    "fno1d": "meshonet.solvers.neural.models.fourier:FNO1D",
    "fno2d": "meshonet.solvers.neural.models.fourier:FNO2D",
    "wno": "meshonet.solvers.neural.models.along_xi:WNO",
    "kno": "meshonet.solvers.neural.models.fourier:KNO",
    "lno": "meshonet.solvers.neural.models.along_xi:LNO",
    "mionet": "meshonet.solvers.neural.models.branch_trunk:MIONet",
    "mgnet": "meshonet.solvers.neural.models.mgnet:MGNet",
    "meshnet": "meshonet.solvers.neural.models.mgnet:MeshNet",
}
"""Class of each model that is trained on solved grids, in the order of the help."""

MODELS = ("strip", "quad", *ARCHITECTURES)
"""Names of trainable models: for airfoils, for four-sided domains or bodies, and those of the paper."""


def architecture(name: str, topology: Topology, settings: Mapping[str, Any] | None = None) -> Architecture:
    """Return the model `name` of `ARCHITECTURES`; `settings` replace defaults.

    Raises InputError if there is no such model or setting, or if a value has another type than the default.

    >>> architecture("meshonet", "quad", {"sensors": 80}).sensors
    80
    """
    if name not in ARCHITECTURES:
        raise InputError(
            f"model {name!r} is not known", meant(name, MODELS) + "use one of " + ", ".join(MODELS)
        )
    cls: type[Architecture] = resolve_name(ARCHITECTURES[name])
    around = {"periodic": topology == "o"} if hasattr(cls, "periodic") else {}
    return with_settings(cls, name, {**around, **(settings or {})})


def with_settings(cls: type[M], name: str, settings: Mapping[str, Any]) -> M:
    """Return a model of class `cls`; `settings` replace defaults.

    Raises InputError if there is no such setting, or if a value has another type than the default.
    """
    defaults = {field.name: field.default for field in dataclasses.fields(cls)}  # type: ignore[arg-type]
    changed = {key: _fitting(name, defaults, key, value) for key, value in settings.items()}
    return cls(**{**defaults, **changed})


def name_of(model: Architecture) -> str:
    """Return the name of a model in `ARCHITECTURES`."""
    own = f":{type(model).__name__}"
    return next(name for name, path in ARCHITECTURES.items() if path.endswith(own))


def settings_of(model: Architecture) -> dict[str, Any]:
    """Return the settings of a model in a form that JSON can store: tuples become lists."""
    return {key: list(v) if isinstance(v, tuple) else v for key, v in dataclasses.asdict(model).items()}


def _fitting(name: str, defaults: Mapping[str, Any], key: str, value: Any) -> Any:
    if key not in defaults:
        raise InputError(f"{name} has no setting {key!r}", "use one of " + ", ".join(defaults))
    default = defaults[key]
    if isinstance(default, tuple) and isinstance(value, list | tuple) and value:
        return tuple(_fitting(name, {key: default[0]}, key, item) for item in value)
    right = type(value) is type(default) or (isinstance(default, float) and isinstance(value, int))
    if not right or (isinstance(value, int) and not isinstance(value, bool) and not 0 <= value <= 4096):
        raise InputError(f"{key}={value!r} does not suit {name}", f"use something like {key}={default!r}")
    return value
