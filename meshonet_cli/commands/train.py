"""``meshonet train``."""

from typing import Annotated

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet train airfoils.h5 -o model.safetensors --epochs 24 --log-csv train.csv --resume",
    "meshonet infer airfoil.dat --model model.safetensors --res 200 -o grid.vts",
)


# fmt: off
def train(
    dataset: Annotated[
        list[str],
        typer.Argument(
            metavar="DATASET", show_default=False,
            help="File of O boundaries, e.g. from sample-boundary --family procedural.",
        ),
    ],
    output: Annotated[
        str,
        typer.Option("-o", "--output", metavar="FILE", show_default=False, help="Model file, .safetensors."),
    ],
    epochs: Annotated[int, typer.Option("--epochs", min=1, help="Passes over the shapes.")] = 24,
    batch: Annotated[int, typer.Option("--batch", min=1, help="Shapes a step.")] = 32,
    rate: Annotated[float, typer.Option("--rate", help="Largest learning rate.")] = 2e-3,
    held_out: Annotated[
        int, typer.Option("--held-out", metavar="N", min=1, help="Last shapes, kept for the figures only.")
    ] = 300,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of weights and order.")] = 0,
    threads: Annotated[int, typer.Option("--threads", min=1, help="Threads of torch.")] = 1,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on from the checkpoint beside the output, if there is one.")
    ] = False,
    checkpoint_every: Annotated[
        int, typer.Option("--checkpoint-every", metavar="EPOCHS", min=1, help="Epochs between checkpoints.")
    ] = 1,
    log_csv: Annotated[
        str | None,
        typer.Option("--log-csv", metavar="FILE", show_default=False, help="Append a line an epoch to FILE."),
    ] = None,
    from_format: o.From = None,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Fit the airfoil operator to boundaries (needs the extra `train`)."""
    from meshonet_cli.learning import Run, learn
    from meshonet_cli.session import Session

    sizes = {"epochs": epochs, "batch": batch, "rate": rate, "held_out": held_out, "seed": seed}
    run = Run(output, sizes, threads, resume, checkpoint_every, log_csv)
    return learn(dataset, run, Session(quiet=quiet, as_json=as_json, debug=debug), fmt=from_format)
# fmt: on
