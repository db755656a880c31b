"""Where the results of a batch go."""

from __future__ import annotations

import re
import string
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from meshonet.formats.output import whole_file
from meshonet.formats.registry import Kind, format_for_output
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.item import Item

FIELDS = ("stem", "index", "name")


class Destination:
    """Where results go: one file, one file each, or standard output.

    Parameters
    ----------
    text : path, path with ``{stem}``, ``{index}`` or ``{name}`` in it, or ``-``.
    fmt : format to write, or None to go by the ending.
    kind : what will be written.
    put : writes to a path in place of the format's own function.

    Raises InputError: an unknown field or ending, or a format that cannot be written.
    """

    def __init__(
        self, text: str, fmt: str | None, kind: Kind = "grids", put: Callable[[Path, Any], None] | None = None
    ) -> None:
        self.text = text
        self.each = _has_fields(text)
        self.format = format_for_output(text, fmt, kind)
        self._put = put or getattr(self.format, f"write_{kind}")
        self._taken: dict[str, str] = {}
        if text == "-" and sys.stdout.isatty():
            raise InputError("standard output is the terminal", "pipe it on, or write to a file", source="-o")

    def path(self, item: Item[Any]) -> str:
        """Return the path of one member.

        Raises InputError: an earlier member has the same path.
        """
        if not self.each:
            return self.text
        name = re.sub(r"[^\w.+-]+", "_", item.what.name).strip("._") or item.stem
        path = self.text.format(stem=item.stem, index=item.index, name=name)
        place = str(Path(path).parent) if self.format.fills_folder else path
        if place in self._taken:
            raise InputError(
                f"would overwrite {place} of {self._taken[place]}",
                f"put {{{{index}}}} into -o {_escaped(self.text)}",
                source=item.label,
            )
        self._taken[place] = item.label
        return path

    def check_room(self, sources: Sequence[str]) -> None:
        """Raise InputError when several inputs would go into a file that holds one."""
        if len(sources) > 1 and not self.holds_many:
            raise InputError(
                f"{len(sources)} inputs and one {self.format.name} file, which holds one",
                f"use -o '{_escaped(_pattern(self.text))}' or one .h5",
                source=self.text,
            )

    @property
    def holds_many(self) -> bool:
        """Whether more than one member can go there."""
        return self.each or self.format.many

    def check_only(self, item: Item[Any]) -> None:
        """Raise InputError when `item` is one of several and there is room for one."""
        if not (item.only or self.holds_many):
            raise InputError(
                f"holds several grids or boundaries, and a {self.format.name} file holds one",
                f"use -o '{_escaped(_pattern(self.text, 'index'))}' or one .h5",
                source=item.source,
            )

    def write(self, path: str, what: Iterable[Any]) -> None:
        """Write `what` to `path`, whole or not at all."""
        folder = self.format.fills_folder
        with whole_file(path, make_folder=self.each or folder, beside=folder or self.format.beside) as part:
            self._put(part, what)


def _escaped(text: str) -> str:
    """Return `text` for a message, where names in single braces would be those of parameters."""
    return re.sub(r"\{(\w+)\}", r"{{\1}}", text)


def _pattern(text: str, field: str = "stem") -> str:
    path = Path(text)
    return str(path.with_name(f"{path.stem}-{{{field}}}{path.suffix}")) if text != "-" else f"{{{field}}}.vts"


def _has_fields(text: str) -> bool:
    try:
        fields = [field for _, field, _, _ in string.Formatter().parse(text) if field is not None]
        text.format(stem="", index=0, name="")
    except (ValueError, KeyError, IndexError, AttributeError):
        fields = [""]
    unknown = [field for field in fields if field not in FIELDS]
    if unknown:
        raise InputError(
            f"{_escaped(repr(text))} has a field that is not known",
            "use {{stem}}, {{index}} or {{name}}; write {{ and }} for braces",
            source="-o",
        )
    return bool(fields)
