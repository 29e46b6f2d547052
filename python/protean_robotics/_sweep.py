"""Sweeps: experiments of many missions, on this machine or on any executor."""

import fcntl
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, Protocol
from uuid import uuid4

from ._arguments import checked, refused
from ._core import Interruption, missions_to_run, sweep_in_process
from ._errors import Error, InvalidInput
from ._optional import imported
from ._planner import ONLY_IN_PROCESS, Planner, placed, planners_of
from ._plots import axes
from ._program import json_of, overrides
from ._views import sweep_html
from .lab import figures, results

if TYPE_CHECKING:
    # Optional, and three of them have no types.
    import pandas  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import polars  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import pyarrow  # type: ignore[import-not-found, import-untyped, unused-ignore]
    from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]

#: Parts of an experiment for each processor of this machine, if the caller does not say how many: a worker that is
#: slow or lost holds up a small part.
_PARTS_PER_PROCESSOR = 4
#: Sweeps of which Ctrl-C has ended a part in this process: a pool may have given it others already.
_interrupted: set[str] = set()
#: Time between two looks at the parts (s).
_INTERVAL = 0.05
#: Shortest time between two mergings (s).
_MERGE_INTERVAL = 1.0
#: Values of ``keep_logs``.
_LOGS = ("none", "failed", "all")
#: Time between two lines of progress (s).
_LINE_INTERVAL = 10.0


class Future(Protocol):
    """A call that an executor carries out: ``concurrent.futures.Future``, or a job of submitit."""

    def done(self) -> bool:
        """True if it has ended."""
        ...

    def result(self) -> Any:
        """Result of the call; raises what it raised."""
        ...


class Executor(Protocol):
    """Carries out calls elsewhere, as ``concurrent.futures.Executor`` does."""

    def submit(self, call: Callable[..., Any], /, *arguments: Any) -> Future:
        """Begins a call."""
        ...


@dataclass(frozen=True, repr=False)
class Sweep:
    """Results of an experiment.

    Attributes
    ----------
    directory
        Directory of the results: ``results.csv``, ``results.parquet`` and more.
    summary
        Summary of the cells, as ``protean sweep --json`` prints it.
    """

    directory: Path
    summary: dict[str, Any]

    def __repr__(self) -> str:
        return f"<Sweep {self.directory}: {self.summary['missions']} missions, {len(self.summary['failures'])} failed>"

    @property
    def table(self) -> Path:
        """Table of the missions, for ``polars.read_parquet`` and ``pandas.read_parquet``."""
        return self.directory / "results.parquet"

    def to_arrow(self) -> "pyarrow.Table":
        """Table of the missions as a table of Apache Arrow.

        Raises
        ------
        ImportError
            pyarrow is not installed.
        """
        return imported("pyarrow.parquet").read_table(self.table)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Returns the table of the missions as an Arrow stream, as `to_arrow`."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_pandas(self) -> "pandas.DataFrame":
        """Table of the missions as a data frame of pandas.

        Raises
        ------
        ImportError
            pandas or pyarrow is not installed.
        """
        imported("pandas")
        return self.to_arrow().to_pandas()

    def to_polars(self) -> "polars.DataFrame":
        """Table of the missions as a data frame of polars.

        Raises
        ------
        ImportError
            polars is not installed.
        """
        frame: polars.DataFrame = imported("polars").read_parquet(self.table)
        return frame

    def plot(self, figure: str | None = None, *, ax: "Axes | None" = None) -> "Axes":
        """Draws a figure of the experiment into axes of matplotlib.

        Parameters
        ----------
        figure
            Name of the figure in the experiment file; the first one if None.
        ax
            Axes; new ones if None.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            matplotlib or scipy is not installed.
        InvalidInput
            The experiment has no such figure.
        """
        found = {chart.name: chart for chart in self._charts()}
        name = next(iter(found), None) if figure is None else figure
        if name not in found:
            raise refused("figure", figure, f"one of {', '.join(found)}" if found else "a figure in the experiment file")
        return figures.draw(found[name], axes(ax))

    def _charts(self) -> list[figures.Chart]:
        found = results.read(self.directory)
        return [] if found.is_planning else figures.charts(found)

    def _repr_html_(self) -> str:
        """Returns the figures for a notebook, without matplotlib the numbers of missions alone."""
        try:
            pictures = [(chart.name, figures.svg(chart)) for chart in self._charts()]
        except ImportError:
            pictures = []
        return sweep_html(self, pictures)


