"""``python -m protean_robotics.lab beliefs LOG…``: the consistency of beliefs with the true states in logs.

The table ``beliefs`` of a log has the errors of every belief about a robot in play. A belief is consistent if the
true position lies in its 50 % region in half of the ticks and in its 95 % region in 95 % of them, and if the normalised
error, which is chi-squared with 2 degrees of freedom for a Gaussian belief, has the mean 2. Regions are those of the
particles: the share of the weight that is nearer to the mean, by the belief's own covariance, than the true position is.
"""

import argparse
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _log
from .._errors import InvalidInput


@dataclass(frozen=True)
class Consistency:
    """Consistency of beliefs: one value for each belief in each array.

    Attributes
    ----------
    seen
        True if an observer saw the robot in the tick.
    enclosed
        Share of the weight nearer to the mean than the true position, 0 to 1.
    error, spread
        Distance of the mean from the true position, and the belief's standard deviation (m).
    normalised
        Squared error by the belief's covariance, of mean 2 if consistent.
    effective
        Effective number of particles before resampling.
    """

    seen: NDArray[np.bool_]
    enclosed: NDArray[np.float64]
    error: NDArray[np.float64]
    spread: NDArray[np.float64]
    normalised: NDArray[np.float64]
    effective: NDArray[np.float64]

    @staticmethod
    def of(beliefs: Mapping[str, NDArray[Any]]) -> "Consistency":
        """Takes the table of the beliefs of a log; those that are points are left out."""
        names = ("seen", "enclosed", "error_m", "deviation_m", "normalised_error", "effective_particles")
        spread = ~np.isnan(beliefs["enclosed"])
        return Consistency(*(np.asarray(beliefs[name])[spread] for name in names))

    @staticmethod
    def joined(parts: Iterable["Consistency"]) -> "Consistency":
        """The beliefs of several logs as one."""
        columns = zip(*((p.seen, p.enclosed, p.error, p.spread, p.normalised, p.effective) for p in parts), strict=True)
        return Consistency(*map(np.concatenate, columns))

    def table(self) -> str:
        """A Markdown table with a row for robots out of sight and one for robots in sight."""
        text = "| robot | beliefs | in the 50 % region | in the 95 % region | normalised error, mean | median | error | deviation |"
        text += " effective particles |\n|---|---|---|---|---|---|---|---|---|\n"
        for title, rows in (("out of sight", ~self.seen), ("in sight", self.seen)):
            if not rows.any():
                continue
            half, most = (float(np.mean(self.enclosed[rows] <= share)) for share in (0.5, 0.95))
            normalised = self.normalised[rows]
            error, spread = (float(np.sqrt(np.mean(values[rows] ** 2))) for values in (self.error, self.spread))
            text += f"| {title} | {int(rows.sum())} | {half:.0%} | {most:.0%} | {normalised.mean():.1f} |"
            text += f" {float(np.median(normalised)):.1f} | {error:.2f} m | {spread:.2f} m | {self.effective[rows].mean():.0f} |\n"
        return text


def main(arguments: Sequence[str]) -> int:
    """Prints the table over all logs."""
    parser = argparse.ArgumentParser("python -m protean_robotics.lab beliefs", description="Consistency of the beliefs in logs.")
    parser.add_argument("log", nargs="+", type=Path, help="log of a run with perception")
    parts = []
    for path in parser.parse_args(arguments).log:
        try:
            log = _log.Log(path)
            parts.append(Consistency.of(log.beliefs.to_numpy()))
        except InvalidInput as error:
            print(f"error: {path}: {error}", file=sys.stderr)
            return 2
    print(Consistency.joined(parts).table(), end="")
    return 0
