"""The numbers of the cat-map patrol paper, as claims."""

import math

from ..claim import EXACT, ONE_RUN, Claim, Finding, Measured, Paper, Published, Unit, Verdict, number
from .evidence import ALPHA, SQUARE, Evidence, Laps, lap, laps, visits

#: Rule of the numbers of fictive obstacles.
_RECONSTRUCTION = (
    "Undecided: the method of fictive obstacles is a reconstruction, since its own paper was not available."
)
_METRES, _RADIANS, _RATE, _SPEED = (number(4, unit) for unit in ("m", "rad", "/s", "m/s"))

#: Case 1: an octagon in 120 s, a zig-zag of 1.7 m. Keys, statements, published numbers.
_CASE_1 = (
    ("speed", "§5.1: speed needed", 0.9651, _SPEED),
    ("length", "§5.1: length of a lap (speed times 120 s)", 115.8, number(1, "m")),
    ("mae", "§5.1: MAE", 0.9352, _METRES),
    ("maa", "§5.1: mean absolute angle between turns", 0.7815, _RADIANS),
    ("maa_folded", "§5.1: mean angle, folded to acute ones", 0.7815, _RADIANS),
    ("andc", "§5.1: changes of direction per second", 0.4024, _RATE),
)
#: Case 2: a square at the speed of case 1, a zig-zag of 1.3 m.
_CASE_2 = (
    ("mae", "§5.2: MAE", 0.7120, _METRES),
    ("maa", "§5.2: mean absolute angle between turns", 0.7854, _RADIANS),
    ("maa_folded", "§5.2: mean angle, folded to acute ones", 0.7854, _RADIANS),
    ("andc", "§5.2: changes of direction per second", 0.4024, _RATE),
)
#: Time of a lap of the square, 40 m, at the speed along the octagon (s).
_T_MAX_2 = 99.411
#: Number of steps from which the exponent of the cat map has its digits.
_STEPS = 100_000


def claims(evidence: Evidence) -> list[Claim]:
    """All claims."""
    octagon, square = laps("patrol_octagon", 1.7), laps("patrol_square", 1.3, _T_MAX_2)
    return [
        _exact("lyapunov", "Lyapunov exponent of the cat map", 0.9624, _cat_map_exponent(), number(4)),
        _exact("v", "Speed along the octagon in 120 s", 0.4024, octagon.v, _SPEED),
        *(_of_laps("case1", *row, octagon) for row in _CASE_1),
        _driven(evidence),
        *(_of_laps("case2", *row, square) for row in _CASE_2),
        *_fictive(evidence),
    ]


def _claim(key: str, text: str, published: float, unit: Unit, rule: str, finding: Finding) -> Claim:
    return Claim(Paper.PATROL, key, text, Published.number(published, unit), rule, finding)


def _exact(key: str, text: str, published: float, ours: float, unit: Unit) -> Claim:
    return _claim(key, text, published, unit, EXACT, Finding.exact(published, ours, unit))


def _cat_map_exponent() -> float:
    """Mean growth of a tangent vector of the cat map, renormalised at every step."""
    x = y = math.sqrt(0.5)
    growths = []
    for _ in range(_STEPS):
        x, y = x + y, x + 2.0 * y
        length = math.hypot(x, y)
        growths.append(math.log(length))
        x, y = x / length, y / length
    return math.fsum(growths) / _STEPS


def _of_laps(case: str, key: str, text: str, published: float, unit: Unit, found: Laps) -> Claim:
    finding = Finding.one_run(published, found.values[key], unit, "keys")
    return _claim(f"{case}.{key}", text, published, unit, ONE_RUN, finding)


def _driven(evidence: Evidence) -> Claim:
    """The distance from the octagon that the simulated robot drives."""
    published = 0.9352
    study = evidence.studies.get(ALPHA)
    cell = study.cell("paper_fit", "1.7") if study else None
    finding = Finding.missing(f"experiment {ALPHA}")
    if cell is not None:
        values = cell.values(lambda row: lap(row, "driven", "mae_m"))
        finding = Finding.one_run(published, values, _METRES, "missions")
    text = "§5.1: MAE, of the path that the simulated robot drives"
    return _claim("case1.mae_driven", text, published, _METRES, ONE_RUN, finding)


def _fictive(evidence: Evidence) -> list[Claim]:
    """The numbers of fictive obstacles."""
    study = evidence.studies.get(SQUARE)
    cell = study.cell("fto", "none") if study else None
    row = next(iter(cell.rows.values()), None) if cell else None
    visit = visits(row) if row else None
    driven = (visit and visit["driven"]) or {}
    lap_s = visit and visit["longest_lap_s"]
    turns = driven["turns"] / lap_s if driven and lap_s else None
    found = (
        ("mae", "MAE", 1.5769, _METRES, driven.get("mae_m")),
        ("maa", "mean absolute angle", 0.3681, _RADIANS, driven.get("maa")),
        ("andc", "changes of direction per second", 0.4024, _RATE, turns),
    )
    claims = []
    for key, text, published, unit, ours in found:
        finding = Finding.missing(f"experiment {SQUARE}")
        if ours is not None:
            # Nothing is random: one run is all.
            finding = Finding(Verdict.UNDECIDED, Measured.computed(ours, unit, "mission"))
        claims.append(_claim(f"fto.{key}", f"§5.2, fictive obstacles: {text}", published, unit, _RECONSTRUCTION, finding))
    return claims
