"""``meshonet train``."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
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
@dataclass(frozen=True, kw_only=True)
class TrainOptions:
    """Parameters of `meshonet.train`."""

    model: Annotated[str | None, _option(
        "--model", metavar="NAME",
        help="strip (airfoil operator), quad (four-sided operator), meshonet (the paper's), meshonet-hard "
        "(exact boundary), deeponet, pod-deeponet, fno1d, fno2d (the baselines), mionet, mgnet, meshnet "
        "(physics-informed). [default: meshonet for grids, strip for boundaries]",
    )] = None
    split: Annotated[str | None, _option(
        "--split", metavar="HOW|FILE",
        help="Grids kept for the test: interpolation, extrapolation, random, or a file with train or test "
        "for each. [default: as the dataset says]",
    )] = None
    epochs: Annotated[int | None, _option(
        "--epochs", metavar="N", min=1, help="Passes over the shapes. [default: strip 24, quad 64, others "
        "15000]",
    )] = None
    batch: Annotated[int | None, _option(
        "--batch", metavar="N", min=1, help="Shapes per step. [default: strip 32, quad 64, others 30]",
    )] = None
    rate: Annotated[float | None, _option(
        "--rate", "--lr", metavar="R",
        help="Largest learning rate. [default: strip 0.002, quad 0.003, others 0.001]",
    )] = None
    schedule: Annotated[Literal["cosine", "step"] | None, _option(
        "--schedule", metavar="cosine|step",
        help="Learning rate: cosine falls to zero; step is times 0.9 after each fifteenth part of the "
        "training. [default: strip and quad cosine, others step]",
    )] = None
    points: Annotated[str | None, _option(
        "--points", metavar="N|all",
        help="Points of the grid drawn at random for each step, a sixth of them on the boundary. [default: "
        "1200]",
    )] = None
    held_out: Annotated[int | None, _option(
        "--held-out", metavar="N", min=0,
        help="Shapes kept out of training, to watch the loss. [default: strip the last 300, quad 600, others "
        "none]",
    )] = None
    initial: Annotated[str | None, _option(
        "--initial", metavar="NAME|PATH", help="Quad model to start from. [default: random weights]",
    )] = None
    patience: Annotated[int | None, _option(
        "--patience", metavar="EPOCHS", min=1,
        help="Stop when the loss of the shapes held out has not fallen for this many epochs; keep the best "
        "weights.",
    )] = None
    seed: Annotated[int, _option(
        "--seed", metavar="S", min=0, show_default=True,
        help="Seed of the first weights, the order of shapes and the points drawn.",
    )] = 0
    threads: Annotated[int, _option(
        "--threads", metavar="N", min=1, show_default=True, help="Threads of torch.",
    )] = 1
    device: Annotated[Literal["auto", "cpu", "cuda"] | None, _option(
        "--device", metavar="auto|cpu|cuda",
        help="Where to compute; auto takes CUDA where torch sees it. [default: strip and quad cpu, others "
        "auto]",
    )] = None
    amp: Annotated[bool, _option(
        "--amp", help="Multiply in bfloat16 where that is safe; twice as slow on a CPU without units for it.",
    )] = False
    compiled: Annotated[bool, _option(
        "--compile",
        help="Compile the step first (torch.compile; needs a C++ compiler); no gain for small models on a "
        "CPU.",
    )] = False
    resume: Annotated[bool, _option(
        "--resume", help="Continue from the checkpoint beside the output, if there is one.",
    )] = False
    checkpoint_every: Annotated[int | None, _option(
        "--checkpoint-every", metavar="EPOCHS", min=1,
        help="Epochs between checkpoints. [default: strip and quad 1, others a two-hundredth of all]",
    )] = None
    from_format: o.From = None


def train(
    dataset: Annotated[list[str], typer.Argument(
        metavar="DATASET", show_default=False,
        help="Solved grids of one family, from solve-pde, as .h5. The strip operator takes O boundaries "
        "instead, e.g. from sample-boundary --family procedural. The quad operator takes two datasets of the "
        "same domains, one solved by winslow and one by variational, with 33x33 nodes (65x33 around bodies).",
    )],
    output: Annotated[str, _output("-o", "--output", metavar="FILE", help="Model file, .safetensors.")],
    printing: o.PrintOptions,
    options: TrainOptions,
    settings: Annotated[list[str] | None, _option(
        "--set", metavar="NAME=VALUE",
        help="Setting of the model, e.g. sensors=80, or a weight of the quad operator's loss, e.g. folds=3; "
        "repeatable. The page on networks of the paper in the documentation lists them.",
    )] = None,
    log_csv: Annotated[str | None, _output(
        "--log-csv", metavar="FILE", help="Write loss, its parts, rate and time to FILE.",
    )] = None,
) -> int:
    """Fit a neural operator to datasets (needs the extra `train`).

    Several processes under torchrun share each step.
    """
    from meshonet.api.train import train as fit
    from meshonet_cli.report.training import Log, result_lines

    session = printing.session()
    result = fit(
        dataset, output, settings=_values(settings or ()), note=session.note,
        report=Log(session, log_csv, resume=options.resume), **vars(options),
    )
    if result and session.as_json:
        session.result({"output": output, **result})
    for line in result_lines(result) if result else ():
        session.note(f"{output}: {line}")
    return session.finish()
# fmt: on


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
