"""Directories of results, as `protean sweep` writes them."""

import json
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._errors import InvalidInput

#: A row of results: the fields of a mission or plan.
Row = dict[str, Any]


@dataclass(frozen=True)
class Cell:
    """A combination of case and parameters.

    Attributes
    ----------
    case
        Name of its case.
    values
        Values of the parameters, in the order of the experiment.
    """

    case: str
    values: tuple[Any, ...]

    @property
    def text(self) -> str:
        """The first value as text; empty without parameters."""
        return value_text(self.values[0]) if self.values else ""


@dataclass(frozen=True)
class Results:
    """The results of an experiment.

    Attributes
    ----------
    directory
        Their directory.
    name
        Name of the experiment.
    title
        Its title.
    program
        Version of the program.
    seeds
        The seeds, as text.
    parameters
        Names of the parameters.
    cells
        Its cells.
    rows
        Rows by cell and seed, in this order.
    cpu_ms
        CPU times of those that have one (ms).
    """

    directory: Path
    name: str
    title: str
    program: str
    seeds: str
    parameters: tuple[str, ...]
    cells: tuple[Cell, ...]
    rows: dict[tuple[int, int], Row]
    cpu_ms: dict[tuple[int, int], float]
    _is_planning: bool = False

    @property
    def is_planning(self) -> bool:
        """True if its missions are plans."""
        return self._is_planning

    @property
    def experiment(self) -> dict[str, Any]:
        """The experiment file."""
        path = self.directory / "experiment.toml"
        try:
            return tomllib.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InvalidInput(f"{path}: {error}: expected the copy that `protean sweep` wrote") from error

    def finished(self, cell: int) -> dict[int, Row]:
        """Rows of a cell that did not fail, by seed."""
        return {seed: row for (of, seed), row in self.rows.items() if of == cell and not is_failed(row)}

    @property
    def failed(self) -> int:
        """Number of missions that failed."""
        return sum(map(is_failed, self.rows.values()))


def is_failed(row: Row) -> bool:
    """True if the mission failed."""
    return row["outcome"] in ("failed", "invalid")


def value_text(value: Any) -> str:
    """Value of a parameter, as `--set` takes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def seeds_text(seeds: Sequence[int]) -> str:
    """Ascending seeds as ranges: ``1..200, 500``."""
    ranges: list[list[int]] = []
    for seed in seeds:
        if ranges and ranges[-1][1] + 1 == seed:
            ranges[-1][1] = seed
        else:
            ranges.append([seed, seed])
    return ", ".join(str(first) if first == last else f"{first}..{last}" for first, last in ranges)


def exist(directory: Path) -> bool:
    """True if there are results in a directory."""
    return (directory / "manifest.json").exists()


def read(directory: Path) -> Results:
    """Reads the results in a directory.

    Raises
    ------
    InvalidInput
        It has none, or they are damaged.
    """
    path = directory / "manifest.json"
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
        cells = tuple(Cell(cell["case"], tuple(cell["values"])) for cell in manifest["cells"])
        seeds = [seed for first, last in manifest["seeds"] for seed in range(first, last + 1)]
    except OSError as error:
        raise InvalidInput(f"{directory}: {error.strerror}: manifest.json: expected the directory of the results of a sweep") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InvalidInput(f"{path}: {error!r}: expected the manifest of a sweep") from error
    rows: dict[tuple[int, int], Row] = {}
    cpu_ms: dict[tuple[int, int], float] = {}
    for entry in _journal(directory / "journal.jsonl"):
        mission, row = (entry["cell"], entry["seed"]), entry["row"]
        # A result replaces a failure.
        if mission not in rows or (is_failed(rows[mission]) and not is_failed(row)):
            rows[mission] = row
            if entry.get("cpu_ms") is not None:
                cpu_ms[mission] = entry["cpu_ms"]
    return Results(
        directory=directory,
        name=manifest["experiment"],
        title=manifest["title"],
        program=manifest["program"],
        seeds=seeds_text(seeds),
        parameters=tuple(manifest["parameters"]),
        cells=cells,
        rows=dict(sorted(rows.items())),
        cpu_ms=cpu_ms,
        _is_planning=manifest.get("kind") == "planning",
    )


def _journal(path: Path) -> Iterator[dict[str, Any]]:
    """Lines of the journal; a last one that a killed sweep left incomplete is left out."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror}: expected the journal of a sweep") from error
    for number, line in enumerate(lines, 1):
        if not line.endswith("\n"):
            return
        try:
            entry: dict[str, Any] = json.loads(line)
        except ValueError as error:
            raise InvalidInput(f"{path}:{number}: {error}: expected the line as the sweep wrote it") from error
        yield entry
