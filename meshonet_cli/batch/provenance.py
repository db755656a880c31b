"""Provenance of a file: version and command, stored in the file; and settings as text."""

import dataclasses
import functools
import hashlib
import shlex
import sys
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from meshonet import __version__

_MOST_NAMED = 12  # words between options that are all kept


def provenance(arguments: Sequence[str] | None = None) -> dict[str, str]:
    """Return the program's version and command line, without the output's name.

    Without the name, equal inputs and settings give equal bytes in all output files. `arguments` are those of
    the program, without its name; None means those of this process.

    >>> provenance(["tfi", "a b.csv", "-o", "grid.vts", "--res", "80"])["command"]
    "meshonet tfi 'a b.csv' --res 80"
    """
    line = tuple(sys.argv[1:] if arguments is None else arguments)
    return {"software": f"meshonet {__version__}", "command": _command(line)}


def abridged(words: Sequence[str]) -> list[str]:
    """Return a command line with a shortened list of inputs, because every grid of a dataset stores it.

    >>> abridged(["tfi", *(f"{k}.csv" for k in range(40)), "--res", "80"])
    ['tfi', '0.csv', '[38 more]', '39.csv', '--res', '80']
    """
    kept: list[str] = []
    for option, run in groupby(words, lambda word: word.startswith("-")):
        names = list(run)
        long = not option and len(names) > _MOST_NAMED
        kept += [*names[:2], f"[{len(names) - 3} more]", names[-1]] if long else names
    return kept


@lru_cache(maxsize=1)
def _command(words: tuple[str, ...]) -> str:
    kept = ["meshonet"]
    taken = iter(abridged(words) if len(words) > _MOST_NAMED else words)
    for word in taken:
        if word in ("-o", "--output"):
            next(taken, None)
        elif not (word.startswith("--output=") or (word.startswith("-o") and len(word) > 2)):
            kept.append(word)
    return shlex.join(kept)


WITHOUT_EFFECT = ("threads", "percentiles", "history", "criteria", "detailed")
"""Fields of settings on which no node depends."""
_MODEL = ".safetensors"
"""Extension of model files."""


def described(value: object) -> str:
    """Return `value`, which consists of dataclasses, containers, arrays and plain values, as text.

    Models are described by the content of their files, objects of other classes by their attributes.

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
