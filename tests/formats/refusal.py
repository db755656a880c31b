"""Files of `meshonet stack` that are refused."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from meshonet.formats.stack import stack_of
from meshonet.geometry.errors import InputError


def assert_refused(name: str, files: Mapping[str, str], words: str, folder: Path) -> None:
    """Fail unless `name`, one of `files`, is refused in one line with `words`, its source and a remedy."""
    for file, text in files.items():
        (folder / file).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        with pytest.raises(InputError, match=words) as caught:
            stack_of(name)
    assert "\n" not in str(caught.value)
    assert caught.value.source
    assert caught.value.remedy
