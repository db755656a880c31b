"""``meshonet train``."""

from typing import Annotated, Literal

import typer

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet train airfoils.h5 -o model.safetensors --epochs 24 --log-csv train.csv --resume",
    "meshonet infer airfoil.dat --model model.safetensors --res 200 -o grid.vts",
    "meshonet train arches.h5 --model meshonet --epochs 20 --split interpolation -o arch.safetensors",
)

# fmt: off
Dataset = Annotated[
    list[str],
    typer.Argument(
        metavar="DATASET", show_default=False,
        help="Solved grids of one family (solve-pde, .h5); for the strip operator O boundaries, e.g. from "
        "sample-boundary --family procedural; for the quad operator 33x33 grids of the same domains (65x33 "
        "around bodies) by winslow and by variational, a dataset each.",
    ),
]
Model = Annotated[
    str | None,
    typer.Option(
        "--model", metavar="NAME", show_default=False,
        help="strip (airfoil operator), quad (four-sided operator), meshonet (the paper's), meshonet-hard "
        "(exact boundary), deeponet, pod-deeponet, fno1d, fno2d (the baselines), mionet, mgnet, meshnet "
        "(physics-informed). "
        "[default: meshonet for grids, strip for boundaries]",
    ),
]
Split = Annotated[
    str | None,
    typer.Option(
        "--split", metavar="HOW|FILE", show_default=False,
        help="Grids not to train on: interpolation, extrapolation, random, or a file with train or test for "
        "each. [default: as the dataset says]",
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="NAME=VALUE", show_default=False,
        help="Setting of the model, e.g. sensors=80, or a weight of the quad operator's loss, e.g. folds=3; "
        "repeatable. The page docs/paper-models.md lists them.",
    ),
]
Epochs = Annotated[
    int | None,
    typer.Option(
        "--epochs", metavar="N", min=1, show_default=False,
        help="Passes over the shapes. [default: strip 24, quad 64, others 15000]",
    ),
]
Batch = Annotated[
    int | None,
    typer.Option(
        "--batch", metavar="N", min=1, show_default=False,
        help="Shapes a step. [default: strip 32, quad 64, others 30]",
    ),
]
Rate = Annotated[
    float | None,
    typer.Option(
        "--rate", "--lr", metavar="R", show_default=False,
        help="Largest learning rate. [default: strip 0.002, quad 0.003, others 0.001]",
    ),
]
Schedule = Annotated[
    Literal["cosine", "step"] | None,
    typer.Option(
        "--schedule", metavar="cosine|step", show_default=False,
        help="Learning rate: cosine to zero, or times 0.9 every fifteenth of the epochs. [default: strip "
        "and quad cosine, others step]",
    ),
]
Points = Annotated[
    str | None,
    typer.Option(
        "--points", metavar="N|all", show_default=False,
        help="Places of the grid drawn at random for a step, a sixth on the boundary. [default: 1200]",
    ),
]
HeldOut = Annotated[
    int | None,
    typer.Option(
        "--held-out", metavar="N", min=0, show_default=False,
        help="Shapes to train on that are kept out, to watch the loss. [default: strip the last 300, quad "
        "600, others none]",
    ),
]
Initial = Annotated[
    str | None,
    typer.Option(
        "--initial", metavar="NAME|PATH", show_default=False,
        help="Quad model whose weights are the first ones. [default: random]",
    ),
]
Patience = Annotated[
    int | None,
    typer.Option(
        "--patience", metavar="EPOCHS", min=1, show_default=False,
        help="Stop when the loss of the shapes held out has not fallen for so long; keep the best weights.",
    ),
]
Seed = Annotated[int, typer.Option("--seed", metavar="S", min=0, help="Of weights, order and places.")]
Threads = Annotated[int, typer.Option("--threads", metavar="N", min=1, help="Threads of torch.")]
DeviceName = Annotated[
    Literal["auto", "cpu", "cuda"] | None,
    typer.Option(
        "--device", metavar="auto|cpu|cuda", show_default=False,
        help="Where to compute; auto takes CUDA where torch sees it. [default: strip and quad cpu, others "
        "auto]",
    ),
]
Amp = Annotated[
    bool,
    typer.Option(
        "--amp",
        help="Multiply in bfloat16 where that is safe; a CPU without units for it takes twice the time.",
    ),
]
Compile = Annotated[
    bool,
    typer.Option(
        "--compile",
        help="Compile the step first (torch.compile; needs a C++ compiler); it gains nothing on small models "
        "on a CPU.",
    ),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on from the checkpoint beside the output, if there is one.")
]
CheckpointEvery = Annotated[
    int | None,
    typer.Option(
        "--checkpoint-every", metavar="EPOCHS", min=1, show_default=False,
        help="Epochs between checkpoints. [default: strip and quad 1, others a two-hundredth of all]",
    ),
]
LogCsv = Annotated[
    str | None,
    typer.Option(
        "--log-csv", metavar="FILE", show_default=False, help="Write loss, its parts, rate and time to FILE."
    ),
]
# fmt: on


def train(
    dataset: Dataset,
    output: Annotated[
        str,
        typer.Option("-o", "--output", metavar="FILE", show_default=False, help="Model file, .safetensors."),
    ],
    model: Model = None,
    split: Split = None,
    settings: Settings = None,
    epochs: Epochs = None,
    batch: Batch = None,
    rate: Rate = None,
    schedule: Schedule = None,
    points: Points = None,
    held_out: HeldOut = None,
    initial: Initial = None,
    patience: Patience = None,
    seed: Seed = 0,
    threads: Threads = 1,
    device: DeviceName = None,
    amp: Amp = False,
    compiled: Compile = False,
    resume: Resume = False,
    checkpoint_every: CheckpointEvery = None,
    log_csv: LogCsv = None,
    from_format: o.From = None,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Fit a neural operator (needs the extra `train`); several processes under torchrun share each step."""
    from meshonet_cli.learning import Run, learn
    from meshonet_cli.session import Session

    plan = {
        "epochs": epochs, "batch": batch, "rate": rate, "schedule": schedule, "points": points, "seed": seed,
        "patience": patience, "device": device, "amp": amp, "compiled": compiled,
        "checkpoint_every": checkpoint_every,
    }  # fmt: skip
    run = Run(output, model, plan, settings or (), split, held_out, threads, resume, log_csv, initial)
    return learn(dataset, run, Session(quiet=quiet, as_json=as_json, debug=debug), fmt=from_format)
