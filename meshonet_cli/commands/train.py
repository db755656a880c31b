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

    model: str | None = _option(
        metavar="NAME", help="Architecture. strip: operator for airfoils. quad: operator for four-sided "
        "domains. meshonet: network of the MeshONet paper. meshonet-hard: variant with exact boundary "
        "nodes. Baselines: deeponet, pod-deeponet, fno1d, fno2d, wno, kno, lno, mionet. Physics-informed: "
        "mgnet, meshnet. [default: strip for datasets of boundaries, else meshonet]",
    )
    split: str | None = _option(
        metavar="HOW|FILE", help="Choice of the shapes reserved for tests. interpolation: from the middle of "
        "the parameter range. extrapolation: from one end of it. random: at random. FILE: a file with the "
        "word train or test for each shape. [default: the split stored in the dataset]",
    )
    epochs: int | None = _option(
        metavar="N", min=1, help="Number of passes over the shapes. [default: strip 24, quad 64, others "
        "15000]",
    )
    batch: int | None = _option(
        metavar="N", min=1, help="Number of shapes per optimiser step. [default: strip 32, quad 64, others "
        "30]",
    )
    rate: float | None = _option(
        "--rate", "--lr", metavar="R", help="Largest learning rate. [default: strip 0.002, quad 0.003, "
        "others 0.001]",
    )
    schedule: Literal["cosine", "step"] | None = _option(
        help="Decrease of the learning rate. cosine: to zero. step: times 0.9 after each of 15 "
        "equal parts of the training. [default: cosine for strip and quad, else step]",
    )
    points: str | None = _option(
        metavar="N|all", help="Number of random grid points for each step, a sixth of them on the boundary. "
        "all: all points. [default: 1200]",
    )
    held_out: int | None = _option(
        metavar="N", min=0, help="Number of shapes that only monitor the loss and are not used for training. "
        "[default: strip the last 300, quad 600, others 0]",
    )
    initial: str | None = _option(
        metavar="NAME|PATH", help="Model from whose weights the training of a quad operator starts. "
        "[default: random weights]",
    )
    patience: int | None = _option(
        metavar="EPOCHS", min=1, help="Stop when the loss on the held-out shapes has not decreased for this "
        "many epochs, and keep the best weights. [default: never]",
    )
    seed: int = _option(
        default=0, metavar="S", min=0, help="Seed of the initial weights, the order of the shapes and the "
        "random points.",
    )
    threads: int = _option(default=1, metavar="N", min=1, help="Number of threads of torch.")
    device: Literal["auto", "cpu", "cuda"] | None = _option(
        help="Device for the training. auto: cuda if torch finds it, else cpu. [default: cpu for strip and "
        "quad, auto for others]",
    )
    amp: bool = _option(
        default=False, help="Multiply matrices in bfloat16 where the accuracy permits. On a CPU without "
        "bfloat16 units this takes twice as long.",
    )
    compiled: bool = _option(
        "--compile", default=False, help="Compile the training step with torch.compile, which needs a C++ "
        "compiler. Small models on a CPU do not become faster.",
    )
    resume: bool = _option(
        default=False, help="Continue from the checkpoint next to the output, if it exists.",
    )
    checkpoint_every: int | None = _option(
        metavar="EPOCHS", min=1, help="Number of epochs between checkpoints. [default: 1 for strip and "
        "quad, a two-hundredth of all epochs for others]",
    )
    from_format: o.From = None


def train(
    dataset: Annotated[list[str], typer.Argument(
        metavar="DATASET", show_default=False,
        help="An .h5 file with grids of one family, made by solve-pde. --model strip needs boundaries of O "
        "grids instead, e.g. from sample-boundary --family procedural. --model quad needs two datasets of "
        "the same domains with 33x33 nodes (65x33 around bodies): one made by winslow, one by variational. "
        "--model meshnet also accepts volumes.",
    )],
    output: Annotated[str, _output(
        "-o", "--output", metavar="FILE", help="Model file to write, .safetensors.",
    )],
    printing: o.PrintOptions,
    options: TrainOptions,
    settings: list[str] | None = _option(
        metavar="NAME=VALUE", help="Set a parameter of the model, e.g. sensors=80, or a weight in the loss "
        "of the quad operator, e.g. folds=3. The documentation's page on operators of the MeshONet paper "
        "lists all. Repeatable.",
    ),
    log_csv: str | None = _output(
        metavar="FILE", help="Write the loss, its terms, the learning rate and the time of each epoch to a "
        "CSV file.",
    ),
) -> int:
    """Train a neural operator on datasets.

    This needs the extra `train`. If torchrun starts several processes, they share each training step.
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
    """Return the values of ``name=value`` words by name, read as JSON where possible."""
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
