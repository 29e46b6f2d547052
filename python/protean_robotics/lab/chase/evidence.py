"""Published values, and our results for them.

The published values are read from the bars of the paper's figures. All are multiples of 0.1, and the number of games is
not given: each is taken as out of ten. The error bars of the figures are a tenth of each bar, whatever the number of
games, and are not used.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from ..._errors import InvalidInput
from .. import words
from ..plans import Plan
from ..results import Results
from ..statistics import BySeed, Crossings, Interval, Sample, fisher_exact, holm, wilson

#: Names of the methods in our experiments.
BRAITENBERG, FIELD, LINE, EXACT, FILTER = (
    "braitenberg",
    "potential_field",
    "rrt_star_line",
    "exact",
    "particle_filter",
)
#: The parameter of the experiments.
_RATIO = "relative_speed"
#: Assumed number of games of each published value.
_GAMES = 10


class Published(NamedTuple):
    """A published value: its method, the speed relative to the Police, and escapes in ten games."""

    method: str
    ratio: float
    escaped: int

    @property
    def share(self) -> float:
        """Share of evaders that escape."""
        return self.escaped / _GAMES

    @property
    def interval(self) -> Interval:
        """95 % interval of the chance (Wilson)."""
        return wilson(self.escaped, _GAMES)

    def alike(self, ours: Sample) -> float:
        """P-value of the hypothesis that our games have the same chance: Fisher's exact test."""
        # The effective size is a number of independent outcomes.
        size = math.floor(ours.effective_size() + 0.5)
        return fisher_exact((math.floor(size * (ours.share or 0.0) + 0.5), size), (self.escaped, _GAMES))


#: Fig. 2: three methods against Police with exact knowledge.
SPEED = (
    Published(BRAITENBERG, 1.5, 0),
    Published(BRAITENBERG, 2.0, 0),
    Published(BRAITENBERG, 2.5, 0),
    Published(BRAITENBERG, 3.0, 1),
    Published(FIELD, 1.5, 2),
    Published(FIELD, 2.0, 7),
    Published(FIELD, 2.5, 5),
    Published(FIELD, 3.0, 5),
    Published(LINE, 1.5, 6),
    Published(LINE, 2.0, 8),
    Published(LINE, 2.5, 7),
    Published(LINE, 3.0, 7),
)
#: Fig. 3: knowledge of the Police. The method is not stated; RRT* fits the paper's conclusion about its critical speed.
KNOWLEDGE = (
    Published(EXACT, 0.8, 0),
    Published(EXACT, 0.9, 2),
    Published(EXACT, 1.0, 2),
    Published(FILTER, 0.8, 3),
    Published(FILTER, 0.9, 6),
    Published(FILTER, 1.0, 8),
)
#: The speeds of Fig. 2 and of Fig. 3.
SPEED_RATIOS, KNOWLEDGE_RATIOS = (1.5, 2.0, 2.5, 3.0), (0.8, 0.9, 1.0)


def same(a: float, b: float) -> bool:
    """True if two speeds are equal within rounding."""
    return abs(a - b) < 1e-9


@dataclass(frozen=True)
class Cell:
    """All games of one method at one speed.

    Attributes
    ----------
    method
        Name of its case.
    ratio
        Speed of the evaders relative to the Police.
    games
        Escaped evaders and all evaders, game by game.
    caught, held_out
        Evaders that were caught, and that were still in the game at the time limit.
    failed
        Failed games; they are not in other counts.
    """

    method: str
    ratio: float
    games: BySeed = field(default_factory=dict)
    caught: int = 0
    held_out: int = 0
    failed: int = 0

    @property
    def escapes(self) -> Sample:
        """The escapes of all games."""
        return Sample.of(self.games.values())


