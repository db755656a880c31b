"""Generates the page of commands: ``python -m meshonet_cli.help.reference > docs/reference/cli.md``."""

import contextlib
import io
from collections.abc import Iterator, Sequence

from meshonet_cli import app
from meshonet_cli.commands import COMMANDS

WIDTH = 98  # columns of the help texts

_HEAD = """# Commands

<!-- made by python -m meshonet_cli.help.reference; a test keeps it current -->

Look up an option here: what `meshonet --help` and the `--help` of every command print.
`python -m meshonet_cli` is the same program.
"""
"""Start of the page."""


def reference() -> str:
    """Return the page in Markdown."""
    lines = [_HEAD, *_block()]
    for command in COMMANDS:
        lines += [f"## {command.name}", "", *_block(command.name)]
    return "\n".join([*lines, "## Exit codes", "", *_table(app.__doc__ or ""), ""])


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


if __name__ == "__main__":
    print(reference(), end="")  # noqa: T201
