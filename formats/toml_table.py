"""Tables of TOML. Values are checked before they are used."""

import math
import re
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from meshonet.formats.source import Source, printable
from meshonet.geometry.errors import InputError

_SHOWN = 40  # number of characters of a value that an error message shows


@dataclass(frozen=True)
class Table:
    """A table of a TOML file and its place, such as ``sections[1]``; unsuitable values raise InputError."""

    data: dict[str, Any]
    place: str = ""

    def error(self, key: str, problem: str, remedy: str) -> InputError:
        """Return an error that names a key of this table."""
        return InputError(problem, remedy, place=self._at(key))

    @contextmanager
    def located(self) -> Iterator[None]:
        """Return a context in which error messages begin with the place of this table: ``sections[1]``."""
        try:
            yield
        except InputError as error:
            if not error.place.startswith(self.place):
                error.place = self._at(error.place)
            error.place = error.place or self.place
            raise

    @contextmanager
    def in_file_of(self, key: str) -> Iterator[None]:
        """Return a context in which an error in the file that `key` names becomes an error of this key."""
        try:
            yield
        except InputError as error:
            where = ": ".join(filter(None, (error.source, error.place, error.problem)))
            raise self.error(key, where, error.remedy) from None

    def only(self, *keys: str) -> None:
        """Raise InputError if the table has a key that is not one of `keys`."""
        for key in self.data:
            if key not in keys:
                raise self.error(printable(key), "is not known", "use " + ", ".join(keys))

    def rows(self, key: str, least: int = 1) -> "list[Table]":
        """Return the list of tables under `key`; it must have at least `least` tables."""
        rows = self.data.get(key)
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows) or len(rows) < least:
            many = "one or more" if least == 1 else f"{least} or more"
            whole = re.sub(r"\[\d+\]", "", self._at(key))
            raise self.error(key, f"are not {many} tables", f"write [[{whole}]] above each")
        return [Table(row, f"{self._at(key)}[{k}]") for k, row in enumerate(rows)]

    def _at(self, key: str) -> str:
        return f"{self.place}.{key}" if self.place else key

    def number(self, key: str, default: float | None = None) -> float:
        """Return a finite number; the default applies if the key is missing."""
        if key not in self.data and default is not None:
            return default
        return self._number(key, self.data.get(key))

    def positive(self, key: str) -> float:
        """Return a number of at least 1e-12."""
        value = self.number(key)
        if not value > 0:
            raise self.error(key, f"{value:g} is not positive", "use more than 0")
        if value < 1e-12:
            raise self.error(key, f"{value:g} is out of range", "use more than 1e-12")
        return value

    def text(self, key: str, default: str | None = None) -> str:
        """Return a non-empty text; the default applies if the key is missing."""
        value = self.data.get(key, default)
        if not isinstance(value, str) or not value:
            problem = "is missing" if value is None else f"{_shown(value)} is no text"
            raise self.error(key, problem, "write it in quotes")
        return value

    def flag(self, key: str, *, default: bool) -> bool:
        """Return true or false; the default applies if the key is missing."""
        value = self.data.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, f"{_shown(value)} is neither true nor false", "write true or false")
        return value

    def word(self, key: str, known: tuple[str, ...], default: str) -> str:
        """Return one of the words in `known`; the default applies if the key is missing."""
        value = self.text(key, default)
        if value not in known:
            raise self.error(key, f"{_shown(value)} is not known", "use " + ", ".join(known))
        return value

    def vector(
        self, key: str, default: tuple[float, float, float] | None = None
    ) -> tuple[float, float, float]:
        """Return three finite numbers; the default applies if the key is missing."""
        if key not in self.data and default is not None:
            return default
        x, y, z = self._numbers(key, 3)
        return x, y, z

    def pair(self, key: str, default: tuple[float, float]) -> tuple[float, float]:
        """Return two finite numbers; the value may be a single number, and the second is then 0."""
        if key not in self.data:
            return default
        if not isinstance(self.data[key], list):
            return self.number(key), 0.0
        x, y = self._numbers(key, 2)
        return x, y

    def pairs(self, key: str, least: int, columns: str = "x, r") -> list[list[float]]:
        """Return pairs of numbers at `key`, at least `least`; messages show a pair as ``[columns]``."""
        rows = self.data.get(key)
        if not isinstance(rows, list) or len(rows) < least:
            raise self.error(
                key, f"{_shown(rows)} is not {least} pairs or more", f"give [[{columns}], [{columns}]]"
            )
        named = {f"{key}[{k}]": row for k, row in enumerate(rows)}
        return [Table(named, self.place)._numbers(name, 2) for name in named]

    def _numbers(self, key: str, count: int) -> list[float]:
        values = self.data.get(key)
        if not isinstance(values, list) or len(values) != count:
            problem = "is missing" if values is None else f"{_shown(values)} is not {count} numbers"
            raise self.error(key, problem, f"give {count} in brackets")
        return [self._number(key, value) for value in values]

    def _number(self, key: str, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            problem = "is missing" if value is None else f"{_shown(value)} is no number"
            raise self.error(key, problem, "give a number")
        if not (abs(value) < 1e12 and math.isfinite(value)):
            raise self.error(key, f"{_shown(value)} is out of range", "use a number below 1e12")
        return float(value)


def toml_table(source: Source) -> Table:
    """Return the top-level table of a TOML source. Raises InputError, with the place, if it is not TOML."""
    try:
        return Table(tomllib.loads(source.text_bytes().decode("utf-8")))
    except (ValueError, RecursionError) as error:  # also integers of more digits than Python reads
        value = "Invalid value" in str(error)
        remedy = "write numbers as 0.5, texts in quotes" if value else "correct it, or give another file"
        raise InputError(f"is no TOML: {printable(str(error))}", remedy) from None


def _shown(value: Any) -> str:
    try:
        return printable(repr(value))[:_SHOWN]
    except ValueError:  # an integer of more digits than Python prints
        return "a number"
