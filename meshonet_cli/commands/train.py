"""``meshonet train``."""

import json
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet train airfoils.h5 -o model.safetensors --epochs 24 --log-csv train.csv --resume",
    "meshonet infer airfoil.dat --model model.safetensors --res 200 -o grid.vts",
    "meshonet train arches.h5 --model meshonet --epochs 20 --split interpolation -o arch.safetensors",
)

_option, _output = o.option_of(o.METHOD), o.option_of(o.IO)

# fmt: off
Dataset = Annotated[list[str], typer.Argument(
    metavar="DATASET", show_default=False,
    help="Solved grids of one family, from solve-pde, as .h5. The strip operator takes O boundaries "
    "instead, e.g. from sample-boundary --family procedural. The quad operator takes two datasets of the "
    "same domains, one solved by winslow and one by variational, with 33x33 nodes (65x33 around bodies).",
)]
Model = Annotated[str | None, _option(
    "--model", metavar="NAME",
    help="strip (airfoil operator), quad (four-sided operator), meshonet (the paper's), meshonet-hard "
    "(exact boundary), deeponet, pod-deeponet, fno1d, fno2d (the baselines), mionet, mgnet, meshnet "
    "(physics-informed). [default: meshonet for grids, strip for boundaries]",
)]
Split = Annotated[str | None, _option(
    "--split", metavar="HOW|FILE",
    help="Grids kept for the test: interpolation, extrapolation, random, or a file with train or test for "
    "each. [default: as the dataset says]",
)]
Settings = Annotated[list[str] | None, _option(
    "--set", metavar="NAME=VALUE",
    help="Setting of the model, e.g. sensors=80, or a weight of the quad operator's loss, e.g. folds=3; "
    "repeatable. The page on networks of the paper in the documentation lists them.",
)]
Epochs = Annotated[int | None, _option(
    "--epochs", metavar="N", min=1, help="Passes over the shapes. [default: strip 24, quad 64, others 15000]",
)]
Batch = Annotated[int | None, _option(
    "--batch", metavar="N", min=1, help="Shapes per step. [default: strip 32, quad 64, others 30]",
)]
Rate = Annotated[float | None, _option(
    "--rate", "--lr", metavar="R",
    help="Largest learning rate. [default: strip 0.002, quad 0.003, others 0.001]",
)]
Schedule = Annotated[Literal["cosine", "step"] | None, _option(
    "--schedule", metavar="cosine|step",
    help="Learning rate: cosine falls to zero; step is times 0.9 after each fifteenth part of the training. "
    "[default: strip and quad cosine, others step]",
)]
Points = Annotated[str | None, _option(
    "--points", metavar="N|all",
    help="Points of the grid drawn at random for each step, a sixth of them on the boundary. [default: 1200]",
)]
HeldOut = Annotated[int | None, _option(
    "--held-out", metavar="N", min=0,
    help="Shapes kept out of training, to watch the loss. [default: strip the last 300, quad 600, others "
    "none]",
)]
Initial = Annotated[str | None, _option(
    "--initial", metavar="NAME|PATH", help="Quad model to start from. [default: random weights]",
)]
Patience = Annotated[int | None, _option(
    "--patience", metavar="EPOCHS", min=1,
    help="Stop when the loss of the shapes held out has not fallen for this many epochs; keep the best "
    "weights.",
)]
Seed = Annotated[int, _option(
    "--seed", metavar="S", min=0, show_default=True,
    help="Seed of the first weights, the order of shapes and the points drawn.",
)]
Threads = Annotated[int, _option(
    "--threads", metavar="N", min=1, show_default=True, help="Threads of torch.",
)]
DeviceName = Annotated[Literal["auto", "cpu", "cuda"] | None, _option(
    "--device", metavar="auto|cpu|cuda",
    help="Where to compute; auto takes CUDA where torch sees it. [default: strip and quad cpu, others auto]",
)]
Amp = Annotated[bool, _option(
    "--amp", help="Multiply in bfloat16 where that is safe; twice as slow on a CPU without units for it.",
)]
Compile = Annotated[bool, _option(
    "--compile",
    help="Compile the step first (torch.compile; needs a C++ compiler); no gain for small models on a CPU.",
)]
Resume = Annotated[bool, _option(
    "--resume", help="Continue from the checkpoint beside the output, if there is one.",
)]
CheckpointEvery = Annotated[int | None, _option(
    "--checkpoint-every", metavar="EPOCHS", min=1,
    help="Epochs between checkpoints. [default: strip and quad 1, others a two-hundredth of all]",
)]
LogCsv = Annotated[str | None, _output(
    "--log-csv", metavar="FILE", help="Write loss, its parts, rate and time to FILE.",
)]
# fmt: on


@o.expanded
def train(
    dataset: Dataset,
    output: Annotated[str, _output("-o", "--output", metavar="FILE", help="Model file, .safetensors.")],
    printing: o.PrintOptions, model: Model = None, split: Split = None, settings: Settings = None,
    epochs: Epochs = None, batch: Batch = None, rate: Rate = None, schedule: Schedule = None,
    points: Points = None, held_out: HeldOut = None, initial: Initial = None, patience: Patience = None,
    seed: Seed = 0, threads: Threads = 1, device: DeviceName = None, amp: Amp = False,
    compiled: Compile = False, resume: Resume = False, checkpoint_every: CheckpointEvery = None,
    log_csv: LogCsv = None, from_format: o.From = None,
) -> int:  # fmt: skip
    """Fit a neural operator to datasets (needs the extra `train`).

    Several processes under torchrun share each step.
    """
    from meshonet.api.train import train as fit
    from meshonet_cli.report.training import Log, result_lines

    session = printing.session()
    result = fit(
        dataset, output, model=model, settings=_values(settings or ()), split=split, held_out=held_out,
        initial=initial, resume=resume, threads=threads, from_format=from_format,
        report=Log(session, log_csv, resume=resume), note=session.note,
        epochs=epochs, batch=batch, rate=rate, schedule=schedule, points=points, seed=seed,
        patience=patience, device=device, amp=amp, compiled=compiled, checkpoint_every=checkpoint_every,
    )  # fmt: skip
    if result and session.as_json:
        session.result({"output": output, **result})
    for line in result_lines(result) if result else ():
        session.note(f"{output}: {line}")
    return session.finish()


def _values(words: Sequence[str]) -> dict[str, Any]:
    """Return the values of ``name=value`` words by name, read as JSON where they are that."""
    values: dict[str, Any] = {}
    for word in words:
        name, mark, text = word.partition("=")
        if not mark:
            raise o.bad_value(word, "NAME=VALUE", "use e.g. sensors=80", "settings")
        try:
            values[name] = json.loads(text)
        except ValueError:
            values[name] = text
    return values
