"""Digests of inputs, by which existing parts are recognised."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from meshonet.formats.hdf5.parts import Input, digest_of
from meshonet.formats.registry import is_designation
from meshonet.formats.source import open_source
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.families.draw import Draw


def digests_of(entry: str | InputError | Draw) -> list[Input]:
    """Return an input and a digest of its name and content; for a dataset, one such pair per sample.

    The digest of an unreadable input is computed from its name and the error.
    """
    if isinstance(entry, InputError):
        return [Input(entry.source, digest_of(entry.source, str(entry)))]
    if not isinstance(entry, str):
        facts = entry.low, entry.high, entry.seed, entry.index, entry.split
        return [Input(entry.kind, digest_of(entry.kind, repr(facts)))]
    if is_designation(entry):
        return [Input(entry, digest_of(entry))]
    try:
        return _contents(entry)
    except InputError as error:
        return [Input(entry, digest_of(entry, str(error)))]


def _contents(text: str) -> list[Input]:
    from meshonet.formats.inputs import samples_in

    samples = samples_in(text)
    if samples is None:
        return [Input(text, digest_of(text, hashlib.sha256(open_source(text).read_bytes()).hexdigest()))]
    return [Input(text, digest_of(samples.name, digest)) for digest in samples.digests()]
