"""Progress of a training: a bar on a terminal, otherwise lines, and a CSV file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.output import whole_file
from meshonet_cli.terminal.session import Session
from meshonet_cli.terminal.text import duration

if TYPE_CHECKING:
    from meshonet.solvers.neural.fit.loop import Progress

LINES = 25  # lines about a run where there is no terminal


def result_lines(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield lines of text about the errors of a trained model."""
    name, figures = result["model"], result["figures"]
    if name == "strip":
        network, base = figures["network"]["median"], figures["base"]["median"]
        yield f"held-out error {network:.1e}, without the network {base:.1e} (medians)"
    for head in ("winslow", "variational") if name == "quad" else ():
        error, base = figures[head]["relative_l2"]["median"], figures[head]["base"]
        yield f"held-out distance to {head} grids {error:.1e}, without the network {base:.1e} (medians)"
    for kind in ("train", "test"):
        if kind in figures:
            own = figures[kind]
            yield (
                f"relative L2 error of {own['grids']} {kind} grids {own['median']:.1e} (median), "
                f"{own['worst']:.1e} (worst); boundary off by {own['boundary']:.1e}"
            )


class Log:
    """Listener of a training that shows progress and writes rows to the CSV file `path`, if given.

    A new training overwrites the file; a resumed training first removes the rows after its checkpoint.
    """

    def __init__(self, session: Session, path: str | None, *, resume: bool) -> None:
        self.session, self.path = session, Path(path) if path else None
        self.fresh, self.resume = True, resume
        self.shown = 0
        session.watch()

    def __call__(self, progress: Progress) -> None:
        """Show the progress."""
        parts = ", ".join(f"{name} {value:.2e}" for name, value in progress.parts.items())
        parts = f" ({parts})" if len(progress.parts) > 1 else ""
        left = (progress.epochs - progress.epoch) * progress.seconds / max(progress.done, 1)
        held_out = f", held out {progress.held_out['loss']:.2e}" if "loss" in progress.held_out else ""
        line = (
            f"epoch {progress.epoch}/{progress.epochs}: loss {progress.loss:.3e}{parts}{held_out}, "
            f"rate {progress.rate:.1e}, {progress.speed:.0f} shapes/s, {duration(left)} left"
        )
        due = progress.epoch - self.shown >= progress.epochs // LINES or progress.epoch == progress.epochs
        if not self.session.progress(progress.epoch, progress.epochs, line) and due:
            self.session.note(line)
            self.shown = progress.epoch
        if self.path is not None:
            self._row(self.path, progress)

    def _row(self, path: Path, progress: Progress) -> None:
        row: dict[str, float] = {
            "epoch": progress.epoch,
            "seen": progress.seen,
            "loss": progress.loss,
            **progress.parts,
        }
        row |= {f"held_out_{name}": value for name, value in progress.held_out.items()}
        row |= {"rate": progress.rate, "seconds": progress.seconds}
        if self.fresh:
            kept = _kept(path, progress.epoch) if self.resume else []
            with whole_file(str(path)) as part:
                part.write_text("".join([",".join(row) + "\n", *kept]), encoding="utf-8")
            self.fresh = False
        with path.open("a", encoding="utf-8") as file:
            file.write(",".join(repr(value) for value in row.values()) + "\n")


def _kept(path: Path, epoch: int) -> list[str]:
    """Return the rows of a log before `epoch`."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)[1:]
    except (OSError, ValueError):
        return []
    rows = [line for line in lines if line.endswith("\n") and line.split(",")[0].isdigit()]
    return [line for line in rows if int(line.split(",")[0]) < epoch]
