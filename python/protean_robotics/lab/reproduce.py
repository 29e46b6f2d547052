"""``protean reproduce``: runs the experiments of the papers and writes every published number and statement beside ours.

The experiments are resumed where they were interrupted. The claims and pages are pure functions of their results: the same
results give the same reports, byte for byte.
"""

import argparse
import json
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

from .._core import MAX_MISSIONS, Interruption, sweep_in_process
from .._errors import Error, InvalidInput
from . import duration, files, plans, results
from .claim import Paper
from .evidence import Evidence
from .experiments import EXPERIMENTS, PLAN_SEED_S, PLAN_SEEDS, QUICK_PLAN_SEEDS, Experiment
from .report import REPORTS, Ran, Report

#: Exit codes of the command: it failed, its input is invalid, its result is not whole.
_FAILED, _INVALID, _PARTIAL = 1, 2, 3
#: Name of the single plans among the experiments, and of their file.
_PLANS = "plans"
#: Maximum seed of a scenario.
_MAX_SEED = 2**63 - 1
#: Help below the options.
_HELP = """\
Runs the experiments of the papers and writes reproduce.md, reproduce.json and reproduce.html: every published number and
statement beside ours, its interval, the number of observations and a verdict by a stated rule. The results of each experiment
are a folder beside them; pages has the pages of docs/results. On two idle cores all seeds take less than an hour, --quick less
than ten minutes; the time that is left stands at the begin of each experiment, from the pace of this machine.

The verdicts so far are in reproduce.md and reproduce.json after each experiment. The command may be interrupted or killed: the
same command resumes it and repeats no finished mission. The same seeds give the same bytes, except where CPU times are compared.

Exit codes: 0 all missions are done, 1 the results cannot be written, 2 wrong usage or a directory with other files, 3
missions failed or are missing.
"""


@dataclass(frozen=True)
class Options:
    """Options of a reproduction.

    Attributes
    ----------
    papers
        The papers.
    quick
        True for a part of the seeds.
    seeds
        Seeds of every experiment in the place of its own.
    jobs
        Missions at once.
    quiet
        True if no progress is shown.
    """

    papers: Sequence[Paper] = tuple(Paper)
    quick: bool = False
    seeds: range | None = None
    jobs: int = 1
    quiet: bool = False

    def of(self, experiment: Experiment) -> range | None:
        """Seeds of an experiment; None for those of its file."""
        return range(1, experiment.quick + 1) if self.quick and self.seeds is None else self.seeds

    @property
    def plan_seeds(self) -> range:
        """Seeds of the single plans."""
        return self.seeds or range(1, (QUICK_PLAN_SEEDS if self.quick else PLAN_SEEDS) + 1)


@dataclass
class Outcome:
    """Result of a reproduction: the results, and the experiments in the order of their execution."""

    evidence: Evidence = field(default_factory=Evidence)
    experiments: list[Ran] = field(default_factory=list)


def run(directory: Path, options: Options) -> Outcome:
    """Executes the experiments of papers; each has its results in a folder of the directory, and its verdicts in the table.

    Raises
    ------
    InvalidInput
        The directory has files of other origin, or an experiment cannot run.
    Error
        Results cannot be stored.
    KeyboardInterrupt
        After Ctrl-C; finished missions are kept.
    """
    _refuse_foreign(directory)
    outcome = Outcome()
    chosen = [experiment for experiment in EXPERIMENTS if experiment.paper in options.papers]
    has_plans = Paper.CHASE in options.papers
    names = [experiment.name for experiment in chosen] + [_PLANS] * has_plans
    made = plans.read(directory / f"{_PLANS}.csv") if has_plans else []
    work = [
        duration.work_s(experiment, options.of(experiment) or duration.seeds_of(experiment), directory / experiment.name)
        for experiment in chosen
    ]
    unplanned = set(options.plan_seeds) - {plan.seed for plan in made}
    estimate = duration.Estimate([*work, *[len(unplanned) * PLAN_SEED_S] * has_plans], options.jobs)

    def begin(turn: int) -> None:
        if turn:
            Report.so_far(outcome.evidence, outcome.experiments, options.papers, names[turn:]).write_table(directory)
        if not options.quiet:
            left = duration.text(estimate.left_s(turn))
            print(f"experiment {turn + 1} of {len(names)}: {names[turn]}; {left} left", file=sys.stderr, flush=True)

    for turn, experiment in enumerate(chosen):
        begin(turn)
        _sweep(directory, experiment, options)
        found = results.read(directory / experiment.name)
        outcome.experiments.append(Ran(found.name, found.seeds, len(found.rows), found.failed))
        outcome.evidence.add(found)
    if has_plans:
        begin(len(chosen))
        made = _plans(directory / f"{_PLANS}.csv", options)
        seeds = results.seeds_text(sorted({plan.seed for plan in made}))
        outcome.experiments.append(Ran(_PLANS, seeds, len(made), 0))
        outcome.evidence.add_plans(made)
    return outcome


