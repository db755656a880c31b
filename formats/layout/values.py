"""Values of a JSON object. They are checked before they are used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from meshonet.formats.source import LARGEST
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError


@dataclass(frozen=True)
class Values:
    """A JSON object and its place, such as ``faces[3]``; an unsuitable value of a key raises InputError."""

    data: dict[str, Any]
    place: str = ""

    def error(self, problem: str) -> InputError:
        """Return an error that names the place of this object."""
        return InputError(problem, "write the layout again", place=self.place)

    def rows(self, key: str) -> list[Values]:
        """Return the non-empty list of JSON objects at `key`."""
        rows = self.data.get(key)
        if not isinstance(rows, list) or not rows or not all(isinstance(row, dict) for row in rows):
            raise self.error(f"{key} are no list of objects")
        return [Values(row, f"{key}[{k}]") for k, row in enumerate(rows)]

    def row(self, key: str) -> Values:
        """Return the JSON object at `key`."""
        row = self.data.get(key)
        if not isinstance(row, dict):
            raise self.error(f"{key} is no object")
        return Values(row, key)

    def text(self, key: str) -> str:
        """Return the text at `key`."""
        value = self.data.get(key)
        if not isinstance(value, str):
            raise self.error(f"{key} is no text")
        return value

    def texts(self, key: str) -> list[str]:
        """Return the list of non-empty texts at `key`."""
        values = self.data.get(key)
        if not isinstance(values, list) or not all(isinstance(each, str) and each for each in values):
            raise self.error(f"{key} are no texts")
        return values

    def count(self, key: str, *, default: int | None = None) -> int:
        """Return the integer at `key`, which is not negative."""
        value = self.data.get(key, default)
        if type(value) is not int or not 0 <= value < 1 << 31:
            raise self.error(f"{key} is no count")
        return value

    def number(self, key: str, below: int) -> int:
        """Return the integer at `key`, from 0 to `below` - 1."""
        return self._below(key, self.data.get(key), below)

    def numbers(self, key: str, below: int) -> list[int]:
        """Return the list at `key`, of integers from 0 to `below` - 1."""
        values = self.data.get(key)
        if not isinstance(values, list):
            raise self.error(f"{key} are no list")
        return [self._below(key, value, below) for value in values]

    def entry(self, key: str, k: int, of: int, below: int) -> int:
        """Return entry `k` of the list at `key`, which must have `of` integers from 0 to `below` - 1."""
        values = self.data.get(key)
        if not isinstance(values, list) or len(values) != of:
            raise self.error(f"{key} are not {of} numbers")
        return self._below(key, values[k], below)

    def _below(self, key: str, value: Any, below: int) -> int:
        if type(value) is not int or not 0 <= value < below:
            raise self.error(f"{key} has {str(value)[:20]!r}, which is none of 0 to {below - 1}")
        return value

    def array(self, values: Any, what: str) -> Floats:
        """Return `values` as an array of finite numbers; `what` names it in errors."""
        try:
            array = np.array(values if values is not None else [None], dtype=np.float64)
        except (ValueError, TypeError, OverflowError):
            raise self.error(f"{what} are no numbers") from None
        if not (np.abs(array) < LARGEST).all():
            raise self.error(f"{what} are not finite or far too large")
        return array

    def pair(self, key: str) -> tuple[float, float]:
        """Return two finite numbers."""
        array = self.array(self.data.get(key), key)
        if array.shape != (2,):
            raise self.error(f"{key} is not two numbers")
        return float(array[0]), float(array[1])

    def points(self, key: str, *, least: int = 1, one: bool = False) -> Floats:
        """Return at least `least` points (n, 2); with `one`, a single point x, y as (1, 2)."""
        array = self.array(self.data.get(key), key)
        array = array[None] if one else array.reshape(0, 2) if not array.size else array
        if array.ndim != 2 or array.shape[1] != 2 or len(array) < least:
            raise self.error(f"{key} are not {'a point' if one else 'points x, y'}")
        return array
