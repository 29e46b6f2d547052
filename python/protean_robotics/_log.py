"""Logs of runs: their topics as arrays, their events, their views."""

import html
import importlib
import json
import os
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._arguments import checked
from ._core import Column, LogFile

if TYPE_CHECKING:
    # Optional, and two of them have no types.
    import pandas  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import polars  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import pyarrow  # type: ignore[import-not-found, import-untyped, unused-ignore]


class Topic:
    """The messages of a topic as a table.

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
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(self._read[0])

    @property
    def undecodable(self) -> int:
        """Number of messages that do not fit their schema; the table does not contain them."""
        return self._read[1]

    @cached_property
    def _arrays(self) -> dict[str, NDArray[Any]]:
        return {name: _array(column) for name, column in self._read[0].items()}

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Columns as arrays.

        Returns
        -------
        dict of str to numpy.ndarray, shape (rows,)
            Read-only arrays by the names of the columns: ``bool``, ``int64``, ``uint64``, ``float32``, ``float64``, or
            ``object`` with texts. Numbers are not copied from where they were decoded. A column in which some rows have no
            value (those of messages without elements) is a ``numpy.ma.MaskedArray``.

        Raises
        ------
        InvalidInput
            The messages are not of ROS 2, or the log cannot be read any more.
        """
        return dict(self._arrays)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """Returns a column as in `to_numpy`."""
        try:
            return self._arrays[column]
        except KeyError:
            names = ", ".join(self.columns)
            raise KeyError(f"{self.name} has no column {column}; it has {names}") from None

    def to_arrow(self) -> "pyarrow.Table":
        """Columns as a table of Apache Arrow; numbers share the memory of `to_numpy`.

        Raises
        ------
        ImportError
            pyarrow is not installed.
        """
        arrow = _imported("pyarrow")
        columns = {name: _arrow(arrow, column) for name, column in self._read[0].items()}
        return arrow.table(columns)

    def to_pandas(self) -> "pandas.DataFrame":
        """Columns as a data frame of pandas.

        Raises
        ------
        ImportError
            pandas or pyarrow is not installed.
        """
        _imported("pandas")
        return self.to_arrow().to_pandas()

    def to_polars(self) -> "polars.DataFrame":
        """Columns as a data frame of polars.

        Raises
        ------
        ImportError
            polars or pyarrow is not installed.
        """
        frame: polars.DataFrame = _imported("polars").from_arrow(self.to_arrow())
        return frame

    def __repr__(self) -> str:
        return f"<Topic {self.name}: {self.messages} messages of {self.schema}>"


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
                raise KeyError(f"{topic}: no topic of the log has this name; it has {known}")
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
        """Draws the run into an SVG file, as ``protean picture`` does.

        Parameters
        ----------
        out
            Path of the picture; by default that of the log with ``.svg``.
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
        page = html.escape(self._file.page())
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 720px; border: 0" allowfullscreen></iframe>'


def _array(column: Column) -> NDArray[Any]:
    """Returns a column as an array."""
    values = column.values
    if column.texts is not None:
        values = np.array(column.texts, dtype=object)[values] if column.texts else values.astype(object)
        values.flags.writeable = False
    if column.empty is None:
        return values
    masked: NDArray[Any] = np.ma.MaskedArray(values, mask=column.empty, copy=False)
    return masked


def _arrow(arrow: Any, column: Column) -> Any:
    """Returns a column as an array of Arrow."""
    if column.texts is None:
        return arrow.array(column.values, mask=column.empty)
    codes = arrow.array(column.values, mask=column.empty)
    texts = arrow.array(column.texts, arrow.string())
    return arrow.DictionaryArray.from_arrays(codes, texts).dictionary_decode()


def _imported(name: str) -> ModuleType:
    """Imports an optional package; the error says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        wanted = "'protean-robotics[arrow]'" if name == "pyarrow" else name
        raise ImportError(f"{name} is missing: pip install {wanted}", name=name) from error
