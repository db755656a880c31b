"""Generates the manual page from the help: ``python -m meshonet_cli.help.man > meshonet.1``."""

from __future__ import annotations

from meshonet import __version__
from meshonet_cli.commands import COMMANDS
from meshonet_cli.help.reference import help_text

_WIDTH = 78
"""Characters per line of a manual page."""


def man_page() -> str:
    """Return the manual page of all commands in roff."""
    lines = [
        f'.TH MESHONET 1 "" "meshonet {__version__}" "User Commands"',
        ".SH NAME",
        r"meshonet \- structured grids from a boundary",
        ".SH SYNOPSIS",
        r"\fBmeshonet\fR \fICOMMAND\fR [\fIOPTIONS\fR] [\fIARGUMENTS\fR]",
        ".SH DESCRIPTION",
        *_block(),
        ".SH COMMANDS",
    ]
    for command in COMMANDS:
        lines += [f'.SS "meshonet {_escaped(command.name)}"', *_block(command.name)]
    return "\n".join(lines) + "\n"


def _block(*command: str) -> list[str]:
    """Return the help of a command with its line breaks."""
    return [".nf", *map(_escaped, help_text(command, _WIDTH).splitlines()), ".fi"]


def _escaped(line: str) -> str:
    r"""Return a line for roff, with special characters escaped.

    >>> _escaped(".5 of --res")
    '\\&.5 of \\-\\-res'
    """
    text = line.replace("\\", r"\e").replace("-", r"\-")
    return rf"\&{text}" if text.startswith((".", "'")) else text


if __name__ == "__main__":
    print(man_page(), end="")  # noqa: T201
