"""Names and kinds of patches in the form that the files of flow solvers require."""

import re
from collections.abc import Container, Iterable, Sequence

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind, Patch, kind_of


def words(
    names: Iterable[str], limit: int = 64, taken: Iterable[str] = (), *, letter: bool = False
) -> dict[str, str]:
    """Return for each of `names` a different word of ASCII letters, digits and ``_.+-``.

    A word has at most `limit` characters and is not one of `taken`. With `letter`, it starts with a letter.

    >>> words(["wall", "no-slip wall", "no-slip,wall", "Ω"])
    {'wall': 'wall', 'no-slip wall': 'no-slip_wall', 'no-slip,wall': 'no-slip_wall-2', 'Ω': 'part'}
    """
    result: dict[str, str] = {}
    used = set(taken)
    for name in names:
        if name in result:
            continue
        stem = re.sub(r"[^A-Za-z0-9_.+-]+", "_", name).strip("_.")[:limit] or "part"
        if letter and not stem[0].isalpha():
            stem = f"part_{stem}"[:limit]
        result[name] = word = unused(stem, used, limit)
        used.add(word)
    return result


def unused(stem: str, used: Container[str], limit: int = 64) -> str:
    """Return `stem`, of at most `limit` characters, with a number appended if `used` contains it."""
    word, count = stem, 1
    while word in used:
        count += 1
        word = f"{stem[: limit - len(str(count)) - 1]}-{count}"
    return word


def kind_said(name: str, word: str, known: Sequence[tuple[str, Kind]]) -> Kind:
    """Return the kind of a patch by its name or, if that says nothing, by the `word` in the file."""
    by_word: Kind = next((kind for sign, kind in known if word.startswith(sign)), "other")
    by_name = kind_of(name)
    return by_word if by_name == "other" else by_name


def kinds(grid: Grid, patches: Iterable[Patch]) -> dict[str, Kind]:
    """Return the kind of boundary for each patch name; an unnamed patch of a body is a wall."""
    kind: dict[str, Kind] = {}
    for patch in patches:
        body = grid.around_body and patch.side == "south" and patch.kind in ("other", "interface")
        kind.setdefault(patch.name, "wall" if body else patch.kind)
    return kind
