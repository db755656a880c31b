"""What inputs are made of, so that a part that was made of others is not taken for one of these."""

import hashlib

from meshonet.formats.hdf5.parts import digest_of
from meshonet.formats.registry import is_designation
from meshonet.formats.source import open_source
from meshonet.geometry.errors import InputError


def digests_of(text: str) -> list[str]:
    """Return a digest for each of the inputs that `text` names: one, or one a sample of a dataset."""
    if is_designation(text):
        return [digest_of(text)]
    try:
        content = open_source(text).read_bytes()
    except InputError as error:
        return [digest_of(text, str(error))]
    return [digest_of(text, hashlib.sha256(content).hexdigest())]