@dataclass(frozen=True)
class Study:
    """The results of one experiment.

    Attributes
    ----------
    name, program, seeds
        Of the experiment; version of the program; as text.
    titles
        Titles of the methods that are compared, by their names, in the order of the experiment.
    cells
        The cells, in the order of the experiment.
    """

    name: str
    program: str
    seeds: str
    titles: dict[str, str]
    cells: list[Cell]

    @staticmethod
    def of(results: Results) -> "Study":
        """Study of an experiment whose only parameter is the speed.

        Raises
        ------
        InvalidInput
            It varies something else.
        """
        if results.parameters != (_RATIO,) or not all(type(cell.values[0]) in (int, float) for cell in results.cells):
            raise InvalidInput(
                f"{results.directory}: the experiment varies {list(results.parameters)}: expected `{_RATIO}` alone, a number"
            )
        cells = []
        for number, cell in enumerate(results.cells):
            rows = results.finished(number)
            cells.append(
                Cell(
                    method=cell.case,
                    ratio=float(cell.values[0]),
                    games={seed: (row["escaped"], row["evaders"]) for seed, row in rows.items()},
                    caught=sum(row["caught"] for row in rows.values()),
                    held_out=sum(row["held_out"] for row in rows.values()),
                    failed=sum(of == number for of, _ in results.rows) - len(rows),
                )
            )
        cases = results.experiment.get("cases", [])
        titles = {case["name"]: case.get("title", case["name"].replace("_", " ")) for case in cases}
        return Study(results.name, results.program, results.seeds, titles, cells)

    def cell(self, method: str, ratio: float) -> Cell | None:
        """Cell of a method at a speed; None without games."""
        found = next((c for c in self.cells if c.method == method and same(c.ratio, ratio)), None)
        return found if found and found.escapes.games else None

    def compared(self, values: Sequence[Published]) -> dict[Published, tuple[Cell, float]]:
        """The cell of each published value that has games, and the p-value of both chances by Holm's method over these."""
        found = [(value, cell) for value in values if (cell := self.cell(value.method, value.ratio))]
        adjusted = holm([value.alike(cell.escapes) for value, cell in found])
        return {value: (cell, p) for (value, cell), p in zip(found, adjusted, strict=True)}

    def ratios(self, method: str) -> list[float]:
        """Speeds of a method that have games, ascending."""
        return sorted(c.ratio for c in self.cells if c.method == method and c.escapes.games)

    def pooled(self, method: str, ratios: Sequence[float]) -> BySeed | None:
        """Games of a method at several speeds, those of one seed as one; None if a speed has none.

        Seeds that a speed lacks are left out.
        """
        games = []
        for ratio in ratios:
            cell = self.cell(method, ratio)
            if cell is None:
                return None
            games.append(cell.games)
        seeds = set(games[0]).intersection(*games[1:])
        return {seed: (sum(g[seed][0] for g in games), sum(g[seed][1] for g in games)) for seed in seeds}

    def title(self, method: str) -> str:
        """Title of a method."""
        return self.titles.get(method, method)

    def crossings(self, method: str) -> Crossings | None:
        """Speeds at which the chance of a method crosses one half; None without games."""
        cells = (cell for r in self.ratios(method) if (cell := self.cell(method, r)))
        return Crossings.of((c.ratio, c.escapes.share or 0.0, c.escapes.interval()) for c in cells)

    def brackets(self, method: str, crossings: Crossings) -> str:
        """Text of the brackets: ``1.2× … 1.25×``, and ``falls`` where the chance does."""
        if crossings.brackets:
            parts = ((b, "" if b.rises else "falls ") for b in crossings.brackets)
            return ", ".join(f"{falls}{words.ratio(b.low)} … {words.ratio(b.high)}" for b, falls in parts)
        speeds = self.ratios(method)
        first = self.cell(method, speeds[0])
        if first and (first.escapes.share or 0.0) >= 0.5:
            return f"below {words.ratio(speeds[0])}"
        return f"above {words.ratio(speeds[-1])}"


@dataclass
class Evidence:
    """Input of the page, which notes missing parts.

    Attributes
    ----------
    studies
        Studies by the name of their experiment, one of `EXPERIMENTS`.
    plans
        Single plans.
    """

    studies: dict[str, Study] = field(default_factory=dict)
    plans: list[Plan] | None = None

    def all_speeds(self) -> Study | None:
        """Escape chances by speed of all our planners."""
        speed, more = self.studies.get("escape_vs_speed"), self.studies.get("escape_vs_speed_rrt_star")
        if speed is None or more is None:
            return speed
        return replace(speed, titles=speed.titles | more.titles, cells=speed.cells + more.cells)


#: Names of the experiments.
EXPERIMENTS = ("escape_vs_speed", "escape_vs_speed_rrt_star", "escape_vs_speed_paper", "knowledge", "knowledge_paper")
