"""Fixtures of all tests."""

from pathlib import Path

import protean_robotics as pr
import pytest


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs every test in a folder of its own: logs are written to `logs/`."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="session")
def chase_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Log of the first two seconds of a chase."""
    log = tmp_path_factory.mktemp("logs") / "chase-7.mcap"
    pr.run("chase", seed=7, set={"rules.time_limit": 2}, in_process=True, out=log)
    return log
