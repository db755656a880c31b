"""Commands against hostile options and files of TOML, JSON and text, at random for some minutes.

    python benchmarks/fuzz_commands.py [--minutes 10] [--commands stack sweep] [--seed 0]

Passed is a command that does its work, or refuses it in one line with nothing written, within twenty seconds
of processor time and 2 GiB. The exit code is 1 when one did not pass; its words and files are kept in
fuzz-failures/.
"""

import argparse
import json
import os
import resource
import shutil
import sys
import time
from collections import Counter
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("cli", "formats")] + [str(ROOT / "tests"), str(ROOT)]

import blade_row
from hostile import mutate
from test_bad_values import INPUTS, NONSENSE, TAKES_WORDS

from meshonet_cli.__main__ import main as command_line
from meshonet_cli.app import application

SECONDS, MEMORY = 20, 2 << 30
FAILURES = Path("fuzz-failures")
SECTION = '[[sections]]\nairfoil = "naca:2412"\nchord = {}\nz = {}\ntwist = -2.0\n'
LEFT_OUT = (*TAKES_WORDS, "--debug", "--help", "--engine")
"""Options that name outputs, print tracebacks or start other programs."""
FILES = {
    "wing.toml": 'kind = "wing"\ntip = "round"\n' + SECTION.format(1.0, 0.0) + SECTION.format(0.5, 2.0),
    "path.toml": "start = [0, 0, 0]\n[[pieces]]\nline = 2.0\n"
    "[[pieces]]\narc = 90\nradius = 1.5\ntowards = [0, 1, 0]\n",
    "path.csv": "0 0 0\n9 0 0\n18 3 0\n",
    "step.wkt": "POLYGON ((0 0, 1 0, 1 1, 3 1, 3 2, 0 2, 0 0))",
    "blade.csv": "0 0\n1 -0.1\n1.1 0\n1 0.1\n",
    "plate.geojson": json.dumps(
        {"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 2], [0, 2], [0, 0]],
                                            [[1, 0.8], [1.5, 0.8], [1.5, 1.2], [1, 1.2], [1, 0.8]]]}
    ),
    **blade_row.texts("tip_gap = 0.05"),
    "aircraft.toml": 'kind = "aircraft"\n[[bodies]]\nmeridian = "body.csv"\n[[wings]]\n'
    + (2 * SECTION.replace("sections", "wings.sections")).format(1.0, 0.0, 0.5, 2.0)
    .replace("twist", "x = 1.5\ntwist"),
    "frames.toml": 'kind = "aircraft"\n[[bodies]]\n'
    + "".join(f"[[bodies.sections]]\n{row}\n" for row in (
        "x = 0\ny = -0.1", "x = 0.1\nwidth = 0.5\nheight = 0.4",
        "x = 0.5\nwidth = 0.9\nheight = 0.7\nexponent = 2.5",
        'x = 2.5\npoints = "frame.csv"', "x = 5\ny = 0.1"))
    + "[[wings]]\n" + (2 * SECTION.replace("sections", "wings.sections")).format(1.0, 0.0, 0.5, 2.0)
    .replace("twist", "x = 1.5\ntwist"),
    "frame.csv": "-0.4,0\n-0.3,0.3\n-0.1,0.42\n0.1,0.42\n0.3,0.3\n0.4,0\n",
    "body.csv": "0,0\n0.1,0.2\n0.5,0.35\n2,0.4\n4,0.3\n5,0\n",
}  # fmt: skip
"""Files that commands read, good ones."""
NAMED = {"row.toml": set(blade_row.texts()), "aircraft.toml": {"body.csv"}, "frames.toml": {"frame.csv"}}
"""Files that a file names."""
BASES = (
    *((command, *words) for command, words in INPUTS.items()),
    ("sweep", "circle:0.5", "path.toml", "--cells", "100", "-o", "made.h5"),
    ("infer", "blade.csv", "--pitch", "0,1", "--cells", "500", "-o", "made.vtm"),
    ("infer", "plate.geojson", "--cells", "500", "-o", "made.vtm"),
    ("solve-pde", "step.wkt", "--cells", "500", "-o", "made.vtm"),
    ("stack", "row.toml", "--cells", "20000", "--first-cell", "0.01", "-o", "made.h5"),
    ("stack", "aircraft.toml", "--around", "49", "--span", "5", "--first-cell", "0.01", "-o", "made.h5"),
    ("stack", "frames.toml", "--around", "49", "--span", "5", "--first-cell", "0.01", "-o", "made.h5"),
)
"""What is made worse."""
WORDS = (
    *NONSENSE, "0", "1", "2", "3", "0.5", "1e-9", "1e-3", "1e3", "1e9", "1e300", "0,1", "1e300,0", "0,0",
    "0,0,0", "1,2,3,4", "17", "33x9", "9x33", "100000x2", "1000000", "round", "auto", "south", "south=0,-0.1",
    "all=2", "south,north", "max_angle>1", "a=b", "=", ",", ";", "x", "../..", "/dev/null", "{index:c}",
    "made.h5", "-", "wing.toml", "\x1b[31m",
)  # fmt: skip
"""Values of options: wrong ones, extreme ones, and some that may fit."""


