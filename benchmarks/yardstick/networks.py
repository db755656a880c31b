"""Entries that learn: the networks of `meshonet train --model`.

Operators are trained once for each topology, on random domains of kinds that are not in the comparison.
Physics-informed networks are trained for one geometry, as a part of their run:

    python benchmarks/yardstick/networks.py BOUNDARIES.h5 GRIDS.h5 MODEL

writes the grid of the first shape of a file.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

OPERATORS = (
    "meshonet", "meshonet-hard", "deeponet", "pod-deeponet", "fno1d", "fno2d", "wno", "kno", "lno", "mionet",
)  # fmt: skip
PHYSICS = ("mgnet", "meshnet")
FAMILIES = {"quad": ("four-sided", "33"), "o": ("bodies", "65x33")}
"""Family and node counts of the grids on which the operators of a topology are trained."""
SHAPES = 600
EPOCHS = 15
STEPS = 500
"""Shapes and epochs of an operator, steps of a physics-informed network."""
SEED = 0


def trained(folder: Path, topology: str, model: str, shapes: int = SHAPES, epochs: int = EPOCHS) -> Path:
    """Return the file of an operator in `folder`, trained if it is not there yet."""
    path = folder / f"{model}-{topology}.safetensors"
    if not path.exists():
        grids = solved(folder, topology, shapes)
        plan = ("--model", model, "--epochs", epochs, "--seed", SEED, "--resume")
        meshonet("train", grids, *plan, "-o", path)
    return path


def solved(folder: Path, topology: str, shapes: int) -> Path:
    """Return the file of Winslow's grids of a topology's family, made if it is not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    grids, (family, nodes) = folder / f"{topology}.h5", FAMILIES[topology]
    if not grids.exists():
        edges = folder / f"{topology}-edges.h5"
        sampled = ("--family", family, "--count", shapes, "--seed", 1, "--res", nodes)
        meshonet("sample-boundary", *sampled, "-o", edges)
        meshonet("solve-pde", edges, "-o", grids, codes=(0, 3))  # 3: some have no grid and are left out
    return grids


def answered(boundaries: Path, grids: Path, model: str, steps: int = STEPS) -> None:
    """Train a physics-informed network for the first shape of a file, and write its grid."""
    with tempfile.TemporaryDirectory() as folder:
        first = f"{boundaries}#0"
        solution, network = Path(folder, "solved.h5"), Path(folder, "network.safetensors")
        meshonet("solve-pde", first, "-o", solution)
        meshonet("train", solution, "--model", model, "--epochs", steps, "--seed", SEED, "-o", network)
        meshonet("infer", first, "--model", network, "--answer", "pasted", "--allow-invalid", "-o", grids)


def meshonet(*words: object, codes: tuple[int, ...] = (0,)) -> None:
    """Run a command of meshonet quietly. Raises CalledProcessError: its exit code is not in `codes`."""
    done = subprocess.run([sys.executable, "-m", "meshonet_cli", *map(str, words), "-q"], check=False)
    if done.returncode not in codes:
        raise subprocess.CalledProcessError(done.returncode, done.args)


if __name__ == "__main__":
    answered(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
