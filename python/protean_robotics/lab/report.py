"""All claims with their verdicts, as Markdown, as data and as a page with the figures."""

import base64
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .._core import __version__
from . import files
from .claim import Claim, Paper, Verdict
from .evidence import Evidence
from .page import Page, environment
from .words import in_table

#: Names of the reports and of the folder of pages, beside the results.
REPORTS = ("reproduce.md", "reproduce.json", "reproduce.html", "pages")
#: Mark of claims about times of this machine.
_TIMED = " †"


@dataclass(frozen=True)
class Ran:
    """An executed experiment: name, seeds as text, number of missions, failed ones included, and of failed missions."""

    name: str
    seeds: str
    missions: int
    failed: int


@dataclass(frozen=True)
class Report:
    """The report on a reproduction of papers: a pure function of results.

    Attributes
    ----------
    papers
        The papers.
    experiments
        The executed experiments.
    claims
        All claims.
    pages
        Pages of documentation, by the names of their files.
    program
        Version of the program.
    missing
        Names of the experiments that are not finished.
    """

    papers: Sequence[Paper]
    experiments: Sequence[Ran]
    claims: Sequence[Claim]
    pages: dict[str, Page]
    program: str = __version__
    missing: Sequence[str] = ()

    @staticmethod
    def of(evidence: Evidence, experiments: Sequence[Ran], papers: Sequence[Paper]) -> "Report":
        """Report on results."""
        return Report(papers, experiments, evidence.claims(papers), evidence.pages(papers))

    @staticmethod
    def so_far(evidence: Evidence, experiments: Sequence[Ran], papers: Sequence[Paper], missing: Sequence[str]) -> "Report":
        """Report without pages while these experiments are missing."""
        return Report(papers, experiments, evidence.claims(papers), {}, missing=missing)

    def verdicts(self, paper: Paper) -> dict[Verdict, int]:
        """Number of claims of a paper by verdict."""
        of = [claim.verdict for claim in self.claims if claim.paper == paper]
        return {verdict: of.count(verdict) for verdict in Verdict}

    def data(self) -> dict[str, Any]:
        """The report as data."""
        return {
            "program": self.program,
            "papers": [
                {"paper": paper.value, "title": paper.full_title, "verdicts": _plain(self.verdicts(paper))}
                for paper in self.papers
            ],
            "experiments": [asdict(ran) for ran in self.experiments],
            "missing": list(self.missing),
            "claims": [claim.data() for claim in self.claims],
        }

    def json(self) -> str:
        """The data as JSON."""
        return json.dumps(self.data(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"

    def markdown(self) -> str:
        """One table of all claims, and their rules."""
        text = (
            "# Published results, reproduced\n\n"
            f"Every published number and statement of the papers beside ours, by Protean {self.program}. The same seeds give"
            f" the same table, byte for byte, except for rows with{_TIMED}, which compare CPU times.\n\n"
        )
        if self.missing:
            text += f"**Not finished**: {', '.join(f'`{name}`' for name in self.missing)}.\n\n"
        text += (
            f"| paper | | {' | '.join(verdict.word for verdict in Verdict)} |\n|---|---|---|---|---|---|\n"
        )
        for paper in self.papers:
            counts = " | ".join(map(str, self.verdicts(paper).values()))
            text += f"| {paper} | {paper.full_title} | {counts} |\n"
        text += "\n| paper | claim | published | ours | 95 % | n | verdict |\n|---|---|---|---|---|---|---|\n"
        text += "".join(map(_row, self.claims))
        text += "\n## Rules\n\n"
        rules: dict[str, str] = {}
        for claim in self.claims:
            rules.setdefault(claim.rule, claim.id)
        text += "".join(f"- From `{id}` on: {rule}\n" for rule, id in rules.items())
        text += "\n## Experiments\n\n| experiment | seeds | missions | failed |\n|---|---|---|---|\n"
        text += "".join(f"| `{ran.name}` | {ran.seeds} | {ran.missions} | {ran.failed} |\n" for ran in self.experiments)
        return text

    def html(self) -> str:
        """A page for a browser: the table, and the figures inside the file."""
        # Each is an image of its own, so that names inside the drawings do not collide.
        drawings = [drawing for page in self.pages.values() for drawing in page.drawings.items()]
        pictures = [(name, base64.b64encode(svg).decode()) for name, svg in drawings]
        template = environment(autoescape=True).get_template("reproduce.html")
        text: str = template.render(report=self, figures=pictures)
        return text

    def write(self, directory: Path) -> list[Path]:
        """Writes the reports and the pages to a directory; returns the files, the table first."""
        markdown, data, html, pages = (directory / name for name in REPORTS)
        self.write_table(directory)
        files.save(html, self.html().encode())
        return [markdown, data, html, *(path for name, page in self.pages.items() for path in page.write(pages / name))]

    def write_table(self, directory: Path) -> None:
        """Writes the table and the data to a directory."""
        markdown, data, _, _ = (directory / name for name in REPORTS)
        files.save(markdown, self.markdown().encode())
        files.save(data, self.json().encode())


def _plain(counts: dict[Verdict, int]) -> dict[str, int]:
    return {verdict.value: count for verdict, count in counts.items()}


def _row(claim: Claim) -> str:
    ours = claim.ours
    columns = (
        claim.paper.value,
        in_table(claim.text) + (_TIMED if claim.timed else ""),
        in_table(claim.published.text),
        in_table(ours.text),
        ours.interval_text,
        f"{ours.n} {ours.of}",
        claim.verdict.markdown,
    )
    return f"| {' | '.join(columns)} |\n"
