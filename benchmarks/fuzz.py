"""Readers against hostile files: a corpus through the command line, then random damage for some minutes.

    python benchmarks/fuzz.py [--minutes 10] [--readers vts hdf5] [--jobs 1] [--seed 0]

Each reader works in a process of its own. Passed is a file that is read, or refused by one of the package's
own errors in two lines at the most, within five seconds of processor time and within memory of 64 MiB plus 40
times the file. The exit code is 1 when one did not pass; its bytes are kept in fuzz-failures/.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
import traceback
import tracemalloc
import warnings
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests" / "formats"), str(ROOT / "tests"), str(ROOT)]

from hostile import READABLE, corpus, foreign, good, mutate, record_of

from meshonet.formats.source import Source
from meshonet.geometry.errors import MeshonetError
from meshonet_cli.__main__ import main as command_line

SECONDS = 5.0
SPARE, TIMES = 64 << 20, 40
FAILURES = Path("fuzz-failures")


def judge(name: str, data: bytes) -> str:
    """Return ``read`` or ``refused``, or what is wrong with how the reader took `data`."""
    record = record_of(name)
    begun, outcome = time.process_time(), "read"
    for read in (record.read_shapes, record.read_grids):
        if read is None:
            continue
        try:
            for item in read(Source("hostile", data=data)):
                if not item.name.isprintable():
                    return "a name that cannot be printed"
        except MeshonetError as error:
            outcome = "refused"
            if isinstance(error.__cause__, MemoryError):
                return "out of memory"
            if not 10 < len(str(error)) < 400 or not str(error).isprintable():
                return f"a message that is not one: {error!s:.80}"
        except (Exception, RecursionError):
            return traceback.format_exc().splitlines()[-1][:120]
    spent = time.process_time() - begun
    return outcome if spent < SECONDS else f"{spent:.1f} s"


def attack(name: str, seconds: float, seed: int) -> dict[str, object]:
    """Damage good files of reader `name` at random for `seconds` of wall time and return the figures."""
    random, counts, peak = Random(f"{name} {seed}"), Counter(), 0  # noqa: S311  (no secret)
    limit = 4 << 30
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    goods, failures, slowest = [good(name)], [], 0.0
    seeds = [good(name), *(data for _, data in corpus(name))]
    FAILURES.mkdir(exist_ok=True)
    suspect = FAILURES / f"{name}-{os.getpid()}"
    warnings.simplefilter("error")
    stop = time.monotonic() + seconds
    while time.monotonic() < stop:
        data = mutate(random.choice(goods if random.random() < 0.7 else seeds), random)
        suspect.write_bytes(data)
        watched = counts.total() % 50 == 0
        if watched:
            tracemalloc.start()
        begun = time.process_time()
        outcome = judge(name, data)
        slowest = max(slowest, time.process_time() - begun)
        if watched:
            used = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            peak = max(peak, used)
            if used > SPARE + TIMES * len(data):
                outcome = f"{used >> 20} MiB for {len(data)} bytes"
        counts[outcome if outcome in ("read", "refused") else "failed"] += 1
        if outcome not in ("read", "refused"):
            failures.append(outcome)
            suspect.rename(FAILURES / f"{name}-{len(failures)}")
    suspect.unlink(missing_ok=True)
    return {
        "reader": name, "files": counts.total(), **counts, "slowest_s": round(slowest, 2),
        "peak_MiB": round(peak / 2**20, 1), "failures": sorted(set(failures))[:5],
    }  # fmt: skip


def apart(name: str, seconds: float, seed: int) -> dict[str, object]:
    """Return what `attack` does in a process of its own, which it may bring down."""
    words = [sys.executable, __file__, "--one", name, "--minutes", str(seconds / 60), "--seed", str(seed)]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        return {"reader": name, "failures": [f"exit {done.returncode}: {done.stderr[-300:]}"]}
    return json.loads(done.stdout)


def through_the_command_line() -> dict[str, object]:
    """Give every file of the corpus to ``meshonet convert`` and return the figures."""
    files = [(name, report, data) for name in READABLE for report, data in corpus(name)]
    files += [
        (name, report, data) for name in ("airfoil", "points", "vts", "hdf5") for report, data in foreign()
    ]
    with TemporaryDirectory() as folder:
        outcomes = [_converted(Path(folder) / str(k), name, data) for k, (name, _, data) in enumerate(files)]
    wrong = [
        f"{name}: {report}: {outcome}"
        for (name, report, _), outcome in zip(files, outcomes, strict=True)
        if outcome not in ("read", "refused")
    ]
    passed = Counter(outcome for outcome in outcomes if outcome in ("read", "refused"))
    return {"files": len(files), **passed, "failures": wrong}


def _converted(place: Path, name: str, data: bytes) -> str:
    """Return what ``meshonet convert`` makes of a file, in a process of its own with all loaded."""
    place.mkdir()
    file = place / f"hostile{record_of(name).suffixes[0]}"
    file.write_bytes(data)
    process = os.fork()
    if process == 0:
        os.chdir(place)
        with (place.parent / "err").open("wb") as stream:
            os.dup2(stream.fileno(), 2)
        sys.argv = ["meshonet", "convert", file.name, "out-{index}.h5"]  # a grid a file: they may differ
        try:
            command_line()
        except SystemExit as ending:
            sys.stderr.flush()
            os._exit(int(ending.code or 0))
        os._exit(99)
    _, status, usage = os.wait4(process, 0)
    errors = (place.parent / "err").read_text(encoding="utf-8", errors="replace")
    return _verdict(os.waitstatus_to_exitcode(status), errors, usage, place, file)


def _verdict(code: int, errors: str, usage: resource.struct_rusage, place: Path, file: Path) -> str:
    left = {entry.name for entry in place.iterdir()} - {file.name}
    if usage.ru_utime + usage.ru_stime > SECONDS:
        return f"{usage.ru_utime + usage.ru_stime:.1f} s"
    if usage.ru_maxrss > (300 << 10) + (TIMES * file.stat().st_size >> 10):
        return f"{usage.ru_maxrss >> 10} MiB"
    if "\x1b" in errors:
        return "an escape on the terminal"
    if code == 0:
        return "read" if left and all(name.startswith("out-") for name in left) else f"exit 0 and {left}"
    if code != 2 or left or "Traceback" in errors or "bug" in errors or not 1 <= errors.count("\n") <= 2:
        return f"exit {code}, {left}, {errors[-200:]!r}"
    return "refused"


def main() -> None:
    """Print one line of JSON for the corpus and one for each reader."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--readers", nargs="+", default=READABLE)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--one", help=argparse.SUPPRESS)
    parser.add_argument("--skip-corpus", action="store_true")
    given = parser.parse_args()
    if given.one:
        print(json.dumps(attack(given.one, 60 * given.minutes, given.seed)))
        return
    bad = False
    if not given.skip_corpus:
        report = through_the_command_line()
        print(json.dumps(report), flush=True)
        bad = bool(report["failures"])
    with ThreadPoolExecutor(given.jobs) as pool:
        for report in pool.map(lambda name: apart(name, 60 * given.minutes, given.seed), given.readers):
            print(json.dumps(report), flush=True)
            bad = bad or bool(report["failures"])
    sys.exit(int(bad))


if __name__ == "__main__":
    main()