@dataclass(frozen=True)
class _Task:
    """An experiment and how its missions run; executors send it to their workers."""

    experiment: str
    seeds: str | None
    overrides: list[str]
    in_process: bool
    planners: dict[str, Planner]
    allow_external: bool
    allow_outside: bool
    retry_failed: bool
    keep_logs: str
    worst: str | None
    name: str = field(default_factory=lambda: uuid4().hex)
    placed: list[SimpleNamespace] = field(init=False, repr=False)
    #: Programs that run its parts in this process.
    children: list["subprocess.Popen[str]"] = field(init=False, repr=False, default_factory=list)
    #: Ends its parts that run in threads of this process.
    interruption: Interruption = field(init=False, repr=False, default_factory=Interruption)

    def __post_init__(self) -> None:
        object.__setattr__(self, "placed", placed(self.planners))

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        values = (getattr(self, name) for name, field in self.__dataclass_fields__.items() if field.init)
        return _Task, tuple(values)

    def run(self, out: Path, shard: str | None, jobs: int | None, quiet: bool) -> dict[str, Any]:
        """Runs a part of the experiment on this machine; returns the summary."""
        if self.planners:
            text = sweep_in_process(self.experiment, out, self, shard=shard, jobs=jobs, quiet=quiet)
            summary: dict[str, Any] = json.loads(text)
            return summary
        command = ["sweep", self.experiment, f"--out={out}", *(f"--set={change}" for change in self.overrides)]
        keep_logs = None if self.keep_logs == "none" else self.keep_logs
        values = {"--seeds": self.seeds, "--shard": shard, "--jobs": jobs, "--keep-logs": keep_logs, "--worst": self.worst}
        command += [f"{option}={value}" for option, value in values.items() if value is not None]
        flags = {
            "--in-process": self.in_process,
            "--allow-external": self.allow_external,
            "--allow-outside": self.allow_outside,
            "--retry-failed": self.retry_failed,
            "--quiet": quiet,
        }
        return json_of(command + [flag for flag, given in flags.items() if given], self.children)


