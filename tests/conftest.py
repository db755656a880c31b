"""Fixtures of all tests."""

import pytest

from meshonet.geometry import threads


@pytest.fixture
def eager_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have threads work on grids of any size."""
    monkeypatch.setattr(threads, "NODES_EACH", 16)
