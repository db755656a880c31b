"""One command a file; this is their list, in the order of the help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from meshonet_cli.commands import (
    convert,
    infer,
    models,
    plot,
    quality,
    sample_boundary,
    solve_pde,
    tfi,
    train,
)


class Command(NamedTuple):
    """A command: its name, the function that does it, and examples of its use (run by a test)."""

    name: str
    function: Callable[..., Any]
    examples: tuple[str, ...]

    @property
    def epilog(self) -> str:
        r"""The examples as the end of the help text; ``\b`` keeps their lines."""
        return "\b\nExamples:\n" + "\n".join(f"  {example}" for example in self.examples)


COMMANDS: tuple[Command, ...] = (
    Command("sample-boundary", sample_boundary.sample_boundary, sample_boundary.EXAMPLES),
    Command("tfi", tfi.tfi, tfi.EXAMPLES),
    Command("solve-pde", solve_pde.solve_pde, solve_pde.EXAMPLES),
    Command("train", train.train, train.EXAMPLES),
    Command("infer", infer.infer, infer.EXAMPLES),
    Command("quality", quality.quality, quality.EXAMPLES),
    Command("convert", convert.convert, convert.EXAMPLES),
    Command("plot", plot.plot, plot.EXAMPLES),
    Command("models", models.models, models.EXAMPLES),
)
