"""Settings as text, equal for equal settings in all processes and on all machines."""

import dataclasses
import functools
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

WITHOUT_EFFECT = ("threads", "percentiles", "history", "criteria", "detailed")
"""Fields of settings on which no node depends."""

_MODEL = ".safetensors"  # extension of model files


def described(value: object) -> str:
    """Return settings as text: dataclasses, containers, arrays and plain values.

    A model is described by the content of its files, any other object by its attributes.

    >>> described({"b": (1, 2.5), "a": None})
    "{'a': None, 'b': (1, 2.5,)}"
    """
    if isinstance(value, str) and value.endswith(_MODEL) and Path(value).is_file():
        return f"{value!r} {hashlib.sha256(Path(value).read_bytes()).hexdigest()}"
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        return repr(value)
    if isinstance(value, np.ndarray):
        return f"{value.dtype}{value.shape}{hashlib.sha256(value.tobytes()).hexdigest()}"
    if isinstance(value, Mapping):
        return "{" + ", ".join(sorted(f"{described(k)}: {described(v)}" for k, v in value.items())) + "}"
    if isinstance(value, tuple | list):
        return "(" + "".join(f"{described(each)}, " for each in value).strip(" ") + ")"
    if isinstance(value, functools.partial):
        return f"{described(value.func)}{described(value.args)}{described(_effective(value.keywords))}"
    if isinstance(value, type) or (callable(value) and hasattr(value, "__qualname__")):
        return f"{value.__module__}.{value.__qualname__}"
    if dataclasses.is_dataclass(value):
        facts = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    else:
        facts = vars(value) if hasattr(value, "__dict__") else {"value": str(value)}
    return f"{type(value).__qualname__}{described(_effective(facts))}"


def _effective(facts: Mapping[str, Any]) -> dict[str, Any]:
    return {name: fact for name, fact in facts.items() if name not in WITHOUT_EFFECT}
