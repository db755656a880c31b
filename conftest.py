"""Examples in docstrings run in a folder of their own, since some write files."""

import pytest


@pytest.fixture(autouse=True)
def folder_of_examples(request: pytest.FixtureRequest) -> None:
    """Change to an empty folder for a docstring's examples; other tests make theirs where they need one."""
    if isinstance(request.node, pytest.DoctestItem):
        request.getfixturevalue("monkeypatch").chdir(request.getfixturevalue("tmp_path"))
