"""Plugin of pytest: the fixture ``mission`` runs missions, and a failing test shows how to look at them.

pytest loads it by the entry point of the package; nothing else imports it, so that the package does not need pytest.
"""

import hashlib
import os
import re
import shlex
import shutil
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from ._arguments import path
from ._errors import Error
from ._log import Log
from ._program import overrides
from ._run import Run, run

_MAX_NAME = 80
_FLAGS = ("in_process", "allow_external", "allow_outside")


@dataclass
class _Attempt:
    """A mission of a test: its scenario, the options of its run, its log, and its result if it reached its end."""

    scenario: str
    options: dict[str, Any]
    log: Path
    run: Run | None = None


class Missions:
    """Runs the missions of one test; the value of the fixture ``mission``.

    Attributes
    ----------
    folder
        Folder of the logs.
    is_shown
        True once a failure of the test shows the missions; their logs are then kept.
    """

    def __init__(self, item: pytest.Item, folder: Path) -> None:
        self.folder = folder
        self.is_shown = False
        self._item = item
        self._attempts: list[_Attempt] = []

    def __call__(self, scenario: str | os.PathLike[str] = "chase", *, in_process: bool = True, **options: Any) -> Run:
        """Runs a mission to its end, as ``protean_robotics.run`` does, with a log.

        Parameters
        ----------
        scenario
            Name of a built-in scenario, or path of a scenario file, relative to the file of the test.
        in_process
            True to run all processes in one thread of this one; False for processes of the operating system.
        **options
            Options of ``protean_robotics.run``: ``seed``, ``set``, ``planners``, ``processes``, ``allow_external``,
            ``allow_outside``.

        Returns
        -------
        Run
            Outcomes, figures, digest, log.

        Raises
        ------
        Error
            As ``protean_robotics.run``.
        """
        name = path("scenario", scenario)
        # A name alone is that of a built-in scenario, as for the program.
        if Path(name).suffix or os.sep in name:
            name = str(self._item.path.parent / name)
        self.folder.mkdir(parents=True, exist_ok=True)
        log = self.folder / f"{len(self._attempts) + 1}-{Path(name).stem}.mcap"
        attempt = _Attempt(name, options | {"in_process": in_process}, log)
        try:
            attempt.run = run(name, in_process=in_process, out=log, force=True, **options)
        finally:
            # Without a log nothing has been started: there is nothing to look at.
            if log.exists():
                self._attempts.append(attempt)
        return attempt.run

    def report(self) -> str:
        """Returns the text of a failing test: for each mission its result, picture and commands."""
        return "\n".join(line for attempt in self._attempts for line in self._lines(attempt))

    def _lines(self, attempt: _Attempt) -> Iterator[str]:
        yield repr(attempt.run) if attempt.run else f"{self._near(attempt.scenario)}: it did not reach its end"
        try:
            yield f"  picture  {self._near(Log(attempt.log).picture(force=True))}"
        except Error as error:
            yield f"  picture  {error}"
        yield f"  open     {shlex.join(['protean', 'report', self._near(attempt.log), '--open'])}"
        yield f"  again    {shlex.join(self._again(attempt))}"

    def _again(self, attempt: _Attempt) -> list[str]:
        """Returns the command that runs a mission again; with functions of the test this is pytest."""
        options = attempt.options
        if options.get("planners") or options.get("processes"):
            _, _, test = self._item.nodeid.partition("::")
            return ["pytest", f"{self._near(self._item.path)}::{test}"]
        seed = attempt.run.seed if attempt.run else options.get("seed")
        return [
            *("protean", "run", self._near(attempt.scenario)),
            *([] if seed is None else ["--seed", str(seed)]),
            *(word for change in overrides(options.get("set")) for word in ("--set", change)),
            *(f"--{flag.replace('_', '-')}" for flag in _FLAGS if options.get(flag)),
        ]

    def _near(self, place: str | os.PathLike[str]) -> str:
        """Returns a path from the folder in which pytest was started, if it is below it."""
        start = self._item.config.invocation_params.dir
        return str(Path(place).relative_to(start) if Path(place).is_relative_to(start) else place)


_MISSIONS = pytest.StashKey[Missions]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the option."""
    parser.getgroup("protean").addoption(
        "--protean-logs",
        metavar="DIR",
        help="Keep the logs of failing missions below DIR [default: pytest's temporary directory]",
    )


@pytest.fixture
def mission(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Missions:
    """Runs missions, as ``protean_robotics.run`` does; paths are relative to the file of the test."""
    item: pytest.Item = request.node
    chosen = item.config.getoption("--protean-logs")
    kept = item.config.invocation_params.dir / chosen if chosen else tmp_path_factory.getbasetemp() / "missions"
    # The digest keeps tests apart whose names differ in replaced characters only, or behind the end.
    name = re.sub(r"[^\w.=+-]+", "-", item.nodeid)[-_MAX_NAME:].strip("-")
    folder = kept / f"{name}-{hashlib.sha256(item.nodeid.encode()).hexdigest()[:8]}"
    # What an earlier call of pytest has kept.
    shutil.rmtree(folder, ignore_errors=True)
    item.stash[_MISSIONS] = Missions(item, folder)
    return item.stash[_MISSIONS]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Shows the missions of a failing test; removes the logs of one that passes."""
    report = yield
    missions = item.stash.get(_MISSIONS, None)
    if missions is None:
        return report
    if report.failed and not missions.is_shown and (text := missions.report()):
        missions.is_shown = True
        # A section of the failure is shown also where captured output is not, and is part of JUnit files.
        add = getattr(report.longrepr, "addsection", None)
        if add is not None:
            add("missions", text)
        else:
            report.sections.append(("missions", text))
    if report.when == "teardown" and not missions.is_shown:
        shutil.rmtree(missions.folder, ignore_errors=True)
    return report
