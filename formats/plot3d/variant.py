"""What a Plot3D file does not say of itself, in words: ``--from plot3d:big,float32``, ``--plot3d iblank``."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.errors import InputError

CHOICES = (
    ("ascii", "binary", "fortran"),
    ("multi", "single"),
    ("2d", "3d"),
    ("no-iblank", "iblank"),
    ("little", "big"),
    ("float64", "float32"),
    ("whole", "planes"),
    ("span-k", "span-i", "span-j"),
)
"""Of each row one word may be given.

``single`` has no count of blocks in front; ``iblank`` an integer a node behind the coordinates; ``planes`` x,
y and z of one k after the other in place of all x, all y, all z; ``span-i`` the planes of a grid that is
repeated in z along the first index, as FUN3D and NASA have it, ``span-j`` along the second.
"""

_READ_ONLY, _WRITE_ONLY = {"planes", "whole"}, {"span-i", "span-j", "span-k"}


@dataclass(frozen=True)
class Variant:
    """The words given, at most one of each row of `CHOICES`."""

    words: frozenset[str] = frozenset()

    def one_of(self, *choices: str, default: str) -> str:
        """Return which of `choices` was given."""
        return next((word for word in choices if word in self.words), default)

    def has(self, word: str) -> bool:
        """Say whether `word` was given."""
        return word in self.words

    def for_reading(self) -> frozenset[str]:
        """Return the words that a file has to agree with."""
        return self.words - _WRITE_ONLY

    def for_writing(self) -> Variant:
        """Return the variant itself.

        Raises
        ------
        InputError
            it asks for what is only read.
        """
        if self.words & _READ_ONLY - {"whole"}:
            raise InputError("planes are read and not written", "leave the word out", parameter="plot3d")
        return self


def parse_variant(text: str) -> Variant:
    """Return the variant of comma-separated words.

    Raises
    ------
    InputError
        a word that is not known, or two that exclude each other.

    Examples
    --------
    >>> sorted(parse_variant("single,big").words)
    ['big', 'single']
    """
    words = [word.strip().lower() for word in text.split(",") if word.strip()]
    known = [word for row in CHOICES for word in row]
    for word in words:
        if word not in known:
            raise InputError(f"{word!r} is not known", "use " + " ".join(known), parameter="plot3d")
    for row in CHOICES:
        given = [word for word in row if word in words]
        if len(given) > 1:
            raise InputError(" and ".join(given) + " exclude each other", "give one", parameter="plot3d")
    return Variant(frozenset(words))


ANY = Variant()
