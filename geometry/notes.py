"""Notes that are reported for batches of many grids too, not only for a single grid."""

from collections.abc import Iterable


class Change(str):
    """A sentence that says what was changed of a shape, or left out of its file."""

    __slots__ = ()


class Advice(str):
    """A sentence about what was asked for, which is the same for every shape."""

    __slots__ = ()


def changes_in(notes: Iterable[str]) -> tuple[str, ...]:
    """Return those of the notes that say what was changed.

    >>> changes_in(("spacing tanh is used", Change("the base is closed by a wedge")))
    ('the base is closed by a wedge',)
    """
    return tuple(str(note) for note in notes if isinstance(note, Change))


def change_facts(notes: Iterable[str]) -> dict[str, str]:
    """Return what was changed by the name that it has in the provenance of a grid; nothing if nothing was."""
    changes = changes_in(notes)
    return {"changes": "; ".join(changes)} if changes else {}


def advice_in(notes: Iterable[str]) -> tuple[str, ...]:
    """Return those of the notes that are about what was asked for."""
    return tuple(str(note) for note in notes if isinstance(note, Advice))
