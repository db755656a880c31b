"""How a training run is followed: a bar on a terminal, lines elsewhere, a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from meshonet.formats.output import whole_file
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from meshonet.solvers.neural.fit.loop import Progress
    from meshonet.solvers.neural.fit.plan import Plan

LINES = 25
"""Told of a run where there is no terminal."""


class Log:
    """Told of progress.

    Parameters
    ----------
    session : where it is told.
    path : CSV file to which a row a report is added, or None. A run that begins anew begins it anew; one that
        goes on cuts the rows after its checkpoint.
    leads : whether this process writes it.
    """

    def __init__(self, session: Session, plan: Plan, path: str | None, *, resume: bool, leads: bool) -> None:
        self.session, self.path = session, Path(path) if path and leads else None
        self.fresh, self.resume = True, resume
        self.every = max(1, plan.epochs // (LINES * plan.log_every)) * plan.log_every

    def __call__(self, told: Progress) -> None:
        """Tell of it."""
        parts = ", ".join(f"{name} {value:.2e}" for name, value in told.parts.items())
        parts = f" ({parts})" if len(told.parts) > 1 else ""
        left = (told.epochs - told.epoch) * told.seconds / max(told.done, 1)
        held_out = f", held out {told.held_out['loss']:.2e}" if "loss" in told.held_out else ""
        line = (
            f"epoch {told.epoch}/{told.epochs}: loss {told.loss:.3e}{parts}{held_out}, rate {told.rate:.1e}, "
            f"{told.speed:.0f} shapes/s, {_time(left)} left"
        )
        if not self.session.progress(told.epoch, told.epochs, line) and (
            told.epoch % self.every == 0 or told.epoch == told.epochs
        ):
            self.session.note(line)
        if self.path is not None:
            self._row(self.path, told)

    def _row(self, path: Path, told: Progress) -> None:
        row: dict[str, float] = {"epoch": told.epoch, "seen": told.seen, "loss": told.loss, **told.parts}
        row |= {f"held_out_{name}": value for name, value in told.held_out.items()}
        row |= {"rate": told.rate, "seconds": told.seconds}
        if self.fresh:
            kept = _kept(path, told.epoch) if self.resume else []
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


def _time(seconds: float) -> str:
    """Return a span of time for people.

    Examples
    --------
    >>> _time(42.0), _time(600.0), _time(9000.0)
    ('42 s', '10 min', '2.5 h')
    """
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