@checked
def sweep(
    experiment: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
    shards: int | None = None,
    jobs: int | None = None,
    seeds: Sequence[int] | None = None,
    set: Mapping[str, Any] | None = None,
    in_process: bool = False,
    planners: Mapping[str, Callable[..., Any]] | None = None,
    retry_failed: bool = False,
    keep_logs: Literal["none", "failed", "all"] = "none",
    worst: str | None = None,
    allow_external: bool = False,
    allow_outside: bool = False,
    quiet: bool = False,
) -> Sweep:
    """Runs the missions of an experiment that are not finished.

    The table of results depends on the experiment alone, byte for byte: not on the executor, the number of parts, or
    interruptions. After an interruption or the loss of a worker, the same call runs the missing missions.

    Parameters
    ----------
    experiment
        Path of an experiment file.
    out
        Directory of the results; ``results/EXPERIMENT`` if None.
    executor
        Runs parts of the experiment elsewhere: any ``concurrent.futures.Executor`` (pools of processes, Dask's
        ``get_executor()``, ``mpi4py.futures``), or another object whose ``submit(call, *arguments)`` returns an object
        with ``done()`` and ``result()``. Its workers have this package and see the experiment at the same path. None
        runs missions on the cores of this machine.
    shards
        Number of parts that the executor gets; 4 for each processor of this machine if None.
    jobs
        Missions at once on this machine; the number of processors if None. Workers of an executor run one at a time.
    seeds
        Seeds in the place of the experiment's: a range, a list or an array of consecutive whole numbers.
    set
        Values that replace those of every scenario, by their dotted keys.
    in_process
        True to run each mission in one thread: the same results, many times faster.
    planners
        Planners, also as mere functions or classes, in the place of those of the scenarios, by the name of a robot, a team or
        a process; with `in_process` only.
    retry_failed
        True to run failed missions again.
    keep_logs
        Missions that keep their log, in the folder ``logs`` of the results.
    worst
        Column of numbers of the results and its worse end, ``"contacts=max"`` for example: the missions there are
        ``summary["worst"]``. If None, those at the time limit, then those with contacts.
    allow_external
        True if scenarios may start programs (``command``). Check them first.
    allow_outside
        True if experiment and scenarios may use files outside their folders.
    quiet
        True to show no progress.

    Returns
    -------
    Sweep
        Directory and summary; the summary counts missions that failed.

    Raises
    ------
    InvalidInput
        The experiment or an argument is invalid; nothing has been started.
    Error
        Results cannot be stored, or parts failed; the results of the others are kept.
    KeyboardInterrupt
        After Ctrl-C; finished missions are kept, with an executor those of finished parts.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> from pathlib import Path
    >>> text = '''
    ... scenario = "builtin:hello"
    ... seeds = { first = 1, count = 2 }
    ... [parameters.limit]
    ... set = "rules.time_limit"
    ... [grid]
    ... limit = [1, 2]
    ... '''
    >>> _ = Path("limits.toml").write_text(text)
    >>> done = pr.sweep("limits.toml", in_process=True, quiet=True)
    >>> done.table
    PosixPath('results/limits/results.parquet')
    >>> done.summary["carried_out"]
    4
    """
    if planners and not in_process:
        raise InvalidInput(ONLY_IN_PROCESS)
    if seeds is not None and any(after != before + 1 for before, after in pairwise(seeds)):
        raise refused("seeds", seeds, "consecutive whole numbers, as range(1, 101)")
    if executor is not None and not callable(getattr(executor, "submit", None)):
        expected = "an object with submit(call, *arguments), as of concurrent.futures"
        if type(executor).__module__.startswith("joblib"):
            expected = "joblib.externals.loky.get_reusable_executor()"
        raise refused("executor", executor, expected)
    if keep_logs not in _LOGS:
        raise refused("keep_logs", keep_logs, f"one of {', '.join(_LOGS)}")
    task = _Task(
        experiment=os.fspath(Path(experiment).absolute()),
        seeds=None if seeds is None else f"{seeds[0]}..{seeds[-1]}",
        overrides=overrides(set),
        in_process=in_process,
        planners=planners_of(planners),
        allow_external=allow_external,
        allow_outside=allow_outside,
        retry_failed=retry_failed,
        keep_logs=keep_logs,
        worst=worst,
    )
    directory, missing = missions_to_run(task.experiment, None if out is None else Path(out), task)
    if executor is not None and missing:
        count = shards or min(_PARTS_PER_PROCESSOR * (os.cpu_count() or 1), len(missing))
        _distribute(task, executor, directory, count, missing, quiet)
        task, quiet = replace(task, retry_failed=False), True
    return Sweep(directory, task.run(directory, None, jobs, quiet))


