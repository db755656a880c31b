"""Every model there is, by the name that `train --model` and the header of a model file call it."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Mapping
from typing import Any

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.model import Operator

STRIP = "strip"
"""The airfoil operator in the periodic strip: trained from boundaries, shipped with the package."""

QUAD = "quad"
"""The operator for four-sided domains: trained from Winslow's and variational grids, shipped too."""

OPERATORS: dict[str, tuple[str, str]] = {
    "meshonet": ("meshonet", "MeshONet"),
    "meshonet-hard": ("meshonet_hard", "MeshONetHard"),
    "deeponet": ("deeponet", "DeepONet"),
    "pod-deeponet": ("pod_deeponet", "PODDeepONet"),
    "fno1d": ("fno1d", "FNO1D"),
    "fno2d": ("fno2d", "FNO2D"),
    "mionet": ("mionet", "MIONet"),
    "mgnet": ("mgnet", "MGNet"),
    "meshnet": ("mgnet", "MeshNet"),
}
"""Module and class of the models that are trained on solved grids, in the order of the help."""

MODELS = (STRIP, QUAD, *OPERATORS)


def operator(name: str, topology: Topology, settings: Mapping[str, Any] | None = None) -> Operator:
    """Return the model `name` with `settings` in place of its defaults.

    Raises
    ------
    InputError
        no such model or setting, or a value of another type than the setting's.

    Examples
    --------
    >>> operator("meshonet", "quad", {"sensors": 80}).sensors
    80
    """
    if name not in OPERATORS:
        raise InputError(f"model {name!r} is not known", "use one of " + ", ".join(MODELS))
    module, kind = OPERATORS[name]
    made = getattr(importlib.import_module(f"meshonet.solvers.neural.models.{module}"), kind)
    known = {field.name: field.default for field in dataclasses.fields(made)}
    if "periodic" in known:
        known["periodic"] = topology == "o"
    given = {key: _fitting(name, known, key, value) for key, value in (settings or {}).items()}
    return made(**{**known, **given})


def settings_of(model: Operator) -> dict[str, Any]:
    """Return the settings of a model as JSON keeps them."""
    return {key: list(v) if isinstance(v, tuple) else v for key, v in dataclasses.asdict(model).items()}


def _fitting(name: str, known: Mapping[str, Any], key: str, value: Any) -> Any:
    if key not in known:
        raise InputError(f"{name} has no setting {key!r}", "use one of " + ", ".join(known))
    default = known[key]
    if isinstance(default, tuple) and isinstance(value, list | tuple) and value:
        return tuple(_fitting(name, {key: default[0]}, key, one) for one in value)
    right = type(value) is type(default) or (isinstance(default, float) and isinstance(value, int))
    if not right or (isinstance(value, int) and not isinstance(value, bool) and not 0 <= value <= 4096):
        raise InputError(f"{key}={value!r} does not suit {name}", f"use something like {key}={default!r}")
    return value
