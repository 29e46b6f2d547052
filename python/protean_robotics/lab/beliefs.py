"""``python -m protean_robotics.lab beliefs LOG…``: the consistency of beliefs with the true states in logs.

Every belief about a robot that takes part is joined with its true position at the same tick. A belief is consistent if the
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

#: Standard deviation below which a belief is a point, as after an exact sighting (m).
_POINT = 1e-3


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
        Squared error by the belief's covariance , of mean 2 if consistent.
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
    def of(belief: Mapping[str, NDArray[Any]], state: Mapping[str, NDArray[Any]]) -> "Consistency":
        """Joins the tables of ``perception/belief`` and ``world/state`` of a log.

        Beliefs that are points, and those about robots that no longer take part, are left out.
        """
        taking_part = state["robots.status"] == 0
        rows = zip(state["stamp.tick"], state["robots.robot"], state["robots.x"], state["robots.y"], taking_part, strict=True)
        truth = {(int(tick), int(robot)): (x, y) for tick, robot, x, y, takes_part in rows if takes_part}
        keys = list(zip(belief["stamp.tick"].tolist(), belief["robot"].tolist(), strict=True))
        starts = [i for i, key in enumerate(keys) if i == 0 or keys[i - 1] != key]
        found = []
        for first, end in zip(starts, [*starts[1:], len(keys)], strict=True):
            true = truth.get(keys[first])
            mean = np.array((belief["mean_x"][first], belief["mean_y"][first]))
            xx, xy, yy = (float(belief[f"covariance_{name}"][first]) for name in ("xx", "xy", "yy"))
            determinant, spread = xx * yy - xy * xy, (xx + yy) ** 0.5
            if true is None or spread < _POINT or determinant <= 0.0:
                continue
            inverse = np.array(((yy, -xy), (-xy, xx))) / determinant
            off = np.array(true) - mean
            particles = np.column_stack((belief["particles.x"][first:end], belief["particles.y"][first:end])) - mean
            normalised = float(off @ inverse @ off)
            nearer = np.einsum("ij,jk,ik->i", particles, inverse, particles) < normalised
            enclosed = float(np.sum(belief["particles.weight"][first:end][nearer]))
            effective = float(belief["effective_sample_size"][first])
            seen = bool(belief["seen"][first])
            found.append((seen, enclosed, float(np.hypot(*off)), spread, normalised, effective))
        columns = np.array(found, dtype=float).reshape(-1, 6).T
        return Consistency(columns[0] > 0.0, *columns[1:])

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
            parts.append(Consistency.of(log["perception/belief"].to_numpy(), log["world/state"].to_numpy()))
        except (InvalidInput, KeyError) as error:
            print(f"error: {path}: {error}", file=sys.stderr)
            return 2
    print(Consistency.joined(parts).table(), end="")
    return 0
