"""Logs of runs: their topics as arrays, their events, their views."""

import html
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _animation, _branch, _plots
from ._arguments import checked
from ._core import Column, LogFile
from ._errors import InvalidInput
from ._table import MadeColumn, Table
from ._views import block, frame, note, table_html

if TYPE_CHECKING:
    # Optional.
    from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]

#: Words of the codes of a robot's status in `world/state`.
_STATUS = ["active", "caught", "escaped", "timed_out", "goal_reached", "disabled", "unknown"]


class Topic(Table):
    """The messages of a topic as a ``Table``.

    A row is one element of a message (a robot, a particle); it repeats ``log_time_ns``, ``publish_time_ns``, ``sequence``
    and the fields of the message. A message without elements is one row. The columns are those of ``protean export``:
    nested fields are named ``stamp.tick``, elements of short arrays ``bounds.0``; after the index of a robot (``robot``)
    there is its name (``robot_name``), last in the table. Units are those of the messages: SI, times in ns where the name
    says so.

    The log is read when the first column is asked for, once.

    Attributes
    ----------
    name
        Name of the topic.
    schema
        Name of the type of its messages.
    messages
        Number of messages.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> run = pr.run("hello", seed=1, in_process=True, out="hello.mcap")
    >>> state = pr.Log("hello.mcap")["world/state"]
    >>> state
    <Topic world/state: 424 messages of protean/msg/WorldState>
    >>> x = state["robots.x"]
    >>> x.dtype, x.shape
    (dtype('float64'), (424,))
    """

    def __init__(self, file: LogFile, name: str, schema: str, messages: int) -> None:
        self._file = file
        self.name: str = name
        self.schema: str = schema
        self.messages: int = messages

    def __reduce__(self) -> tuple[type["Topic"], tuple[Any, ...]]:
        return Topic, (self._file, self.name, self.schema, self.messages)

    @cached_property
    def _read(self) -> tuple[dict[str, Column], int]:
        columns, undecodable = self._file.columns(self.name)
        return {column.name: column for column in columns}, undecodable

    @property
    def _columns(self) -> dict[str, Column]:
        return self._read[0]

    @property
    def _title(self) -> str:
        return self.name

    @property
    def undecodable(self) -> int:
        """Number of messages that do not fit their schema; the table does not contain them."""
        return self._read[1]

    def __repr__(self) -> str:
        return f"<Topic {self.name}: {self.messages} messages of {self.schema}>"

    def _repr_html_(self) -> str:
        """Returns the first rows for a notebook; of messages that are not of ROS 2 their number."""
        title = f"{self.name}: {self.messages} messages of {self.schema}"
        try:
            return table_html(title, self._arrays)
        except InvalidInput as error:
            return block(title, note(str(error)))


