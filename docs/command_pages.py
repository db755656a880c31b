"""The pages made of what ``--help`` prints: reference/commands, and the manual page.

python docs/command_pages.py > meshonet.1
"""

import contextlib
import io
from collections.abc import Iterator, Sequence

from meshonet import __version__
from meshonet_cli import app
from meshonet_cli.commands import COMMANDS

WIDTH = 98  # columns of the help texts in the reference
MANUAL_WIDTH = 78  # and in the manual page

_HEAD = """# Commands

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look up a command here. `meshonet COMMAND --help` prints its page. `python -m meshonet_cli` is the same
program.
"""
"""Start of the page of all commands."""

_COMMAND_HEAD = """# meshonet {name}

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look up an option of `{name}` here. `meshonet {name} --help` prints the same text.
"""
"""Start of the page of one command."""


def reference() -> dict[str, str]:
    """Return the pages in Markdown by file name: ``index.md`` and one of each command."""
    names = [command.name for command in COMMANDS]
    listed = ("```{toctree}", ":maxdepth: 1", "", *names, "```", "")
    index = [_HEAD, *_block(), *listed, "## Exit codes", "", *_table(app.__doc__ or ""), ""]
    pages = {f"{name}.md": "\n".join([_COMMAND_HEAD.format(name=name), *_block(name)]) for name in names}
    return {"index.md": "\n".join(index), **pages}


def _block(*words: str) -> tuple[str, ...]:
    """Return the help of a command as a block of Markdown."""
    return "```text", help_text(words, WIDTH), "```", ""


def help_text(words: Sequence[str], width: int) -> str:
    """Return the output of ``--help`` for the command `words`, in lines of at most `width` characters."""
    arguments = [*words, "--help"]
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        app.application().main(arguments, prog_name="meshonet", standalone_mode=False, terminal_width=width)
    return printed.getvalue().rstrip()


def _table(docstring: str) -> Iterator[str]:
    """Convert the table of exit codes in a docstring, and the paragraph after it, to Markdown."""
    lines = docstring.splitlines()
    rules = [k for k, line in enumerate(lines) if line.startswith("=====")]
    yield "| code | meaning |"
    yield "| --- | --- |"
    for line in lines[rules[1] + 1 : rules[2]]:
        code, meaning = line.split(maxsplit=1)
        yield f"| {code} | {meaning.replace('``', '`')} |"
    yield ""
    yield from (line for line in lines[rules[2] + 1 :] if line)


def man_page() -> str:
    """Return the manual page of all commands in roff."""
    lines = [
        f'.TH MESHONET 1 "" "meshonet {__version__}" "User Commands"',
        ".SH NAME",
        r"meshonet \- structured grids from a boundary",
        ".SH SYNOPSIS",
        r"\fBmeshonet\fR \fICOMMAND\fR [\fIOPTIONS\fR] [\fIARGUMENTS\fR]",
        ".SH DESCRIPTION",
        *_roff(),
        ".SH COMMANDS",
    ]
    for command in COMMANDS:
        lines += [f'.SS "meshonet {_escaped(command.name)}"', *_roff(command.name)]
    return "\n".join(lines) + "\n"


def _roff(*command: str) -> list[str]:
    """Return what the help of a command prints, its lines as they are."""
    return [".nf", *map(_escaped, help_text(command, MANUAL_WIDTH).splitlines()), ".fi"]


def _escaped(line: str) -> str:
    r"""Return a line that roff prints as it is.

    >>> _escaped(".5 of --res")
    '\\&.5 of \\-\\-res'
    """
    text = line.replace("\\", r"\e").replace("-", r"\-")
    return rf"\&{text}" if text.startswith((".", "'")) else text


if __name__ == "__main__":
    print(man_page(), end="")  # noqa: T201
