"""Where the results of a run go."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Files:
    """Where results go, the formats of both sides, and what becomes of results that are there.

    Parameters
    ----------
    output : a file, a pattern of files with ``{stem}``, ``{index}`` or ``{name}``, or ``-``.
    from_format, to_format : formats, where names and content do not say.
    skip_existing : whether inputs are passed over whose results are there.
    part_size : inputs in a part of a dataset.
    """

    output: str
    from_format: str | None = None
    to_format: str | None = None
    skip_existing: bool = False
    part_size: int | None = None
