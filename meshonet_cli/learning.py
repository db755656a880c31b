"""What `train` does: datasets to a model, told as it goes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.split import WAYS, split
from meshonet.geometry.spacing.sampling import Sampling
from meshonet_cli.report.training import Log
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from meshonet.solvers.neural.fit.plan import Plan
    from meshonet.solvers.neural.fit.team import Team
    from meshonet.solvers.neural.samples import Samples


@dataclass(frozen=True)
class Run:
    """What is asked of a training run.

    Parameters
    ----------
    output : model file.
    model : name in `meshonet.solvers.neural.registry.MODELS`, or None to go by what the dataset holds.
    plan : settings of `meshonet.solvers.neural.fit.plan.Plan` to change; None stands for the model's own.
    settings : of the model, ``name=value`` each.
    split : way or file that says which grids are trained on; None for what the dataset says.
    held_out : shapes kept out to watch the loss, None for the model's own.
    initial : quad model, by name or path, whose weights are the first.
    """

    output: str
    model: str | None
    plan: Mapping[str, Any]
    settings: Sequence[str] = ()
    split: str | None = None
    held_out: int | None = None
    threads: int = 1
    resume: bool = False
    log_csv: str | None = None
    initial: str | None = None


def learn(sources: Sequence[str], run: Run, session: Session, *, fmt: str | None = None) -> int:
    """Fit a model to the datasets `sources` and return the exit code.

    Raises
    ------
    InputError
        torch is not installed; the output is no ``.safetensors`` file in a folder that exists; bad settings
        or datasets.
    """
    _check_output(run.output)
    try:
        import torch
    except ImportError:
        raise InputError("training needs torch", "install it: pip install 'meshonet[train]'") from None
    from meshonet.solvers.neural.fit.team import team

    torch.set_num_threads(run.threads)
    name = run.model or _suited(sources, fmt)
    fellows = team(run.plan.get("device") or "auto")
    if not fellows.leads:
        session = Session(quiet=True, debug=session.debug)
    try:
        told = _trained(name, sources, run, session, fellows, fmt)
    finally:
        fellows.close()
    if session.as_json:
        session.result({"output": run.output, "model": name, **told})
    return session.finish()


def _trained(
    name: str, sources: Sequence[str], run: Run, session: Session, fellows: Team, fmt: str | None
) -> dict[str, Any]:
    from meshonet.solvers.neural.fit.train import standard, train

    if run.initial is not None and name != "quad":
        raise InputError(f"--initial is of no use to {name}", "leave it out, or use --model quad")
    plan = _planned(standard(name), run.plan, long=name not in ("strip", "quad"))
    data, choices = _data(name, sources, run, session, fmt)
    log = Log(session, plan, run.log_csv, resume=run.resume, leads=fellows.leads)
    recipe = {"command": "meshonet train", "datasets": [Path(s).name for s in sources]}
    rest: dict[str, Any] = {"recipe": recipe, "held_out": run.held_out, "resume": run.resume, **choices}
    figures = train(name, data, Path(run.output), plan, fellows, report=log, **rest)
    for line in _notes(name, figures):
        session.note(f"{run.output}: {line}")
    return {"shapes": len(data), "figures": figures}


def _data(
    name: str, sources: Sequence[str], run: Run, session: Session, fmt: str | None
) -> tuple[Any, dict[str, Any]]:
    """Return what a model is trained on, and its choices as `train` takes them."""
    if name == "strip":
        from meshonet.solvers.neural.strip.dataset import solve_strips

        if run.settings:
            raise InputError("the strip operator takes no --set", "leave it out, or choose another --model")
        _refuse_splits(run, name)
        strips = solve_strips(_boundaries(sources, fmt), _counted(session))
        session.note(f"{len(strips)} shapes lifted and solved")
        return strips, {}
    if name == "quad":
        from meshonet.solvers.neural.fit.quad_grids import quads_of
        from meshonet.solvers.neural.registry import load

        _refuse_splits(run, name)
        initial = None if run.initial is None else load(run.initial)
        domains = quads_of(read_grids(source, fmt) for source in sources)
        session.note(f"{len(domains)} domains solved by both methods")
        return domains, {"initial": initial, "weights": _settings(run.settings)}
    return _samples(sources, run, fmt), {"settings": _settings(run.settings)}


def _notes(name: str, figures: Mapping[str, Any]) -> Iterator[str]:
    """Yield what is said of a trained model."""
    if name == "strip":
        network, base = figures["network"]["median"], figures["base"]["median"]
        yield f"held-out error {network:.1e}, without the network {base:.1e} (medians)"
    for head in ("winslow", "variational") if name == "quad" else ():
        error, base = figures[head]["relative_l2"]["median"], figures[head]["base"]
        yield f"held-out distance to {head} grids {error:.1e}, without the network {base:.1e} (medians)"
    for kind in ("train", "test"):
        if kind in figures:
            own = figures[kind]
            yield (
                f"relative L2 error of {own['grids']} {kind} grids {own['median']:.1e} (median), "
                f"{own['worst']:.1e} (worst); boundary off by {own['boundary']:.1e}"
            )


def _refuse_splits(run: Run, name: str) -> None:
    """Refuse what only models of the registry take."""
    if run.split or run.plan.get("points"):
        told = f"the {name} operator takes no --split or --points"
        raise InputError(told, "leave them out, or choose another --model")


def _planned(standard: Plan, given: Mapping[str, Any], *, long: bool) -> Plan:
    """Return the model's plan with what is given; a `long` one reports two hundred times."""
    words = {key: value for key, value in given.items() if value is not None}
    if "points" in words:
        words["points"] = _points(words["points"])
    plan = replace(standard, **words)
    if not long:
        return plan
    every = max(1, plan.epochs // 200)
    extra: dict[str, Any] = {"log_every": every, "validate_every": every}
    extra["decay_every"] = max(1, plan.epochs // 15)
    if given.get("checkpoint_every") is None:
        extra["checkpoint_every"] = every
    return replace(plan, **extra)


def _points(text: str) -> tuple[int, int] | None:
    """Return the places inside and on the boundary of ``N`` or ``all``."""
    if text == "all":
        return None
    if not (text.isascii() and text.isdigit() and 6 <= int(text) <= 10**7):
        raise InputError(f"{text!r} is not a number of places", "use all or e.g. 1200", source="--points")
    boundary = int(text) // 6
    return int(text) - boundary, boundary


def _check_output(text: str) -> None:
    path = Path(text)
    if path.suffix != ".safetensors":
        raise InputError("a model file ends in .safetensors", "rename the output", source=text)
    if not path.parent.is_dir():
        raise InputError(f"no folder {path.parent}", "make it first", source=text)


def _suited(sources: Sequence[str], fmt: str | None) -> str:
    """Return the model for what the first dataset holds: boundaries are for the strip, grids for MeshONet."""
    try:
        next(read_grids(sources[0], fmt))
    except InputError as error:
        if "not grids" in error.problem or "not a grid" in error.problem:
            return "strip"
        raise
    return "meshonet"


def _samples(sources: Sequence[str], run: Run, fmt: str | None) -> Samples:
    from meshonet.solvers.neural.samples import gathered

    samples = gathered(grid for source in sources for grid in read_grids(source, fmt))
    if run.split is None:
        return samples
    if run.split in WAYS:
        try:
            return replace(samples, splits=split(samples.parameters.tolist(), run.split))
        except InputError as error:
            error.source = "--split"
            raise
    try:
        words = tuple(Path(run.split).read_text(encoding="utf-8").split())
    except (OSError, ValueError):
        told = f"{run.split!r} is neither a way to split nor a file"
        raise InputError(told, "use a file or one of " + ", ".join(WAYS), source="--split") from None
    if len(words) != len(samples) or set(words) - {"train", "test"}:
        told = f"{run.split} has {len(words)} words for {len(samples)} grids"
        raise InputError(told, "write train or test for each", source="--split")
    return replace(samples, splits=words)


def _settings(words: Sequence[str]) -> dict[str, Any]:
    """Return settings of ``name=value`` words, the value as JSON where it is that."""
    found: dict[str, Any] = {}
    for word in words:
        name, mark, text = word.partition("=")
        if not mark:
            raise InputError(f"{word!r} is not NAME=VALUE", "use e.g. sensors=80", source="--set")
        try:
            found[name] = json.loads(text)
        except ValueError:
            found[name] = text
    return found


def _boundaries(sources: Sequence[str], fmt: str | None) -> Iterator[Boundary]:
    for source in sources:
        for shape in read_shapes(source, fmt):
            yield shape.boundary(Sampling(topology="o"))


def _counted(session: Session) -> Callable[[int, int], None]:
    def told(done: int, left_out: int) -> None:
        if done and done % 500 == 0:
            session.note(f"{done} shapes lifted and solved, {left_out} left out")

    return told
