"""The first-cell height at walls as a request gives it: directly, or by its y+."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from meshonet.geometry.errors import InputError

AtWalls: TypeAlias = float | Mapping[str, float]
"""A value for all walls, or a dict with a value for each wall with layers, by name."""


@dataclass(frozen=True, kw_only=True)
class FirstCell:
    """First-cell height at walls; several requests have these fields.

    Parameters
    ----------
    first_cell : float or mapping, optional
        Height, or a mapping from names of walls to heights. The unit depends on the kind of request.
    y_plus : float or mapping, optional
        Height as y+, converted by the friction of a flat plate.
    reynolds : float, optional
        Reynolds number for `y_plus`.
    chord_fraction : float, optional
        Position along the reference length at which y+ is converted, 0 to 1.
    length : float, optional
        Reference length of the Reynolds number, in the unit of `first_cell`; None: from the grid.
    """

    first_cell: AtWalls | None = None
    y_plus: AtWalls | None = None
    reynolds: float | None = None
    chord_fraction: float = 0.5
    length: float | None = None

    @property
    def at_walls(self) -> bool:
        """Whether a first-cell height is given."""
        return self.first_cell is not None or self.y_plus is not None

    @property
    def by_wall(self) -> tuple[str, ...]:
        """Names of the walls whose heights are set by name; empty if one height is set for all walls."""
        setting = self.first_cell if self.y_plus is None else self.y_plus
        return tuple(setting) if isinstance(setting, Mapping) else ()

    def check_first_cell(self) -> None:
        """Raise InputError for a height out of range, or for fields that cannot be combined."""
        if self.first_cell is not None and self.y_plus is not None:
            problem = "{first_cell} and {y_plus} both say how high the first cell is"
            raise InputError(problem, "give one of them")
        if (self.y_plus is None) != (self.reynolds is None):
            needed, known = ("reynolds", "y_plus") if self.reynolds is None else ("y_plus", "reynolds")
            raise InputError(f"{{{known}}} without {{{needed}}}", f"give {{{needed}}} as well")
        for name, setting in (
            ("chord_fraction", self.chord_fraction != 0.5),
            ("length", self.length is not None),
        ):
            if self.y_plus is None and setting:
                raise InputError(f"{{{name}}} without {{y_plus}}", "give {y_plus} and {reynolds} as well")
        if self.length is not None and not 0 < self.length < math.inf:
            problem = f"a reference length of {self.length:g}"
            raise InputError(problem, "give a positive length", parameter="length")
        for name in ("first_cell", "y_plus"):
            setting = getattr(self, name)
            if isinstance(setting, Mapping) and not (setting and all(setting)):
                remedy = "give e.g. tubes=1e-3,floor=5e-3, or one value"
                raise InputError("a wall without a name", remedy, parameter=name)
        if self.at_walls:
            for height in _values(self.first_cell):
                check_height(height, "first_cell")
            self.heights()  # raises for values out of range

    def heights(self, unit: float = 1.0) -> AtWalls | None:
        """Return the first-cell height, or heights by wall; None if not requested.

        `unit` is the reference length of the Reynolds number, unless the field `length` sets it.
        """
        setting = self.first_cell if self.y_plus is None else self.y_plus
        if isinstance(setting, Mapping):
            return {name: self._height(value, unit) for name, value in setting.items()}
        return None if setting is None else self._height(setting, unit)

    def height(self, unit: float = 1.0) -> float | None:
        """Return the first-cell height; None if not requested.

        `unit` is the reference length of the Reynolds number, unless the field `length` sets it. Raises
        InputError if walls have different heights or a value is out of range.
        """
        height = self.heights(unit)
        if isinstance(height, Mapping):
            name = "first_cell" if self.y_plus is None else "y_plus"
            problem = f"a value for the wall {self.by_wall[0]!r}, where all walls have the same"
            raise InputError(problem, "give one value, without a name", parameter=name)
        return height

    def _height(self, setting: float, unit: float) -> float:
        if self.y_plus is None or self.reynolds is None:
            return setting
        from meshonet.geometry.spacing.y_plus import first_cell

        return first_cell(setting, self.reynolds, self.chord_fraction) * (self.length or unit)

    def height_notes(
        self, where: str, unit: float = 1.0, in_unit: str = "", scale: float = 1.0
    ) -> tuple[str, ...]:
        """Return a note on how the first-cell height follows from y+; an empty tuple without y+.

        `unit` is the reference length of the Reynolds number; the text `where` names it, e.g. ``on a chord of
        2``. The field `length`, if set, replaces both. The note gives heights times `scale`, in `in_unit`.
        """
        from meshonet.geometry.spacing.y_plus import height_note

        if self.y_plus is None:
            return ()
        if self.length is not None:
            where = f"on a length of {self.length * scale:.6g}{in_unit}"
        heights = ", ".join(f"{height * scale:.6g}{in_unit}" for height in _values(self.heights(unit)))
        y_plus = ", ".join(f"{value:g}" for value in _values(self.y_plus))
        return (height_note(y_plus, self.reynolds, where, heights),)


def _values(setting: AtWalls | None) -> tuple[float, ...]:
    if setting is None:
        return ()
    return tuple(setting.values()) if isinstance(setting, Mapping) else (setting,)


def check_names(names: Iterable[str], known: Iterable[str], parameter: str) -> None:
    """Raise InputError for the first of the wall names `names` that is not among the `known` names."""
    known = tuple(known)
    for name in names:
        if name not in known:
            only = "; a curve that is alone in its file is the wall body" if "body" in known else ""
            remedy = f"use {', '.join(known)}{only}"
            raise InputError(f"there is no wall {name!r}", remedy, parameter=parameter)


def check_height(height: float, parameter: str) -> None:
    """Raise InputError if a height is not positive, or not finite."""
    if not 0 < height < math.inf:
        raise InputError(f"a first cell of {height:g}", "give a positive height", parameter=parameter)