def attempt(random: Random, commands: dict[str, list[Any]], base: tuple[str, ...], place: Path) -> list[str]:
    """Write files to a place, most of them good, and return the words of a command there."""
    read = set(base).union(*(NAMED.get(word, ()) for word in base))
    for name, text in FILES.items():
        hostile = name in read and random.random() < 0.5
        (place / name).write_bytes(mutate(text.encode(), random) if hostile else text.encode())
    shutil.copy(place.parent / "grid.vts", place / "grid.vts")
    words = list(base)
    for option in random.sample(
        commands[base[0]], min(random.choice((0, 1, 1, 2, 3)), len(commands[base[0]]))
    ):
        words.append(random.choice(option.opts + option.secondary_opts))
        if not option.is_flag:
            words.append(random.choice(WORDS))
    return [word.replace("\0", "") for word in words]


def verdict(words: list[str], place: Path) -> str:
    """Return ``done`` or ``refused``, or what is wrong with how the words were taken."""
    before = {path.name for path in place.iterdir()}
    process = os.fork()
    if process == 0:
        _in_child(words, place)
    _, status, usage = os.wait4(process, 0)
    code = os.waitstatus_to_exitcode(status)
    errors = (place.parent / "err").read_text(encoding="utf-8", errors="replace")
    left = {path.name for path in place.iterdir()} - before
    last = errors.splitlines()[-1][-300:] if errors else ""
    if code < 0 or usage.ru_utime + usage.ru_stime > SECONDS:
        return f"signal {-code} after {usage.ru_utime + usage.ru_stime:.0f} s"
    if usage.ru_maxrss > MEMORY >> 10:
        return f"{usage.ru_maxrss >> 10} MiB"
    if "\x1b" in errors or "Traceback" in errors or "internal error" in errors or "Warning" in errors:
        return f"exit {code}: {last!r}"
    if code in (0, 1):
        return "done"
    if code not in (2, 3) or left or not errors.startswith("error: "):
        return f"exit {code}, {sorted(left)}: {last!r}"
    return "refused"


def _in_child(words: list[str], place: Path) -> None:
    os.chdir(place)
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS + 1, SECONDS + 1))
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    for stream, number in (("in", 0), ("out", 1), ("err", 2)):
        where = "/dev/null" if stream == "in" else place.parent / stream
        os.dup2(os.open(where, os.O_RDWR | os.O_CREAT | os.O_TRUNC), number)
    sys.argv = ["meshonet", *words]
    try:
        command_line()
    except SystemExit as ending:
        sys.stderr.flush()
        os._exit(int(ending.code or 0))
    os._exit(99)


def main() -> None:
    """Print one line of JSON for each failure, and one of figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--commands", nargs="+")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    random, counts = Random(given.seed), Counter[str]()  # noqa: S311  (no secret)
    commands = {
        name: [p for p in command.params if p.opts[-1].startswith("--") and p.opts[-1] not in LEFT_OUT]
        for name, command in application().commands.items()
    }
    bases = [base for base in BASES if base[0] in (given.commands or commands)]
    stop = time.monotonic() + 60 * given.minutes
    with TemporaryDirectory() as folder:
        grid = ["tfi", "step.wkt", "--res", "9", "-o", "../grid.vts"]
        good = Path(folder) / "good"
        good.mkdir()
        (good / "step.wkt").write_text("POLYGON ((0 0, 1 0, 1.2 1, 0 1, 0 0))")
        if verdict(grid, good) != "done":
            sys.exit("the good grid is not made")
        while time.monotonic() < stop:
            place = Path(folder) / str(counts.total())
            place.mkdir()
            words = attempt(random, commands, random.choice(bases), place)
            outcome = verdict(words, place)
            counts[outcome if outcome in ("done", "refused") else "failed"] += 1
            if outcome not in ("done", "refused"):
                kept = FAILURES / f"command-{given.seed}-{counts['failed']}"
                shutil.copytree(place, kept, dirs_exist_ok=True)
                (kept / "words.json").write_text(json.dumps(words))
                print(json.dumps({"words": words, "outcome": outcome, "files": str(kept)}), flush=True)
            shutil.rmtree(place)
    print(json.dumps({"commands": counts.total(), **counts}))
    sys.exit(int(bool(counts["failed"])))


if __name__ == "__main__":
    main()
