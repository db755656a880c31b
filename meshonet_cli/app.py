"""The application: its commands, and the one place that maps errors to exit codes.

===== ==========================================================================
code  meaning
===== ==========================================================================
0     done
1     a check of ``--fail-on`` or ``--profile`` failed
2     bad usage or bad input
3     no valid grid could be made
130   interrupted
143   terminated
===== ==========================================================================

A batch ends with the greatest code of its members.
"""

import contextlib
import io
import os
import re
import sys
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, NoReturn

import typer
import typer.core

from meshonet import __version__
from meshonet_cli.commands import BY_NAME, COMMANDS, Command
from meshonet_cli.terminal.stopping import LINES, hide_warnings, install

INTERRUPTED, BAD_INPUT = 130, 2
"""Exit codes for Ctrl-C, by the convention of shells, and for invalid input."""
_SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"meshonet {__version__}")
        raise typer.Exit


def options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Make structured grids from a boundary by algebraic, elliptic and other methods, or neural operators."""


class Plain(typer.core.TyperCommand):
    """A command whose usage line has ``GRID...``, not typer's ``{GRID}``, and whose options are in groups."""

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return the words of the usage line; each argument is followed by dots, since it may be repeated."""
        pieces = super().collect_usage_pieces(ctx)
        words = [piece.strip("{}") for piece in pieces]
        return [word if word == "[OPTIONS]" or "..." in word else f"{word}..." for word in words]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the help of the arguments, then the help of the options by group."""
        from meshonet_cli.options.groups import GROUPS, IO  # which a list of all commands does not need

        groups: dict[str, list[tuple[str, str]]] = {"Arguments": [], **{group: [] for group in GROUPS}}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None:
                argument = parameter.param_type_name == "argument"
                group = "Arguments" if argument else getattr(parameter, "rich_help_panel", None) or IO
                groups[group].append(record)
        for title, records in groups.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def application(commands: Sequence[Command] = COMMANDS, *, overview: bool = False) -> Any:
    """Return the parser of `commands`.

    With `overview`, the options of the commands are not loaded, which would take 0.1 s.
    """
    app = typer.Typer(
        add_completion=len(commands) > 1,
        name="meshonet",
        epilog="\b\nStart with:  meshonet infer airfoil.dat --res 200 -o grid.vts\n"
        "Exit codes:  0 done, 1 check failed, 2 bad usage or input, 3 no valid grid, 130 interrupted",
        rich_markup_mode=None,  # rich costs 0.2 s at every --help
        pretty_exceptions_enable=False,
        context_settings=_SETTINGS,
    )
    if len(commands) > 1:
        app.callback()(options)
    for command in commands:
        if overview:
            app.command(command.name, help=command.summary)(lambda: None)
            continue
        from meshonet_cli.options.groups import expanded

        function, examples = command.loaded()
        epilog = "\n  ".join(["\b\nExamples:", *examples])  # of which \b keeps the lines
        app.command(command.name, epilog=epilog, cls=Plain, context_settings=_SETTINGS)(expanded(function))
    return typer.main.get_command(app)


def run(arguments: Sequence[str]) -> int:
    """Run the command line on `arguments` (without the program's name) and return its exit code."""
    debug = "--debug" in arguments
    words = list(arguments) or ["--help"]
    completion = "_MESHONET_COMPLETE" in os.environ
    alone = words[0] in BY_NAME and not completion
    name = f"meshonet {words[0]}" if alone else "meshonet"
    try:
        commands = [BY_NAME[words[0]]] if alone else COMMANDS
        program = application(commands, overview=not (alone or completion))
        try:
            code: Any = program.main(words[alone:], prog_name=name, standalone_mode=False)
        finally:
            for line in [*LINES]:
                line.stop()
    except (KeyboardInterrupt, typer.Abort):
        return _interrupted()
    except BrokenPipeError:
        return _unread()
    except SystemExit as stop:
        if isinstance(stop.__context__, BrokenPipeError):  # the parser's own way with it, which exits with 1
            return _unread()
        raise
    except Exception as error:  # the last place: whatever it is, the user gets a line and not a traceback
        if debug:
            import traceback

            traceback.print_exc()
        from meshonet_cli.terminal.text import quoted

        print(quoted(f"error: {_explained(error, name)}"), file=sys.stderr)  # noqa: T201
        return int(getattr(error, "exit_code", BAD_INPUT))
    return _interrupted() if code == INTERRUPTED else int(code or 0)


def main() -> NoReturn:
    """Run the command line on the program's arguments and exit."""
    install()
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names from files, on a terminal that lacks them
    words = sys.argv[1:]
    hide_warnings()
    mpi = "--engine=mpi" in words or ("--engine", "mpi") in pairwise(words)
    if mpi:
        from meshonet_cli.batch.executors.mpi_engine import on_ranks

        code = on_ranks(lambda: run(words))
    else:
        code = run(words)
    with contextlib.suppress(BrokenPipeError):
        sys.stdout.flush()
        sys.exit(code)
    _silence_stdout()
    sys.exit(code)


def _explained(error: Exception, name: str) -> str:
    from meshonet_cli.terminal.errors import explained

    usage = getattr(error, "format_message", None)
    if usage is None:
        return explained(error)
    context = getattr(error, "ctx", None)
    page = f"{context.command_path} --help" if context else f"{name} --help"
    message = _nearest(error, " ".join(usage().split()).rstrip("."))
    return f"{message[:1].lower()}{message[1:]}; see {page}"


def _nearest(error: Exception, message: str) -> str:
    """Return the parser's message with a suggestion of the nearest option or choice."""
    from meshonet.geometry.errors import meant

    if hasattr(error, "possibilities"):  # of those that there are, for an option that there is not
        option: str = getattr(error, "option_name", "")
        near = meant(option, error.possibilities or ())
        return f"no such option {option}{'; ' + near.rstrip() if near else ''}"
    choice = re.search(r"'([^']*)' is not one of (.*)", message)
    near = meant(choice[1], re.findall(r"'([^']*)'", choice[2])) if choice else ""
    return f"{message}; {near.rstrip()}" if near else message


def _interrupted() -> int:
    print("interrupted", file=sys.stderr)  # noqa: T201
    return INTERRUPTED


def _unread() -> int:
    """Return the exit code, 0, after the reader of our output has closed it."""
    _silence_stdout()
    return 0


def _silence_stdout() -> None:
    # whoever read our output has gone; the interpreter's flush at exit must not complain about it
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
