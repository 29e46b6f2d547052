"""The numbers of the Chebyshev coverage paper, as claims."""

import math
from collections.abc import Iterable

from ..._core import lab
from ..claim import EXACT, ONE_RUN, POINTS, Claim, Finding, Measured, Paper, Published, Unit, Verdict, number
from ..statistics import Mean
from .evidence import COVERAGE, Evidence, Value, covered
from .page import LENGTHS, TABLE_1

#: Number of keys of the exact map.
_KEYS = 200
#: Way at which the covered part is compared (m).
_WAY = 1000.0
_FALLS = (
    "Mean change under the same keys with its 95 % interval: confirmed if it lies below 0, refuted if it rules out half of"
    " the published change."
)
_LOWERS = (
    "Mean change under the same keys with its 95 % interval: confirmed if it lies below 0, refuted if above. The value"
    " depends on the distribution of the coordinates only, and says nothing about randomness."
)
_COVERS = (
    "Mean difference of missions with the same seeds, with its 95 % interval: confirmed if it lies on the claimed side of"
    " 0, refuted if on the other."
)
_PLAIN = number(4)


def claims(evidence: Evidence) -> list[Claim]:
    """All claims."""
    return [*_exponents(), *_differences(), *_covered(evidence)]


def _claim(key: str, text: str, published: Published, rule: str, finding: Finding) -> Claim:
    return Claim(Paper.COVERAGE, key, text, published, rule, finding)


def _exponents() -> list[Claim]:
    """Lyapunov exponents. The transform is a change of coordinates, which keeps the exponent."""
    rows = (
        ("lyapunov", "Lyapunov exponent of the Chebyshev map, k = 6", 1.7918),
        ("lyapunov_arcsine", "The same after the arcsine transform", 3.2147),
    )
    found = []
    for (key, text, published), orbit in zip(rows, lab.chebyshev_exponents(), strict=True):
        exact = Finding.exact(published, math.log(6.0), _PLAIN)
        finding = Finding(exact.verdict, exact.ours, [f"Along an orbit: {_PLAIN.value(orbit)}"])
        found.append(_claim(key, text, Published.number(published, _PLAIN), EXACT, finding))
    return found


def _differences() -> list[Claim]:
    """The mean difference v(xy) (Table 1)."""
    keys = [lab.chebyshev_key(seed) for seed in range(1, _KEYS + 1)]
    found, longest = [], []
    for name, raw, published, _ in TABLE_1:
        id = "raw" if raw else "arcsine"
        values = [[lab.chebyshev_difference(raw, n, key) for key in keys] for n in LENGTHS]
        for n, theirs, ours in zip(LENGTHS, published, values, strict=True):
            finding = Finding.one_run(theirs, ours, _PLAIN, "keys")
            text = f"Table 1: v(xy), {name}, n = {n}"
            found.append(_claim(f"v.{id}.{n}", text, Published.number(theirs, _PLAIN), ONE_RUN, finding))
        (first, second), (short, long) = published, values
        change = Published.number(second - first, _PLAIN)
        finding = _change(long, short, (second - first) / 2.0)
        found.append(_claim(f"v.{id}.falls", f"Table 1: v(xy) falls with n, {name}", change, _FALLS, finding))
        longest.append((long, second))
    (raw_values, theirs), (transformed, less) = longest
    text = "Table 1: the transform lowers v(xy), n = 10000"
    change = Published.number(less - theirs, _PLAIN)
    found.append(_claim("v.lower", text, change, _LOWERS, _change(transformed, raw_values, 0.0)))
    return found


def _change(values: Iterable[float], others: Iterable[float], limit: float) -> Finding:
    """Tests if values are smaller than others under the same keys; refuted if the change exceeds the limit."""
    mean = Mean.of(a - b for a, b in zip(values, others, strict=True))
    if mean is None:
        return Finding.missing("sequences")
    interval = mean.interval()
    verdict = Verdict.REFUTED if interval.low > limit else Verdict.UNDECIDED
    ours = Measured.number(mean.value, interval, _PLAIN, mean.count, "keys")
    return Finding(Verdict.CONFIRMED if interval.high < 0.0 else verdict, ours)


def _covered(evidence: Evidence) -> list[Claim]:
    """The arcsine transform and coverage (conclusion 4)."""
    evenness: Value = lambda row: -row["coverage"]["unevenness"] if row["coverage"] else None  # noqa: E731
    return [
        _claim(
            "covers_more",
            f"Conclusion 4: the transform covers more, after {_WAY:g} m",
            Published("more"),
            _COVERS,
            _better(evidence, POINTS, lambda row: covered(row, _WAY)),
        ),
        _claim(
            "more_even",
            "Conclusion 4: the transform covers more evenly (fall of the unevenness)",
            Published("more evenly"),
            _COVERS,
            _better(evidence, number(2), evenness),
        ),
    ]


def _better(evidence: Evidence, unit: Unit, value: Value) -> Finding:
    """Tests if a value is larger with the transform, seed by seed."""
    study = evidence.studies.get(COVERAGE)
    cells = [study.cell(case) if study else None for case in ("chebyshev_arcsine", "chebyshev_raw")]
    transformed, raw = cells
    if transformed is None or raw is None:
        return Finding.missing(f"experiment {COVERAGE}")
    pairs = ((value(row), value(raw.rows[seed])) for seed, row in transformed.rows.items() if seed in raw.rows)
    mean = Mean.of(a - b for a, b in pairs if a is not None and b is not None)
    if mean is None:
        return Finding.missing("missions of both emissions")
    interval = mean.interval()
    ours = Measured.number(mean.value, interval, unit, mean.count, "missions")
    return Finding(Verdict.above(interval, 0.0), ours)
