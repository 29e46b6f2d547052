"""The numbers and words of the report, as claims."""

from ..claim import POINTS, Claim, Finding, Measured, Paper, Published
from ..words import p_value
from .evidence import RUNS, SENSITIVITY, VERSUS, Evidence, Study, share
from .sensitivity import CASES, Change, Count, changed, counted, published
from .versus import PAIRS, Observation, Pair, observations

_COUNTS = (
    "Refuted if Fisher's exact test of ours against the published count, by Holm's method, has p < 0.05; confirmed if not,"
    " and our 95 % interval (Wilson) lies within ±2 points of the published share."
)
_CHANGES = (
    "Change of the share of failed plans on the same seeds, with its 95 % interval. It matters if McNemar's exact test, by"
    " Holm's method, has p < 0.05, and hardly matters if the interval lies within ±2 points."
)
_OBSERVATIONS = (
    "Confirmed if the 95 % interval (Wilson) of our share lies above one half, refuted if below or if less than 5 % of the"
    " pairs differ."
)
_NOTABLE = "Refuted if Fisher's exact test of our share against the published one has p < 0.05."


def claims(evidence: Evidence) -> list[Claim]:
    """All claims."""
    study = evidence.studies.get(SENSITIVITY, Study())
    found = [_of_count(case, count) for case in CASES if case.startswith("vmc") for count in counted(study, case)]
    found += [_of_change(case, change) for case in CASES for change in changed(study, case)]
    if not any(claim.ours.n for claim in found):
        found = [_missing("table2", "Table 2: sensitivity to the parameters", SENSITIVITY)]
    versus = evidence.studies.get(VERSUS)
    if versus is None:
        return [*found, _missing("tables34", "Tables 3 and 4: LP against VMC", VERSUS)]
    return found + [_of_observation(pair, seen) for pair in PAIRS for seen in observations(versus, pair)]


def _missing(key: str, text: str, experiment: str) -> Claim:
    return Claim(Paper.VMC_LP, key, text, Published("–"), _COUNTS, Finding.missing(f"experiment {experiment}"))


def _of_count(case: str, count: Count) -> Claim:
    settings = ", ".join(f"{row.parameter} {setting.title}" for row, setting in count.group)
    failed, of = published(count.group)
    finding = Finding.missing(f"settings {settings}")
    if count.ours is not None:
        finding = Finding(count.verdict, Measured.share(*count.ours, "plans"), [p_value(count.p)])
    # Settings that are one set of runs here, with different published counts.
    pooled = ", together" if of > RUNS else ""
    text = f"Table 2: failed plans, {CASES[case]}; {settings}"
    theirs = Published(f"{failed}/{of}{pooled}", share((failed, of)))
    return Claim(Paper.VMC_LP, f"table2.{case}.{count.group[0][1].name}", text, theirs, _COUNTS, finding)


def _of_change(case: str, change: Change) -> Claim:
    verdict, text = change.verdict
    row, interval = change.row, change.ours.interval()
    ours = Measured.number(change.ours.value, interval, POINTS, change.seeds, "seeds")
    finding = Finding(verdict, ours, [f"{text.replace('**', '')}, {p_value(change.p)}"])
    theirs = Published(f"{row.word}, {POINTS.value(row.change)}", row.change)
    key = f"table2.{case}.{row.parameter.replace(' ', '_')}.change"
    claim = f"Table 2: sensitivity to {row.parameter}, {CASES[case]}"
    return Claim(Paper.VMC_LP, key, claim, theirs, _CHANGES, finding)


def _of_observation(pair: Pair, seen: Observation) -> Claim:
    hits, of = seen.published
    finding = Finding(seen.verdict, Measured.share(*seen.ours, "pairs of plans"))
    rule = _NOTABLE if seen.key == "notable" else _OBSERVATIONS
    text = f"Tables 3 and 4: {seen.claim}. {pair.title}"
    theirs = Published(f"{hits}/{of}", share(seen.published))
    return Claim(Paper.VMC_LP, f"tables34.{pair.slot}.{seen.key}", text, theirs, rule, finding, seen.timed)