def _refuse_foreign(directory: Path) -> None:
    """Refuses a directory that has a file under the name of a report, but no results."""
    if any(results.exist(directory / experiment.name) for experiment in EXPERIMENTS):
        return
    for name in REPORTS:
        file = directory / name
        if file.exists() or file.is_symlink():
            raise InvalidInput(f"{file} exists, but {directory} has no results of a reproduction: expected another directory")


def _sweep(directory: Path, experiment: Experiment, options: Options) -> None:
    """Executes the missions of an experiment that are not finished."""
    seeds = options.of(experiment)
    call = SimpleNamespace(
        seeds=None if seeds is None else f"{seeds[0]}..{seeds[-1]}",
        overrides=[],
        allow_external=False,
        allow_outside=False,
        retry_failed=False,
        keep_logs="none",
        worst=None,
        placed=[],
        interruption=Interruption(),
    )
    sweep_in_process(
        experiment.file,
        directory / experiment.name,
        call,
        shard=None,
        jobs=options.jobs,
        quiet=options.quiet,
        reuse=[directory / experiment.reuse] if experiment.reuse else [],
    )


def _plans(path: Path, options: Options) -> list[plans.Plan]:
    """Makes the single plans that are missing, several seeds at once; each is saved when it is done."""
    made = plans.read(path)
    known = {plan.seed for plan in made}
    with ThreadPoolExecutor(options.jobs) as pool:
        try:
            for found in pool.map(plans.make, (seed for seed in options.plan_seeds if seed not in known)):
                made += found
                files.save(path, plans.table(made))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    if not path.exists():
        files.save(path, plans.table(made))
    return sorted(made, key=lambda plan: plan.seed)


def main(arguments: Sequence[str] | None = None) -> int:
    """Carries out ``protean reproduce``; returns the exit code."""
    args = _parser().parse_args(arguments)
    papers = [paper for paper in Paper if not args.papers or paper.value in args.papers]
    options = Options(papers, args.quick, args.seeds, args.jobs or len(os.sched_getaffinity(0)), args.quiet)
    try:
        outcome = run(args.out, options)
        report = Report.of(outcome.evidence, outcome.experiments, papers)
        report.write(args.out)
    except KeyboardInterrupt:
        print(f"interrupted: the same command continues; {REPORTS[0]} has the experiments that are finished", file=sys.stderr)
        return _PARTIAL
    except InvalidInput as error:
        print(f"error: {error}", file=sys.stderr)
        return _INVALID
    except (Error, ImportError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return _FAILED
    print(report.json() if args.json else _summary(report, args.out), end="")
    return _PARTIAL if any(ran.failed for ran in outcome.experiments) else 0


def _summary(report: Report, out: Path) -> str:
    """Number of claims of every paper by verdict, and the files."""
    text = ""
    for paper in report.papers:
        counts = (f"{count} {verdict.word}" for verdict, count in report.verdicts(paper).items() if count)
        text += f"{paper.value:9} {', '.join(counts)}\n"
    return text + f"{'table':9} {out / REPORTS[0]}\n{'page':9} {out / REPORTS[2]}\n"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "protean reproduce",
        description="Reproduce the published results of four papers, with verdicts.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    seeds = parser.add_mutually_exclusive_group()
    seeds.add_argument("--quick", action="store_true", help="take a part of the seeds: less than ten minutes on two idle cores")
    seeds.add_argument(
        "--seeds", metavar="A..B", type=_seeds, help="seeds A to B, inclusive, of every experiment [default: the experiments']"
    )
    parser.add_argument(
        "--paper",
        dest="papers",
        action="append",
        choices=[paper.value for paper in Paper],
        help="reproduce this paper only (repeatable)",
    )
    parser.add_argument(
        "--out", "-o", metavar="DIR", type=Path, default=Path("results/reproduce"), help="write the results to directory DIR"
    )
    parser.add_argument(
        "--jobs", "-j", metavar="N", type=_jobs, help="run N missions at once [default: number of processors]"
    )
    parser.add_argument("--quiet", "-q", action="store_true", help="print only the result and errors: no progress")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    return parser


def _typed(convert: Callable[[str], int], text: str, expected: str, most: int) -> int:
    try:
        number = convert(text)
    except ValueError:
        number = -1
    if not 0 <= number <= most:
        raise argparse.ArgumentTypeError(f"{text!r}: expected {expected}")
    return number


def _seeds(text: str) -> range:
    """Seeds ``A..B``, both included, or one number."""
    first, dots, last = text.partition("..")
    expected = "A..B with 0 <= A <= B (both included), or one seed"
    low, high = (_typed(int, part, expected, _MAX_SEED) for part in (first, last if dots else first))
    if not low <= high < low + MAX_MISSIONS:
        raise argparse.ArgumentTypeError(f"{text!r}: expected {expected}")
    return range(low, high + 1)


def _jobs(text: str) -> int:
    number = _typed(int, text, "a number from 1 to 4096", 4096)
    return number or _typed(int, "-1", "a number from 1 to 4096", 4096)
