"""Rows of a benchmark that are kept in a folder, so that a run that was cut short goes on where it stopped.

A row belongs to the sources that made it: those of other sources are not used.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats

ROOT = Path(__file__).parents[1]
KINDS = {".py", ".pxi", ".c", ".h", ".safetensors"}


class Kept:
    """Rows and arrays under keys, in `folder`; nothing is kept without one."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._path = folder / f"{_stamp(('kernels', 'geometry', 'solvers'))}.jsonl" if folder else None
        self._goals = folder / f"goals-{_stamp(('kernels/elliptic', 'solvers/elliptic'))}" if folder else None
        self._rows: dict[str, Any] = {}
        if self._goals:
            self._goals.mkdir(parents=True, exist_ok=True)
        if self._path and self._path.exists():
            for line in self._path.read_text().splitlines():
                key, row = json.loads(line)
                self._rows[key] = row

    def row(self, key: Sequence[str], make: Callable[[], Any]) -> Any:
        """Return the row of `key`, which `make` gives when it is not kept yet (JSON's types)."""
        name = " / ".join(key)
        if name not in self._rows:
            self._rows[name] = make()
            if self._path:
                with self._path.open("a") as file:
                    file.write(json.dumps([name, self._rows[name]]) + "\n")
        return self._rows[name]

    def arrays(self, key: Sequence[str], make: Callable[[], Sequence[Floats] | None]) -> list[Floats] | None:
        """Return the arrays of `key`, kept until the elliptic solver changes; None if `make` does so."""
        if self._goals is None:
            made = make()
            return None if made is None else list(made)
        path = self._goals / (hashlib.sha256(" / ".join(key).encode()).hexdigest()[:24] + ".npz")
        if not path.exists():
            np.savez(path, *(make() or ()))
        with np.load(path) as file:
            return [file[name] for name in file.files] or None


def _stamp(rooms: Iterable[str]) -> str:
    """Return a text that differs when a source below `rooms` does."""
    digest = hashlib.sha256()
    for room in rooms:
        for path in sorted((ROOT / room).rglob("*")):
            made = path.suffix == ".c" and path.name.startswith("_")
            if path.suffix in KINDS and not made:
                digest.update(path.read_bytes())
    return digest.hexdigest()[:12]
