"""Kinds of notes that are reported for batches too, or dropped when nodes move."""

from collections.abc import Iterable

UNJUDGED = {"verdict": None, "limits_exceeded": None}
"""Facts in the provenance of a grid that are removed when nodes change."""


class Change(str):
    """A note that says how a shape was changed, or which part of the shape's file was left out."""

    __slots__ = ()


class Advice(str):
    """A note on the settings, which is the same for all shapes of a batch."""

    __slots__ = ()


class ExactHeights(str):
    """A note that first cells have the prescribed height, which holds only until nodes move."""

    __slots__ = ()


def departure_note(what: str, off: float, unit: str = "") -> str:
    """Return a note: the smooth curve `what` deviates by up to `off` from the polygon of its points."""
    lines = f"up to {off:.2g}{unit} away from straight lines between them"
    return f"{what} through the points, {lines}; give more points where it matters"


def changes_in(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the notes that say how a shape was changed.

    >>> changes_in(("spacing tanh is used", Change("the base is closed by a wedge")))
    ('the base is closed by a wedge',)
    """
    return tuple(str(note) for note in notes if isinstance(note, Change))


def change_facts(notes: Iterable[str]) -> dict[str, str]:
    """Return ``{"changes": text}`` with the notes that say how a shape was changed; empty without any."""
    changes = changes_in(notes)
    return {"changes": "; ".join(changes)} if changes else {}


def advice_in(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the notes that are about settings (`Advice`)."""
    return tuple(str(note) for note in notes if isinstance(note, Advice))
