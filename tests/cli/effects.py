"""What every option of every command changes.

`EFFECTS` says for each option the words of the run before, the words added, and what is to differ:

- code: the exit code; says, prints: whether there is anything on standard error or standard output;
- out: standard output; error: standard error;
- files: names of files that appear; layout: how the file written begins; bytes: all of it;
- nodes: coordinates of what is written; weights: arrays of a model; figures: rows of the log;
- workers: whether other processes worked.

The files of the words are those of option_inputs.py.
"""

from option_inputs import TORCH

Effect = tuple[str, str, str]
"""Words of the run before, words added (OPTION stands for the spelling), what differs."""

BODY, GRID, LAYERS = "naca:2412 --res 41x15", "grid.h5", "naca:2412 --res 61x41 --first-cell 1e-3"
MADE = "-o made.h5 -q"
SHIFT = "--shift south=0,-.1"
SUNK = f"grid.h5 {SHIFT}"


def printing(base: str, missing: str) -> dict[str, Effect]:
    """What a run prints, and one whose input is missing."""
    return {
        "--json": (base, "OPTION", "prints"),
        "--quiet": (base, "OPTION", "says"),
        "--debug": (missing, "OPTION", "error"),
    }


def files(base: str, unnamed: str = "odd.name", made: str = "h5", kind: str = "hdf5") -> dict[str, Effect]:
    """Files of a run and of one whose input says nothing of its format, written as `made`, called `kind`."""
    return {
        "--output": (f"{base} -o made.{made} -q", f"OPTION other.{made}", "files"),
        "--from": (f"{unnamed} -o made.{made} -q", "OPTION vts", "code"),
        "--to": (f"{base} -o made.name", f"OPTION {kind}", "code"),
        "--skip-existing": (f"{base} -o there.{made} -q", "OPTION", "layout"),
    }


def chosen(base: str, pattern: str, differs: str = "files") -> dict[str, Effect]:
    """Inputs of a list of two, by a pattern and by a share."""
    return {"--pick": (base, f"OPTION {pattern}", differs), "--shard": (base, "OPTION 2/2", differs)}


def engines(base: str) -> dict[str, Effect]:
    """A run of several inputs: each of these reaches the engine, which refuses some together."""
    return {
        "--jobs": (f"{base} --engine mpi", "OPTION 2", "error"),
        "--engine": (base, "OPTION mpi", "code"),
        "--scheduler": (base, "OPTION tcp://a:1", "code"),
    }


def flat_plate(base: str, differs: str = "nodes") -> dict[str, Effect]:
    """First cells by their y+."""
    base = f"{base} --y-plus 90 --reynolds 1e5"
    return {
        "--y-plus": (base, "OPTION 80", differs),
        "--reynolds": (base, "OPTION 2e5", differs),
        "--length": (base, "OPTION .5", differs),
    }


def judged(base: str, folded: str) -> dict[str, Effect]:
    """What is refused of a run, and of one whose cells fold; threads, of which there is no none."""
    return {
        "--threads": (f"{base} --threads 2", "OPTION 0", "code"),
        "--fail-on": (base, "OPTION max_angle>90.5", "code"),
        "--leave-out-failed": (f"{base} --fail-on max_angle>90.5", "OPTION", "files"),
        "--allow-invalid": (folded, "OPTION", "code"),
    }


