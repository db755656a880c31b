"""What `train` does: datasets to strips, strips to a model, told epoch by epoch."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from formats.registry import read_shapes
from geometry.boundary import Boundary
from geometry.errors import InputError
from geometry.sampling import Sampling
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from solvers.neural.training import Report


@dataclass(frozen=True)
class Run:
    """Settings of a training run: output file, sizes for `solvers.neural.training.Settings`, and the rest."""

    output: str
    sizes: Mapping[str, Any]
    threads: int
    resume: bool
    checkpoint_every: int
    log_csv: str | None


def learn(sources: Sequence[str], run: Run, session: Session, *, fmt: str | None = None) -> int:
    """Fit a model to the boundaries of `sources` and return the exit code.

    Raises
    ------
    InputError
        torch is not installed; the output is no ``.safetensors`` file in a folder that exists; bad sizes or
        boundaries.
    """
    output = _checked_output(run.output)
    try:
        import torch
    except ImportError:
        raise InputError("training needs torch", "install it: pip install 'meshonet[train]'") from None
    from solvers.neural.dataset import solve_strips
    from solvers.neural.training import Settings, train

    if not 0 < run.sizes["rate"] < 1:
        raise InputError(f"--rate {run.sizes['rate']:g}", "use a rate between 0 and 1, e.g. 0.002")
    torch.set_num_threads(run.threads)
    strips = solve_strips(_boundaries(sources, fmt), _Progress(session))
    session.note(f"{len(strips)} shapes lifted and solved")
    figures = train(
        strips,
        output,
        Settings(**run.sizes),
        name=output.stem,
        recipe={"command": "meshonet train", "datasets": [Path(s).name for s in sources]},
        resume=run.resume,
        checkpoint_every=run.checkpoint_every,
        report=_Log(session, run),
    )
    if session.as_json:
        session.result({"output": run.output, "shapes": len(strips), "figures": figures})
    else:
        network, base = figures["network"]["median"], figures["base"]["median"]
        session.note(f"{run.output}: held-out error {network:.1e}, without the network {base:.1e} (medians)")
    return session.finish()


def _checked_output(text: str) -> Path:
    path = Path(text)
    if path.suffix != ".safetensors":
        raise InputError("a model file ends in .safetensors", "rename the output", source=text)
    if not path.parent.is_dir():
        raise InputError(f"no folder {path.parent}", "make it first", source=text)
    return path


def _boundaries(sources: Sequence[str], fmt: str | None) -> Iterator[Boundary]:
    for source in sources:
        for shape in read_shapes(source, fmt):
            yield shape.boundary(Sampling(topology="o"))


class _Progress:
    """Every five hundred shapes, a line."""

    def __init__(self, session: Session) -> None:
        self.session = session

    def __call__(self, done: int, left_out: int) -> None:
        if done and done % 500 == 0:
            self.session.note(f"{done} shapes lifted and solved, {left_out} left out")


class _Log:
    """A line an epoch to the terminal, and to a CSV file when one is asked for."""

    def __init__(self, session: Session, run: Run) -> None:
        self.session, self.epochs = session, run.sizes["epochs"]
        self.path = Path(run.log_csv) if run.log_csv else None

    def __call__(self, report: Report) -> None:
        left = (self.epochs - report.epoch) * report.seconds
        self.session.note(
            f"epoch {report.epoch}/{self.epochs}  loss {report.loss:.5f}  held-out error "
            f"{report.median:.1e} (p90 {report.p90:.1e})  {report.seconds:.1f} s, {left / 60:.0f} min left"
        )
        if self.path is not None:
            row = dataclasses.asdict(report)
            head = "" if self.path.exists() else ",".join(row) + "\n"
            with self.path.open("a", encoding="utf-8") as file:
                file.write(head + ",".join(repr(value) for value in row.values()) + "\n")
