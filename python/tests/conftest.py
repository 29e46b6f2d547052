"""Fixtures of all tests."""

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs every test in a folder of its own: logs are written to `logs/`."""
    monkeypatch.chdir(tmp_path)
