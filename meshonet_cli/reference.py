"""The reference of every command, ``docs/cli.md``: ``python -m meshonet_cli.reference > docs/cli.md``.

Made from the application itself, so that it cannot say anything else than ``--help`` does.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from meshonet_cli import app
from meshonet_cli.commands import COMMANDS, Command

_HEAD = """# Commands

<!-- made by python -m meshonet_cli.reference; a test keeps it current -->

Installed as `meshonet`; `python -m meshonet_cli` is the same program. Every command has `--help`.
"""


def reference() -> str:
    """Return the reference of every command in Markdown."""
    group = app.application()
    overview = ["| command | does |", "| --- | --- |"]
    sections = []
    for command in COMMANDS:
        parsed = group.commands[command.name]
        overview.append(f"| [`{command.name}`](#{command.name}) | {_first(parsed.help)} |")
        sections.append("\n".join(_section(command, parsed)))
    codes = ["## Exit codes", "", *_table(app.__doc__ or "")]
    return "\n".join([_HEAD, *overview, "", *sections, *codes, ""])


def _section(command: Command, parsed: Any) -> Iterator[str]:
    yield f"## {command.name}"
    yield ""
    yield parsed.help.strip()
    yield ""
    yield "```sh"
    yield from command.examples
    yield "```"
    yield ""
    yield "| argument or option | meaning |"
    yield "| --- | --- |"
    for option in parsed.params:
        yield f"| {_spelled(option)} | {_meaning(option)} |"
    yield ""


def _spelled(option: Any) -> str:
    if option.param_type_name == "argument":
        return f"`{option.metavar}`" if "..." in option.metavar else f"`{option.metavar}...`"
    value = f" {option.metavar}" if option.metavar else ""
    return "`" + ", ".join(option.opts).replace("|", r"\|") + value.replace("|", r"\|") + "`"


def _meaning(option: Any) -> str:
    meaning = str(option.help).replace("|", r"\|")
    if getattr(option, "show_default", False) and option.default not in (None, False, ()):
        meaning += f" [default: {option.default}]"
    if option.required:
        meaning += " [required]"
    return meaning


def _first(text: str) -> str:
    return text.strip().splitlines()[0]


def _table(docstring: str) -> Iterator[str]:
    """Turn the table of exit codes in a docstring, and the paragraph after it, into Markdown."""
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
