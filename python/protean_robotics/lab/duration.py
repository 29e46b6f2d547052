"""How long a reproduction takes: estimated before it begins, and again after each experiment."""

import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from . import plans, results
from .experiments import PLAN_SEED_S, Experiment


def seeds_of(experiment: Experiment) -> range:
    """Seeds of its file."""
    seeds = tomllib.loads(experiment.file.read_text(encoding="utf-8"))["seeds"]
    return range(seeds["first"], seeds["first"] + seeds["count"])


def work_s(experiment: Experiment, seeds: range, directory: Path) -> float:
    """CPU time of the missions of an experiment that are not finished (s), where `Experiment.seed_s` was measured."""
    missing = float(len(seeds))
    if results.exist(directory):
        found = results.read(directory)
        finished = sum(seed in seeds for _, seed in found.rows)
        missing -= finished / max(len(found.cells), 1)
    return max(missing, 0.0) * experiment.seed_s


def text(seconds: float) -> str:
    """A duration in words: ``about 40 s``, ``about 12 min``."""
    return f"about {max(10, round(seconds, -1)):.0f} s" if seconds < 90 else f"about {seconds / 60:.0f} min"


@dataclass
class Estimate:
    """The time that is left.

    Attributes
    ----------
    work_s
        CPU time of each part that is not finished (s).
    jobs
        Missions at once.
    """

    work_s: Sequence[float]
    jobs: int

    def __post_init__(self) -> None:
        began = monotonic()
        if sum(self.work_s) > PLAN_SEED_S:
            # As many at once as later: other programs may use the same processors.
            with ThreadPoolExecutor(self.jobs) as pool:
                list(pool.map(plans.make, range(self.jobs)))
        #: Time for a second of work by one of the jobs (s).
        self._pace = (monotonic() - began) / PLAN_SEED_S
        self._began = monotonic()

    def left_s(self, part: int) -> float:
        """Time from the begin of a part on (s); it follows the pace of the parts before."""
        done_s = sum(self.work_s[:part])
        if done_s > PLAN_SEED_S and part < len(self.work_s):
            self._pace = (monotonic() - self._began) * self.jobs / done_s
        return sum(self.work_s[part:]) * self._pace / self.jobs
