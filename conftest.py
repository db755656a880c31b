"""Examples in docstrings run in a folder of their own, since some write files."""

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def folder_of_examples(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Change to an empty folder for a docstring's examples."""
    if isinstance(request.node, pytest.DoctestItem):
        monkeypatch.chdir(tmp_path)
