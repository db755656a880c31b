"""`meshonet.train`: trains a model on datasets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.split import WAYS, split
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.neural.devices import INSTALL_TORCH

if TYPE_CHECKING:
    from meshonet.geometry.blocks.six_faces import SixFaces
    from meshonet.solvers.neural.fit.loop import Progress
    from meshonet.solvers.neural.fit.plan import Plan
    from meshonet.solvers.neural.samples import Samples

REPORTS = 200  # reports, evaluations and checkpoints of a long run


def train(
    datasets: str | Path | Sequence[str | Path],
    output: str | Path,
    *,
    model: str | None = None,
    settings: Mapping[str, Any] | None = None,
    split: str | None = None,
    held_out: int | None = None,
    initial: str | None = None,
    resume: bool = False,
    threads: int = 1,
    from_format: str | None = None,
    report: Callable[[Progress], None] | None = None,
    note: Callable[[str], None] | None = None,
    **plan: Any,
) -> dict[str, Any]:
    """Train a neural operator on datasets and write it to `output`.

    If torchrun starts several processes, they share the work of each step; the first process reports and
    writes.

    Parameters
    ----------
    datasets : str, Path or list of these
        Files with solved grids. The model ``strip`` needs files with O boundaries. The model ``quad`` needs
        two files with Winslow's grids and with variational grids of the same domains.
    output : str or Path
        Model file, ``.safetensors``.
    model : str, optional
        Architecture, as listed by ``train --help``; None selects it by the first dataset.
    settings : dict, optional
        Settings of the model; for ``quad``, weights of the loss.
    split : str, optional
        Rule that selects the shapes for tests: ``interpolation``, ``extrapolation`` or ``random``; or a file
        with the word ``train`` or ``test`` for each grid. None: the split that the dataset contains.
    held_out : int, optional
        Number of shapes that are not used for training but to monitor the loss; None: the default of the
        model.
    initial : str, optional
        Name or path of the model from which the training of ``quad`` starts.
    resume : bool, optional
        Continue from the checkpoint next to the output, if it exists.
    threads : int, optional
        Number of threads of torch.
    from_format : str, optional
        Format of the datasets; needed if neither extension nor content determines it.
    report, note : callable, optional
        Functions that are called with the progress of the training, and with messages.
    **plan
        Fields of `meshonet.solvers.neural.fit.plan.Plan`, such as ``epochs``, ``batch`` and ``points`` (a
        number or ``all``); None: the default of the model.

    Returns
    -------
    dict
        The name of the ``model``, the number of ``shapes``, and under ``figures`` the errors on the held-out
        shapes. In all processes of torchrun except the first, the dict is empty.

    Raises
    ------
    InputError
        Torch is not installed; the output is not a ``.safetensors`` file in an existing folder; invalid
        settings or datasets.
    SolverError
        The loss is not finite.

    Examples
    --------
    >>> import meshonet
    >>> names = [f"arch-{number}.h5" for number in range(6)]
    >>> for name, edges in zip(names, meshonet.sample_family("arch", 6, res=17), strict=True):
    ...     meshonet.solve_pde(edges).write(name)
    >>> train(names, "arch.safetensors", split="random", epochs=1, batch=4, points=60)["model"]
    'meshonet'
    """
    path = _model_path(output)
    try:
        import torch
    except ImportError:
        raise InputError("training needs torch", INSTALL_TORCH) from None
    from meshonet.solvers.neural.fit.team import team
    from meshonet.solvers.neural.fit.train import OF_VOLUMES, standard
    from meshonet.solvers.neural.fit.train import train as fit
    from meshonet.solvers.neural.registry import load

    torch.set_num_threads(threads)
    sources = [str(d) for d in ([datasets] if isinstance(datasets, str | Path) else datasets)]
    name = model or _suited(sources[0], from_format)
    volumes = _volumes(sources, from_format, split) if name == "meshnet" else []
    own, chosen = name in ("strip", "quad"), dict(settings or {})
    members = team(plan.get("device") or "auto")
    say = note if note and members.leads else lambda _: None
    try:
        if initial is not None and name != "quad":
            raise InputError(f"{{initial}} is of no use to {name}", "leave it out, or use {model} quad")
        another = "out, or choose another {model}"
        if name == "strip" and settings:
            raise InputError("the strip operator takes no {settings}", f"leave it {another}")
        if own and (split or plan.get("points")):
            raise InputError(f"the {name} operator takes no {{split}} or {{points}}", f"leave them {another}")
        full = _full_plan(standard(OF_VOLUMES if volumes else name), plan, long=not own)
        choices: dict[str, Any] = {"settings": chosen}
        data: Any
        if name == "strip":
            data, choices = _strips(sources, from_format, say), {}
        elif name == "quad":
            from meshonet.solvers.neural.fit.quad_grids import quads_of

            data = quads_of(read_grids(source, from_format) for source in sources)
            say(f"{len(data)} domains solved by both methods")
            choices = {"initial": None if initial is None else load(initial), "weights": chosen}
        else:
            data = volumes or _samples(sources, split, from_format)
        recipe = {"command": "meshonet train", "datasets": [Path(source).name for source in sources]}
        figures = fit(
            OF_VOLUMES if volumes else name, data, path, full, members, recipe=recipe, held_out=held_out,
            resume=resume, report=report if members.leads else None, **choices,
        )  # fmt: skip
    finally:
        members.close()
    return {"model": name, "shapes": len(data), "figures": figures} if members.leads else {}


def _model_path(output: str | Path) -> Path:
    """Return the path of a model file. Raises InputError: another ending, or no such folder."""
    path = Path(output)
    if path.suffix != ".safetensors":
        raise InputError("a model file ends in .safetensors", "rename the output", source=str(path))
    if not path.parent.is_dir():
        raise InputError(f"no folder {path.parent}", "make it first", source=str(path))
    return path


def _suited(source: str, fmt: str | None) -> str:
    """Return the default model for a dataset: strip for boundaries, meshonet for grids."""
    try:
        first = next(read_grids(source, fmt), None)
    except InputError as error:
        if "not grids" in error.problem or "not a grid" in error.problem:
            return "strip"
        raise
    if first is None:
        raise InputError("holds nothing", "give a dataset of grids or boundaries", source=source)
    return "meshonet"


def _full_plan(standard: Plan, changes: Mapping[str, Any], *, long: bool) -> Plan:
    """Return the model's plan with `changes`; a `long` training reports `REPORTS` times."""
    words = {key: value for key, value in changes.items() if value is not None}
    if "points" in words:
        words["points"] = _points(str(words["points"]))
    if long:
        epochs = words.get("epochs", standard.epochs)
        often = dict.fromkeys(("log_every", "validate_every", "checkpoint_every"), max(1, epochs // REPORTS))
        words = {**often, "decay_every": max(1, epochs // 15), **words}
    return replace(standard, **words)


def _points(text: str) -> tuple[int, int] | None:
    """Return the numbers of interior and boundary points for ``N``, None for ``all``."""
    if text == "all":
        return None
    if not (text.isascii() and text.isdigit() and 6 <= int(text) <= 10**7):
        problem = f"{text!r} is not a number of points"
        raise InputError(problem, "use all or e.g. 1200", parameter="points")
    boundary = int(text) // 6
    return int(text) - boundary, boundary


def _volumes(sources: Sequence[str], fmt: str | None, way: str | None) -> list[SixFaces]:
    """Return the six faces of every volume of the sources; nothing if the first grid is planar."""
    from meshonet.geometry.blocks.six_patches import six_faces

    grids = (grid for source in sources for grid in read_grids(source, fmt))
    first = next(grids, None)
    if first is None or first.blocks[0].nodes.shape[-1] == 2:
        return []
    if way is not None:
        raise InputError("{split} is of no use to volumes", "leave it out")
    return [six_faces(grid) for grid in (first, *grids)]


def _strips(sources: Sequence[str], fmt: str | None, note: Callable[[str], None]) -> Any:
    from meshonet.solvers.neural.strip.dataset import solve_strips

    def count(done: int, left_out: int) -> None:
        if done and done % 500 == 0:
            note(f"{done} shapes lifted and solved, {left_out} left out")

    shapes = (shape for source in sources for shape in read_shapes(source, fmt))
    strips = solve_strips((shape.boundary(Sampling(topology="o")) for shape in shapes), count)
    note(f"{len(strips)} shapes lifted and solved")
    return strips


def _samples(sources: Sequence[str], way: str | None, fmt: str | None) -> Samples:
    from meshonet.solvers.neural.samples import gathered

    samples = gathered(grid for source in sources for grid in read_grids(source, fmt))
    if way is None:
        return samples
    if way in WAYS:
        try:
            return replace(samples, splits=split(samples.parameters.tolist(), way))
        except InputError as error:
            error.parameter = "split"
            raise
    try:
        words = tuple(Path(way).read_text(encoding="utf-8").split())
    except (OSError, ValueError):
        problem = f"{way!r} is neither a way to split nor a file"
        raise InputError(problem, "use a file or one of " + ", ".join(WAYS), parameter="split") from None
    if len(words) != len(samples) or set(words) - {"train", "test"}:
        problem = f"{way} has {len(words)} words for {len(samples)} grids"
        raise InputError(problem, "write train or test for each", parameter="split")
    return replace(samples, splits=words)