def _distribute(task: _Task, executor: Executor, out: Path, count: int, missing: list[int], quiet: bool) -> None:
    """Runs the parts that have missing missions on an executor, and merges those that ended into the results."""
    shards = sorted({number % count for number in missing})
    running: list[Future] = []
    parts: list[bytes] = []
    failures: list[BaseException] = []
    shown = time.monotonic()
    next_merge = shown + _MERGE_INTERVAL
    try:
        for shard in shards:
            try:
                running.append(executor.submit(_part, task, f"{shard + 1}/{count}"))
            except Exception as error:  # What the executor raises: a broken pool, for example.
                failures.append(error)
        while running:
            time.sleep(_INTERVAL)
            for future in list(running):
                try:
                    if not future.done():
                        continue
                    part = future.result()
                    # Whole, or the executor has returned something else.
                    with zipfile.ZipFile(io.BytesIO(part)) as files:
                        if files.testzip() is not None:
                            raise zipfile.BadZipFile("a damaged part")
                    parts.append(part)
                except Exception as error:  # What the executor or the part raised.
                    failures.append(error)
                running.remove(future)
            now = time.monotonic()
            if now > next_merge:
                failures += _merge(parts, out)
                parts.clear()
                # Every merging writes all tables anew: the larger they are, the more parts go into one.
                next_merge = time.monotonic() + max(_MERGE_INTERVAL, 10 * (time.monotonic() - now))
            if not quiet and (now > shown + _LINE_INTERVAL or not running):
                shown = now
                print(f"{len(shards) - len(running) - len(failures)}/{len(shards)} parts", file=sys.stderr, flush=True)
    finally:
        for future in running:
            cancel = getattr(future, "cancel", None)
            if cancel is not None:
                cancel()
        if running:
            # Those that run in threads of this process go on otherwise; Ctrl-C reaches other processes by itself.
            task.interruption.set()
            for child in list(task.children):
                child.send_signal(signal.SIGINT)
        failures += _merge(parts, out)
    if failures:
        first = failures[0]
        if isinstance(first, InvalidInput):
            raise first
        raise Error(
            f"{len(failures)} of {len(shards)} parts failed: {type(first).__name__}: {first}; the results of the others"
            " are kept, the same call runs the missing missions"
        ) from first


@contextmanager
def _scratch() -> Iterator[Path]:
    """A temporary directory. It is locked: after the kill of this process, ``protean clean`` removes it."""
    while True:
        with tempfile.TemporaryDirectory(prefix="protean-scratch-", ignore_cleanup_errors=True) as name:
            folder = Path(name)
            # Until it is locked, a `clean` may remove it.
            try:
                lock = os.open(folder, os.O_RDONLY)
            except FileNotFoundError:
                continue
            try:
                # A file system without locks refuses that of a `clean`, too.
                with suppress(OSError):
                    fcntl.flock(lock, fcntl.LOCK_SH)
                if folder.exists():
                    yield folder
                    return
            finally:
                os.close(lock)


def _part(task: _Task, shard: str) -> bytes:
    """Runs one part of an experiment, on a worker; returns its results as an archive."""
    if task.name in _interrupted:
        raise Error("the sweep is interrupted")
    try:
        return _archive(task, shard)
    except KeyboardInterrupt:
        _interrupted.add(task.name)
        raise


def _archive(task: _Task, shard: str) -> bytes:
    with _scratch() as folder:
        part = folder / "part"
        task.run(part, shard, 1, True)
        # Merging writes the tables anew.
        tables = {part / f"{path.stem}{suffix}" for path in part.glob("*.parquet") for suffix in (".csv", ".parquet")}
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as files:
            for path in part.rglob("*"):
                if path not in tables:
                    files.write(path, path.relative_to(part))
        return archive.getvalue()


def _merge(parts: list[bytes], out: Path) -> list[Error]:
    """Merges parts into results; returns the failures of those that are something else."""
    if not parts:
        return []
    try:
        with _scratch() as folder:
            directories = [os.path.join(folder, str(number)) for number in range(len(parts))]
            for part, directory in zip(parts, directories, strict=True):
                with zipfile.ZipFile(io.BytesIO(part)) as files:
                    files.extractall(directory)
            json_of(["sweep", "merge", *directories, f"--out={out}"])
            for log in folder.glob("*/logs/*"):
                (out / "logs").mkdir(exist_ok=True)
                shutil.move(log, out / "logs" / log.name)
    except Error as error:
        # One that does not fit must not take the others with it.
        if len(parts) == 1:
            return [Error(str(error))]
        return [failure for part in parts for failure in _merge([part], out)]
    return []
