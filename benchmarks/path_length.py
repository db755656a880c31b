"""How much of this project a command runs through: distinct code objects, and the files that they are in.

    python benchmarks/path_length.py                       # infer examples/naca2412.dat --res 800 -o grid.vts
    python benchmarks/path_length.py --list quality a.vts  # another command, and all that it runs through

A code object is what Python compiles one body to: of a module, class, function, lambda or comprehension.
Counted is each that is entered once or more in the process of the command, from its start to the exit code,
and whose source is a file of this project. What libraries generate, such as ``__init__`` of a dataclass, has
no file and is not counted. From Python 3.12 on most comprehensions are no code objects of their own.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("meshonet", "meshonet_cli", "geometry", "solvers", "formats", "kernels")
COMMAND = ["infer", str(ROOT / "examples" / "naca2412.dat"), "--res", "800", "-o", "grid.vts"]
WATCHED = """
import os, sys, threading
entered = set()
def watch(frame, event, _):
    if event == "call":
        entered.add(frame.f_code)
place = sys.argv.pop(1)
threading.setprofile(watch)
sys.setprofile(watch)
from meshonet_cli.__main__ import main
try:
    main()
finally:
    sys.setprofile(None)
    with open(place, "w") as file:
        for code in entered:
            path = os.path.realpath(code.co_filename)
            print(path, code.co_firstlineno, code.co_qualname, sep="\\t", file=file)
"""


def code_objects(command: list[str]) -> dict[Path, list[tuple[int, str]]]:
    """Return by file line and name of the code objects that a command enters."""
    objects: dict[Path, list[tuple[int, str]]] = defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "entered")
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        words = [  # outputs stay in the folder
            str(Path(word).resolve()) if before != "-o" and Path(word).exists() else word
            for before, word in zip(["", *command], command, strict=False)
        ]
        program = [sys.executable, "-c", WATCHED, str(place), *words]
        subprocess.run(program, cwd=folder, env=environment, check=True)
        for line in place.read_text().splitlines():
            path, number, name = line.split("\t")
            if Path(path).is_relative_to(ROOT) and Path(path).relative_to(ROOT).parts[0] in ROOMS:
                objects[Path(path).relative_to(ROOT)].append((int(number), name))
    return objects


def main() -> None:
    """Print how many there are."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--list", action="store_true", help="every file with its code objects as well")
    parser.add_argument("command", nargs=argparse.REMAINDER)
    options = parser.parse_args()
    objects = code_objects(options.command or COMMAND)
    for path, names in sorted(objects.items()) if options.list else ():
        print(f"{len(names):4d} {path}")
        for number, name in sorted(names):
            print(f"        {number}:{name}")
    print(f"{sum(map(len, objects.values()))} code objects in {len(objects)} files")


if __name__ == "__main__":
    main()