class Log:
    """A log.

    Any MCAP file can be opened. A truncated or damaged one is read as far as it goes, as ``protean info`` does; then
    `faults` lists what is missing. In a notebook, a log of Protean shows its animated report.

    Parameters
    ----------
    path
        Path of the file.

    Attributes
    ----------
    path
        Path of the file.
    info
        Contents and condition, as ``protean info --json`` prints them.

    Raises
    ------
    InvalidInput
        The file is missing or is not an MCAP file.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> run = pr.run("hello", seed=1, in_process=True, out="hello.mcap")
    >>> log = pr.Log("hello.mcap")
    >>> log.scenario, log.seed, log.outcome
    ('hello', 1, {'robot': 'escaped'})
    >>> log.topics["world/state"]
    424
    >>> [event["kind"] for event in log.events]
    ['escaped', 'game_over']
    """

    @checked
    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path: Path = Path(path)
        self._file = LogFile(self.path)
        self.info: dict[str, Any] = json.loads(self._file.info())
        self._topics: dict[str, Topic] = {}

    @property
    def topics(self) -> dict[str, int]:
        """Numbers of messages by topic, without topics that have none."""
        topics = self.info["topics"].items()
        return {name: topic["messages"] for name, topic in topics if topic["messages"]}

    def __getitem__(self, topic: str) -> Topic:
        """Returns a topic.

        Raises
        ------
        KeyError
            The log has no such topic.
        """
        found = self._topics.get(topic)
        if found is None:
            info = self.info["topics"].get(topic)
            if info is None:
                known = ", ".join(self.topics)
                raise KeyError(f"{topic}: no topic of the log has this name: expected one of {known}")
            found = Topic(self._file, topic, info["schema"], info["messages"])
            self._topics[topic] = found
        return found

    def __contains__(self, topic: object) -> bool:
        return topic in self.info["topics"]

    def __iter__(self) -> Iterator[str]:
        return iter(self.topics)

    def __len__(self) -> int:
        return len(self.topics)

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """Events of the run, in order, each as in `Run.summary`.

        Keys are ``time_s`` (s), ``kind``, ``x`` and ``y`` (m), ``value``, and where they apply ``robot`` and ``obstacle``
        (names) and ``other`` (index of the other robot or of the exit, id of the obstacle).

        Raises
        ------
        InvalidInput
            The log was recorded by a version with other messages.
        """
        events: list[dict[str, Any]] = json.loads(self._file.events())
        return events

    @cached_property
    def robots(self) -> Table:
        """States of the robots, short: a row for each robot and state, in the words of the package.

        Columns are ``t`` (simulated s), ``name``, ``x``, ``y`` (m), ``theta`` (rad), ``v`` (m/s), ``omega`` (rad/s) and
        ``status`` ("active", "caught", "escaped", "goal_reached", "timed_out" or "disabled"). All that the messages say is
        in ``log["world/state"]``.

        Raises
        ------
        KeyError
            The log has no states.

        Examples
        --------
        >>> import protean_robotics as pr
        >>> run = pr.run("hello", seed=1, in_process=True, out="hello.mcap")
        >>> robots = pr.Log("hello.mcap").robots
        >>> robots.columns
        ['t', 'name', 'x', 'y', 'theta', 'v', 'omega', 'status']
        >>> robots["name"][0], robots["status"][-1]
        ('robot', 'escaped')
        """
        states = self["world/state"]._columns
        time = states["log_time_ns"].values * 1e-9
        time.flags.writeable = False
        status = states["robots.status"]
        codes = np.minimum(status.values, len(_STATUS) - 1)
        columns = {"t": MadeColumn(time), "name": MadeColumn.of(states["robots.robot_name"])}
        columns |= {name: MadeColumn.of(states[f"robots.{name}"]) for name in ("x", "y", "theta", "v", "omega")}
        columns["status"] = MadeColumn(codes, _STATUS, status.empty)
        return Table(columns)

    @cached_property
    def patrols(self) -> Table:
        """Idleness of the patrols over time: a row for each patrol and state; no rows without a patrol.

        Columns are those of the table ``patrols`` of ``protean export``: ``log_time_ns`` (simulated ns), ``robots`` (names),
        ``mean_idleness_s`` and ``worst_idleness_s``, mean and maximum over the places of the time since the last visit, or
        since the begin of the run (s), ``worst_x`` and ``worst_y``, the place of the maximum (m), and ``visited``, the share
        of the places visited so far, 0 to 1.

        Raises
        ------
        InvalidInput
            The log cannot be read.

        Examples
        --------
        >>> import protean_robotics as pr
        >>> run = pr.run("patrol_team", set={"rules.time_limit": 60}, seed=1, in_process=True, out="team.mcap")
        >>> patrols = pr.Log("team.mcap").patrols
        >>> patrols["worst_idleness_s"][-1] < 60
        True
        """
        return Table({column.name: MadeColumn.of(column) for column in self._file.patrols()})

    @cached_property
    def beliefs(self) -> Table:
        """Errors of the beliefs: a row for each belief about a robot in play; no rows without perception.

        Columns are those of the table ``beliefs`` of ``protean export``: ``log_time_ns`` (simulated ns), ``robot`` (name),
        ``seen`` (True if an observer saw it in the tick), ``enclosed``, the share of the weight of the particles that are
        nearer to the mean than the true position, by the covariance, 0 to 1, ``error_m``, the distance of the mean from the
        true position (m), ``deviation_m``, the belief's standard deviation (m), ``normalised_error``, the squared error by
        the covariance, of mean 2 if beliefs are consistent, and ``effective_particles`` before resampling. ``enclosed`` and
        ``normalised_error`` are NaN for a belief that is a point, as after an exact sighting.

        Raises
        ------
        InvalidInput
            The log cannot be read.

        Examples
        --------
        >>> import protean_robotics as pr
        >>> run = pr.run("chase", set={"rules.time_limit": 5}, seed=1, in_process=True, out="beliefs.mcap")
        >>> beliefs = pr.Log("beliefs.mcap").beliefs
        >>> sorted(set(beliefs["robot"]))
        ['evader_1', 'evader_2']
        """
        return Table({column.name: MadeColumn.of(column) for column in self._file.beliefs()})

    @property
    def outcome(self) -> dict[str, str]:
        """Outcome of each robot: "active", "caught", "escaped", "timed_out", "goal_reached" or "disabled".

        Empty if the run did not reach its end.
        """
        return {robot["name"]: robot["outcome"] for robot in self.info["robots"]}

    @property
    def digest(self) -> str | None:
        """Hash of the simulated history, 64 hexadecimal digits.

        None if the log does not contain the whole history.
        """
        return self.info.get("digest")

    @property
    def scenario(self) -> str | None:
        """Name of the scenario; None in logs of other programs."""
        return self.info.get("scenario")

    @property
    def seed(self) -> int | None:
        """Seed of the run; None in logs of other programs."""
        return self.info.get("seed")

    @property
    def faults(self) -> list[str]:
        """Faults of the file; empty if it is complete."""
        condition = self.info["condition"]
        faults = [f"at byte {fault['at']}: {fault['what']}" for fault in condition["faults"]]
        if not faults and not condition["complete"]:
            faults = ["the end is missing"]
        return faults

    @checked
    def branch(
        self,
        at: float,
        *,
        set: Mapping[str, Any] | None = None,
        draw: Mapping[str, tuple[float, float]] | None = None,
        replace: Mapping[str, Any] | None = None,
        command: Mapping[str, Any] | None = None,
        place: Mapping[str, Any] | None = None,
        duration: float | None = None,
        reseed: Sequence[str] | None = None,
        seed: int = 1,
        out: str | os.PathLike[str] | None = None,
        force: bool = False,
        allow_external: bool = False,
    ) -> "Log":
        """Executes the run again up to a moment, and goes on with a change, as ``protean branch``.

        Every message before the moment is compared with the log.

        Parameters
        ----------
        at
            Simulated time from which on the change counts (s), a multiple of the tick.
        set
            Values of the scenario that change, by their dotted keys.
        draw
            Values that are drawn by the number of the random streams: the least and the greatest, by their dotted keys.
        replace
            Other kinds, by the name of the process.
        command
            Forward speed (m/s) and turning rate (rad/s) in place of those of the planner, by the name of the robot.
        place
            Position (m) and perhaps heading (rad) to which a robot is moved at the moment, by its name.
        duration
            Time for which the commands count (s); to the end if None.
        reseed
            Processes with other random streams, or ``["all"]``.
        seed
            Number of these streams.
        out
            Path of the new log; ``LOG-branch-T.mcap`` if None.
        force
            True to overwrite an existing log.
        allow_external
            True if the scenario may start programs.

        Returns
        -------
        Log
            The log of the branch, which names its parent, the moment and the change.

        Raises
        ------
        InvalidInput
            The log or the change is not usable.
        Error
            The history before the moment differs from the log, or the run failed.

        Examples
        --------
        >>> import protean_robotics as pr
        >>> run = pr.run("hello", seed=1, in_process=True, out="parent.mcap")
        >>> branch = run.branch(2.0, command={"robot": (0.1, 0.0)}, out="slow.mcap")
        >>> branch.info["sim_time_s"] > run.time
        True
        """
        change = _branch.arguments(set, draw, replace, command, place, duration, reseed, allow_external)
        path = os.fspath(out) if out is not None else None
        return Log(_branch.branch(os.fspath(self.path), at, seed, path, force, change))

    @checked
    def decided(
        self,
        *,
        moments: int = 16,
        continuations: int = 20,
        share: float = 0.9,
        set: Mapping[str, Any] | None = None,
        draw: Mapping[str, tuple[float, float]] | None = None,
        replace: Mapping[str, Any] | None = None,
        command: Mapping[str, Any] | None = None,
        place: Mapping[str, Any] | None = None,
        duration: float | None = None,
        reseed: Sequence[str] | None = None,
        allow_external: bool = False,
    ) -> dict[str, Any]:
        """Finds when the outcomes of the run were decided, as ``protean decided``.

        Parameters
        ----------
        moments
            Number of moments, evenly from the start to the end.
        continuations
            Number of continuations from each moment.
        share
            Share of the recorded outcome from which on it counts as decided, above 0 and below 1.
        set, draw, replace, command, place, duration, reseed, allow_external
            The change of all continuations, as in `branch`; other streams of all processes if `draw` and `reseed` are None.

        Returns
        -------
        dict
            ``moments``, each with ``time_s`` and the ``outcomes`` of the ``robots``, and ``decisions``: of each robot with an
            outcome ``between_s``, the times between which it was decided (s), absent if it was not before the end, and
            ``certain``.

        Raises
        ------
        InvalidInput
            The log or the change is not usable.
        Error
            A run failed.

        Examples
        --------
        >>> import protean_robotics as pr
        >>> run = pr.run("hello", seed=1, in_process=True, out="decided.mcap")
        >>> decision, = run.decided(moments=2, continuations=5)["decisions"]
        >>> decision["robot"], decision["outcome"], decision["between_s"]
        ('robot', 'escaped', [0.0, 0.0])
        """
        change = _branch.arguments(set, draw, replace, command, place, duration, reseed, allow_external)
        return _branch.decided(os.fspath(self.path), moments, continuations, share, change)

    @checked
    def report(self, out: str | os.PathLike[str] | None = None, *, force: bool = False) -> Path:
        """Writes the animated report, one HTML file, as ``protean report`` does.

        Parameters
        ----------
        out
            Path of the page; by default that of the log with ``.html``.
        force
            True if an existing file may be replaced.

        Returns
        -------
        pathlib.Path
            Path of the page.

        Raises
        ------
        InvalidInput
            The log is not one of Protean, or the page may not be written there.
        """
        page = self.path.with_suffix(".html") if out is None else Path(out)
        self._file.report(page, force)
        return page

    @checked
    def picture(
        self, out: str | os.PathLike[str] | None = None, *, at: float | None = None, force: bool = False
    ) -> Path:
        """Draws the run into a file, as ``protean picture`` does.

        Parameters
        ----------
        out
            Path of the picture, which ends in ``.svg``, ``.png`` or ``.pdf``; by default that of the log with ``.svg``.
        at
            Simulated time that it shows (s); by default the end.
        force
            True if an existing file may be replaced.

        Returns
        -------
        pathlib.Path
            Path of the picture.

        Raises
        ------
        InvalidInput
            The log is not one of Protean or ends before `at`, or the picture may not be written there.
        """
        picture = self.path.with_suffix(".svg") if out is None else Path(out)
        self._file.picture(picture, at, force)
        return picture

    @checked
    def plot(self, quantity: str | None = None, *, ax: "Axes | None" = None) -> "Axes":
        """Draws into axes of matplotlib: the paths of the robots on the map, or a quantity over time.

        Parameters
        ----------
        quantity
            A part of the title of a plot of the report: "belief error", "forward speed", "distance driven" …
        ax
            Axes; new ones if None.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            matplotlib is not installed.
        InvalidInput
            The log is not one of Protean, or has no such quantity.
        """
        return _plots.log_axes(self, ax) if quantity is None else _plots.quantity_axes(self, quantity, ax)

    @checked
    def frames(
        self, *, fps: float = 20.0, speed: float = 1.0, size: tuple[int, int] | None = None
    ) -> Iterator[NDArray[np.uint8]]:
        """Pictures of the run over time, as pixels of one size.

        Parameters
        ----------
        fps
            Number of pictures for each second of the film.
        speed
            Simulated seconds for each second of the film.
        size
            Width and height (px), into which pictures are fitted; by default those of the first one.

        Returns
        -------
        iterator of numpy.ndarray, shape (height, width, 3)
            Red, green and blue, 0 to 255.

        Raises
        ------
        InvalidInput
            The log is not one of Protean, or an argument is out of range.
        """
        return _animation.frames(self, fps, speed, size)

    @checked
    def animate(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        fps: float = 20.0,
        speed: float = 1.0,
        size: tuple[int, int] | None = None,
        force: bool = False,
    ) -> Path:
        """Films the run into a GIF or MP4 file.

        Parameters
        ----------
        out
            Path of the film, which ends in ``.gif`` or ``.mp4``; by default that of the log with ``.gif``. A GIF needs Pillow,
            an MP4 file the program ``ffmpeg`` or the package ``imageio-ffmpeg``.
        fps, speed, size
            As for ``frames``.
        force
            True if an existing file may be replaced.

        Returns
        -------
        pathlib.Path
            Path of the film.

        Raises
        ------
        ImportError
            What writes the film is not installed.
        InvalidInput
            As for ``frames``, or the film may not be written there.
        """
        film = self.path.with_suffix(".gif") if out is None else Path(out)
        return _animation.film(self, film, fps, speed, size, force)

    def __repr__(self) -> str:
        run = f"{self.scenario}, seed {self.seed}, " if self.scenario else ""
        faults = f"; incomplete: {self.faults[0]}" if self.faults else ""
        return f"<Log {self.path}: {run}{self.info['duration_s']:.2f} s, {len(self)} topics{faults}>"

    def __str__(self) -> str:
        """Returns the text of ``protean info``."""
        return self._file.text()

    def _repr_html_(self) -> str:
        """Returns the animated report for a notebook; of logs of other programs the text of ``protean info``."""
        if not self.info["ours"]:
            return f"<pre>{html.escape(str(self))}</pre>"
        return frame(self._file.page())