COMMON = printing(f"{GRID} -o made.h5", f"missing.h5 {MADE}") | files(GRID)
MANY = "three.h5 -o {name}.h5 -q"
SHAPES = COMMON | chosen("@shapes.txt -o made-{stem}.h5 -q", "*C*") | engines(MANY) | {
    "--part-size": ("three.h5 -o made.h5 -q", "OPTION 2", "files"),
    "--res": (f"naca:2412 {MADE}", "OPTION 31x9", "nodes"),
    "--topology": (f"{BODY} {MADE}", "OPTION c", "nodes"),
    "--spacing": (f"{BODY} {MADE}", "OPTION cosine", "nodes"),
    "--le-spacing": (f"{BODY} {MADE}", "OPTION .02", "nodes"),
    "--te-spacing": (f"{BODY} {MADE}", "OPTION .02", "nodes"),
    "--te": (f"{BODY} {MADE}", "OPTION wedge", "nodes"),
    "--base": (f"{BODY} {MADE}", "OPTION .02", "nodes"),
    "--far-field": (f"{BODY} {MADE}", "OPTION 7", "nodes"),
    "--wake": (f"{BODY} --topology c {MADE}", "OPTION 9", "nodes"),
    "--wake-nodes": (f"{BODY} --topology c {MADE}", "OPTION 11", "nodes"),
    "--base-nodes": (f"naca:2412 --res 61x15 {MADE}", "OPTION 11", "nodes"),
    "--smooth": (f"large.dat --res 41x15 {MADE}", "OPTION 1e-3", "nodes"),
    "--corners": (f"box.csv --res 11 {MADE}", "OPTION 1,2,3,0", "nodes"),
    "--normalise": (f"large.dat --res 41x15 {MADE}", "OPTION", "nodes"),
}  # fmt: skip
GRIDS = (
    SHAPES
    | judged(f"{GRID} {MADE}", f"open.h5 {MADE}")
    | {"--profile": ("grid.h5 grid.h5 -o made.h5", "OPTION viscous", "out")}
    | flat_plate(f"naca:2412 --res 61x41 {MADE}")
    | {
        "--first-cell": (f"naca:2412 --res 41x41 {MADE}", "OPTION 1e-3", "nodes"),
        "--chord-fraction": (
            f"naca:2412 --res 61x41 --y-plus 90 --reynolds 1e5 {MADE}",
            "OPTION .1",
            "nodes",
        ),
        "--growth": (f"naca:2412 --res 61x61 --first-cell 1e-3 {MADE}", "OPTION 1.25", "nodes"),
        "--constant-layers": (f"{LAYERS} {MADE}", "OPTION 5", "nodes"),
    }
)
SIDES = {
    f"--spacing-{side}": (f"{GRID} {MADE}", "OPTION .01", "nodes")
    for side in ("south", "north", "west", "east")
}
DOMAINS = {
    "--assemble": ("square.csv bolt.csv --res 9 -o {stem}.h5 -q", "OPTION", "files"),
    "--cells": (f"step.wkt {MADE}", "OPTION 400", "nodes"),
    "--cell-size": (f"step.wkt {MADE}", "OPTION .2", "nodes"),
    "--layout": (f"step.wkt --cells 400 {MADE}", "OPTION tall.json", "nodes"),
    "--periodic": (f"named.geojson {MADE}", "OPTION left,right", "nodes"),
    "--count": (f"named.geojson {MADE}", "OPTION left=9", "nodes"),
    "--pitch": (f"naca:0012 --cells 900 {MADE}", "OPTION 0,0", "code"),
    "--inlet": (f"naca:0012 --cells 900 {MADE}", "OPTION .7", "code"),
    "--outlet": (f"naca:0012 --cells 900 {MADE}", "OPTION .7", "code"),
}
BLOCKS = DOMAINS | {
    "--blocks": (f"step.wkt --res 21 {MADE}", "OPTION single", "nodes"),
    "--walls": (f"hole.wkt --cells 900 --first-cell .02 {MADE}", "OPTION bolt", "error"),
}
BALL = f"ball.xyz --first-cell .01 --far-field 3 {MADE}"
MARCHED = {
    "--layers": (BALL, "OPTION 9", "nodes"),
    "--energy": (f"bent.vts --res 5 {MADE}", "OPTION shape", "nodes"),
    "--symmetry": (f"cap.xyz --first-cell .01 --layers 9 --far-field 3 {MADE}", "OPTION none", "nodes"),
    "--poles": (f"nose.xyz --first-cell .01 --layers 9 --far-field 3 {MADE}", "OPTION refuse", "code"),
}
TRAINING = "arches.h5 --epochs 4 --points 60 --batch 4 -o new.safetensors"
PICTURE = printing(f"{GRID} -o made.png", "missing.h5 -o made.png") | files(GRID, made="png", kind="png")
LAYOUT = printing("step.wkt -o made.json", "missing.wkt -o made.json") | files("step.wkt", made="json")
WING, PIPE = "short.toml --around 33 --span 7 --layers 12", "circle:.5 path.csv --around 16"
EFFECTS: dict[str, dict[str, Effect]] = {
    "sample-boundary": SHAPES | {
        "--family": (f"--res 9 {MADE}", "OPTION arch", "code"),
        "--count": ("--family arch --res 9 -o {name}.h5 -q", "OPTION 3", "files"),
        "--range": (f"--family arch --res 9 {MADE}", "OPTION .1:.2", "nodes"),
        "--seed": (f"--family arch --res 9 {MADE}", "OPTION 7", "nodes"),
        "--split": (f"--family arch --count 9 --res 9 {MADE}", "OPTION random", "layout"),
        "--sensors": (f"{GRID} {MADE}", "OPTION 9", "layout"),
    },
    "tfi": GRIDS | SIDES | {
        "--growth": (f"{GRID} --spacing-south .005 {MADE}", "OPTION 1.5", "nodes"),
        "--method": (f"{GRID} {MADE}", "OPTION winslow", "code"),
        "--blending": (f"box.csv --res 11 --spacing cosine {MADE}", "OPTION linear", "nodes"),
        "--repair": (f"wave.h5 {MADE}", "OPTION", "code"),
        "--no-repair": (f"wave.h5 --repair {MADE}", "OPTION", "code"),
    },
    "solve-pde": GRIDS | SIDES | BLOCKS | MARCHED | {
        "--layers": (f"{BALL} --method hyperbolic", "OPTION 9", "nodes"),
        "--method": (f"{GRID} {MADE}", "OPTION variational", "nodes"),
        "--tol": (f"wrench.h5 {MADE}", "OPTION .1", "nodes"),
        "--max-cycles": (f"wrench.h5 {MADE}", "OPTION 1", "nodes"),
        "--coarse": (f"{GRID} {MADE}", "OPTION 9", "nodes"),
        "--refine": (f"{GRID} {MADE}", "OPTION 1", "nodes"),
        "--initial": (f"{GRID} {MADE}", "OPTION grid.h5", "nodes"),
        "--history": (f"{GRID} {MADE}", "OPTION cycles.csv", "files"),
        "--slide": (f"{GRID} {MADE}", "OPTION", "nodes"),
        "--no-slide": (f"hump.csv --res 41x21 --corners 0,2,3,4 --first-cell .01 {MADE}", "OPTION", "nodes"),
        "--wall-angle": (f"{GRID} --method steger-sorenson {MADE}", "OPTION 80", "nodes"),
        "--repair": (f"wrench.h5 --no-repair --tol 1e-6 {MADE}", "OPTION", "code"),
        "--no-repair": (f"wrench.h5 --tol 1e-6 {MADE}", "OPTION", "code"),
        "--repair-margin": (f"wrench.h5 --tol 1e-6 {MADE}", "OPTION 12", "nodes"),
    },
    "infer": GRIDS | BLOCKS | MARCHED | {
        "--jobs": (MANY, "OPTION 2", "workers"),
        "--model": (f"{BODY} {MADE}", "OPTION airfoil-o", "nodes"),
        "--polish": (f"{BODY} {MADE}", "OPTION 1", "nodes"),
        "--refine": (f"step.wkt --cells 400 {MADE}", "OPTION 1", "nodes"),
        "--device": (f"{BODY} {MADE}", "OPTION cpu", "nodes" if TORCH else "code"),
        "--fallback": (f"wave.h5 --model m.safetensors {MADE}", "OPTION", "nodes"),
        "--answer": (f"duct.h5 --model m.safetensors {MADE}", "OPTION raw", "nodes"),
        "--repair": (f"wave.h5 --model m.safetensors --answer pasted {MADE}", "OPTION", "code"),
        "--no-repair": (f"wave.h5 --model m.safetensors {MADE}", "OPTION", "code"),
    },
    "quality": chosen("@grids.txt --summary", "*oo*", "out") | {
        "--json": ("grid.h5", "OPTION", "out"),
        "--quiet": ("missing.h5 grid.h5", "OPTION", "error"),
        "--debug": ("missing.h5", "OPTION", "error"),
        "--from": ("odd.name", "OPTION vts", "code"),
        "--fail-on": ("grid.h5", "OPTION max_angle>90.5", "code"),
        "--profile": ("grid.h5", "OPTION viscous", "out"),
        "--plot": ("grid.h5", "OPTION grid.png", "files"),
        "--per-cell": ("grid.h5", "OPTION cells.vts", "files"),
        "--html": ("grid.h5", "OPTION report.html", "files"),
        "--compare": ("grid.h5", "OPTION smooth.h5", "out"),
        "--reynolds": ("grid.h5", "OPTION 1e6", "out"),
        "--length": ("grid.h5 --reynolds 1e6", "OPTION 2", "out"),
        "--pair": ("bc.h5 --compare cb.h5 --summary", "OPTION order", "out"),
        "--summary": ("grid.h5 smooth.h5", "OPTION", "out"),
        "--threads": ("grid.h5", "OPTION 0", "code"),
    },
    "convert": COMMON | chosen("@grids.txt -o made-{stem}.h5 -q", "*oo*") | {
        "--part-size": ("bc.h5 -o made.h5 -q", "OPTION 1", "files"),
        "--extrude": ("grid.h5 -o made.p3d", "OPTION 1", "bytes"),
        "--planes": ("grid.h5 -o made.p3d --extrude 1", "OPTION 3", "bytes"),
        "--plot3d": ("grid.h5 -o made.p3d", "OPTION binary", "bytes"),
        "--revolve": ("grid.h5 -o made.p3d", "OPTION 5 --axis 0,-9,1,0", "bytes"),
        "--axis": ("grid.h5 -o made.p3d", "--revolve 5 OPTION 0,-9,1,0", "bytes"),
        "--swap": (f"grid.h5 {MADE}", "OPTION", "nodes"),
        "--normalise": (f"grid.h5 {MADE}", "OPTION", "nodes"),
        "--coarsen": (f"grid.h5 {MADE}", "OPTION 2", "nodes"),
        "--copies": (f"passage.h5 {MADE}", "OPTION 3", "nodes"),
        "--scale": (f"grid.h5 {MADE}", "OPTION .001", "nodes"),
        "--list-formats": ("", "OPTION", "prints"),
    },
    "plot": PICTURE | chosen("@grids.txt -o made-{stem}.png -q", "*oo*") | {
        "--metric": ("grid.h5 -o made.png -q", "OPTION skewness", "bytes"),
        "--zoom": ("grid.h5 -o made.png -q", "OPTION .5,1.5,0,.5", "bytes"),
        "--every": ("grid.h5 -o made.png -q", "OPTION 5", "bytes"),
        "--slice": ("cube.vts -o made.png -q", "OPTION z=1.5", "bytes"),
        "--seen-from": ("cube.vts -o made.png -q", "OPTION 30,60", "bytes"),
        "--up": ("cube.vts -o made.png -q", "OPTION y", "bytes"),
        "--span": ("passage.h5 -o made.png -q", "OPTION .3,.6", "bytes"),
        "--meridional": ("passage.h5 -o made.png -q", "OPTION", "bytes"),
    },
    "layout": LAYOUT | chosen("@domains.txt -o made-{stem}.json -q", "*ep") | {
        **engines("step.wkt hole.wkt -o {stem}.json -q"),
        **flat_plate("hole.wkt -o made.json -q", "bytes"),
        "--far-field": ("naca:0012 -o made.json -q", "OPTION 7", "bytes"),
        "--first-cell": ("hole.wkt -o made.json -q", "OPTION .002", "bytes"),
        "--walls": ("hole.wkt --first-cell .002 -o made.json -q", "OPTION bolt", "error"),
        "--assemble": ("square.csv bolt.csv -o {stem}.json -q", "OPTION", "files"),
        **{
            name: (base.replace(MADE, "-o made.json -q"), more, differs.replace("nodes", "bytes"))
            for name, (base, more, differs) in DOMAINS.items()
            if name != "--assemble"
        },
    },
    "stack": printing(f"{WING} -o made.h5", f"missing.toml {MADE}") | files(WING) | {
        **chosen("@wings.txt --around 49 --span 9 --layers 12 -o made-{stem}.h5 -q", "w*"),
        **engines("wing.toml short.toml --around 49 --span 9 --layers 12 -o {name}.h5 -q"),
        **flat_plate(f"{WING} {MADE}"),
        **judged(f"{WING} {MADE}", f"moon.toml --around 33 --span 7 {MADE}"),
        "--profile": (f"short.toml {WING} -o made-{{index}}.h5", "OPTION pointwise", "out"),
        "--around": (f"{WING} {MADE}", "OPTION 61", "nodes"),
        "--span": (f"{WING} {MADE}", "OPTION 11", "nodes"),
        "--base": (f"{WING} {MADE}", "OPTION .01", "nodes"),
        "--cells": (
            f"row.toml --first-cell .01 --growth 1.5 --cells 20000 {MADE}",
            "OPTION 60000",
            "nodes",
        ),
        "--copies": (f"row.toml --cells 20000 --first-cell .01 --growth 1.5 {MADE}", "OPTION 2", "nodes"),
        "--far-field": (f"{WING} {MADE}", "OPTION 7", "nodes"),
        "--tip": (f"{WING} --surface {MADE}", "OPTION flat", "nodes"),
        "--surface": (f"{WING} {MADE}", "OPTION", "nodes"),
        "--layers": (f"{WING} {MADE}", "OPTION 20", "nodes"),
        "--first-cell": (f"{WING} {MADE}", "OPTION .002", "nodes"),
        "--growth": (f"short.toml --around 33 --span 7 --first-cell .02 {MADE}", "OPTION 1.3", "nodes"),
        "--revolve": (f"short.toml {WING} {MADE}", "OPTION 90", "code"),
        "--axis": (f"short.toml {WING} {MADE}", "OPTION y", "code"),
    },
    "sweep": printing(f"{PIPE} -o made.h5", f"circle:1 missing.csv {MADE}") | {
        **files(PIPE, "odd.name path.csv"),
        **chosen("@pipes.txt path.csv --around 16 -o made-{index}.h5 -q", "circle.4"),
        **engines(f"circle:.4 {PIPE} -o {{index}}.h5 -q"),
        **flat_plate(f"{PIPE} {MADE}"),
        **judged(f"{PIPE} {MADE}", f"folded.h5 path.csv {MADE}"),
        "--profile": (f"circle:.5 {PIPE} -o made-{{index}}.h5", "OPTION verdict", "out"),
        "--res": (f"box.csv path.csv {MADE}", "OPTION 11x9", "nodes"),
        "--planes": (f"{PIPE} {MADE}", "OPTION 7", "nodes"),
        "--up": (f"{PIPE} {MADE}", "OPTION 0,1,1", "nodes"),
        "--twist": (f"{PIPE} {MADE}", "OPTION 10", "nodes"),
        "--scale": (f"{PIPE} {MADE}", "OPTION .5", "nodes"),
        "--revolve": (f"{PIPE} {MADE}", "OPTION 90", "code"),
        "--axis": (f"{PIPE} {MADE}", "OPTION y", "code"),
        "--around": (f"circle:.5 path.csv {MADE}", "OPTION 40", "nodes"),
        "--cells": (f"circle:.5 path.csv {MADE}", "OPTION 2000", "nodes"),
        "--cell-size": (f"step.wkt path.csv {MADE}", "OPTION .5", "nodes"),
        "--layout": (f"step.wkt path.csv --cells 400 {MADE}", "OPTION tall.json", "nodes"),
        "--walls": (f"hole.wkt path.csv --cells 900 --first-cell .02 {MADE}", "OPTION bolt", "error"),
        "--first-cell": (f"{PIPE} {MADE}", "OPTION .01", "nodes"),
        "--growth": (f"{PIPE} --first-cell .001 {MADE}", "OPTION 1.5", "nodes"),
    },
    "deform": printing(f"{SUNK} -o made.h5", f"missing.h5 {SHIFT} {MADE}") | {
        **files(SUNK, f"odd.name {SHIFT}"),
        **chosen(f"@grids.txt {SHIFT} -o made-{{stem}}.h5 -q", "*oo*"),
        **engines(f"smooth.h5 {SUNK} -o {{index}}.h5 -q"),
        **judged(f"{SUNK} {MADE}", f"grid.h5 --rotate south=180@1,0 {MADE}"),
        "--profile": ("grid.h5 grid.h5 --shift south=0,-.1 -o made.h5", "OPTION viscous", "out"),
        "--part-size": (f"bc.h5 {SHIFT} {MADE}", "OPTION 1", "files"),
        "--wall": (f"grid.h5 --shift north=0,.1 {MADE}", "OPTION south=c.vts", "nodes"),
        "--rotate": (f"{SUNK} {MADE}", "OPTION north=2@0,1", "nodes"),
        "--shift": (f"{SUNK} {MADE}", "OPTION north=0,.1", "nodes"),
    },
    "models": {
        "--json": ("", "OPTION", "out"),
    },
    "doctor": {
        "--json": ("", "OPTION", "out"),
    },
    "train": printing(TRAINING, "missing.h5 -o m.safetensors") | {
        "--output": (TRAINING, "OPTION other.safetensors", "files"),
        "--from": (TRAINING.replace("arches.h5", "solved.name"), "OPTION vts", "code"),
        "--model": (TRAINING, "OPTION meshonet-hard", "weights"),
        "--split": (TRAINING, "OPTION extrapolation", "weights"),
        "--set": (TRAINING, "OPTION sensors=20", "weights"),
        "--epochs": (TRAINING, "OPTION 2", "weights"),
        "--batch": (TRAINING, "OPTION 2", "weights"),
        "--rate": (TRAINING, "OPTION .002", "weights"),
        "--schedule": (TRAINING, "OPTION cosine", "weights"),
        "--points": (TRAINING, "OPTION 90", "weights"),
        "--held-out": (TRAINING, "OPTION 2", "weights"),
        "--seed": (TRAINING, "OPTION 3", "weights"),
        "--log-csv": (TRAINING, "OPTION log.csv", "files"),
    },
}  # fmt: skip
ELSEWHERE = {
    ("models", "--debug"): "shipped models do not fail; test_cli_models breaks one",
    ("train", "--initial"): "test_the_quad_operator_learns_around_bodies_from_a_model_that_is_there",
    ("train", "--patience"): "test_patience_ends_a_run",
    ("train", "--threads"): "test_threads_are_those_of_torch",
    ("train", "--device"): "test_the_device_is_that_of_torch",
    ("train", "--amp"): "test_amp_multiplies_in_bfloat16",
    ("train", "--compile"): "test_compile_goes_through_the_compiler",
    ("train", "--resume"): "test_a_cut_run_goes_on_from_its_checkpoint",
    ("train", "--checkpoint-every"): "test_a_cut_run_goes_on_from_its_checkpoint",
}
"""Effects that no single run shows, and the tests of them."""
