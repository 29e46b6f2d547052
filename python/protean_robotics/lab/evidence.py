"""Results of all experiments, and the claims and pages that follow from them."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from .._errors import InvalidInput
from .chase import claims as chase_claims
from .chase import evidence as chase_evidence
from .chase import page as chase_page
from .claim import Claim, Paper
from .page import Page
from .patrol import claims as patrol_claims
from .patrol import coverage_claims
from .patrol import evidence as patrol_evidence
from .patrol import page as patrol_page
from .patrol_teams import claims as patrol_teams_claims
from .patrol_teams import evidence as patrol_teams_evidence
from .patrol_teams import page as patrol_teams_page
from .plans import Plan
from .results import Results
from .vmc_lp import claims as vmc_lp_claims
from .vmc_lp import evidence as vmc_lp_evidence
from .vmc_lp import page as vmc_lp_page


@dataclass
class Evidence:
    """Results of all experiments, by paper; missing ones are noted."""

    chase: chase_evidence.Evidence = field(default_factory=chase_evidence.Evidence)
    patrol: patrol_evidence.Evidence = field(default_factory=patrol_evidence.Evidence)
    teams: patrol_teams_evidence.Evidence = field(default_factory=patrol_teams_evidence.Evidence)
    vmc_lp: vmc_lp_evidence.Evidence = field(default_factory=vmc_lp_evidence.Evidence)

    def add(self, results: Results) -> None:
        """Adds the results of an experiment.

        Raises
        ------
        InvalidInput
            It is none of the papers' experiments.
        """
        names: list[str] = []
        for part, module in (
            (self.chase, chase_evidence),
            (self.patrol, patrol_evidence),
            (self.vmc_lp, vmc_lp_evidence),
            (self.teams, patrol_teams_evidence),
        ):
            if results.name in module.EXPERIMENTS:
                part.studies[results.name] = module.Study.of(results)
                return
            names += module.EXPERIMENTS
        raise InvalidInput(
            f"{results.directory} contains the results of the experiment `{results.name}`: expected one of {', '.join(names)}"
        )

    def add_plans(self, plans: list[Plan]) -> None:
        """Adds single plans of the RRT* evaders."""
        self.chase.plans = plans

    def claims(self, papers: Sequence[Paper]) -> list[Claim]:
        """Claims of papers."""
        found: list[Claim] = []
        for paper in papers:
            match paper:
                case Paper.CHASE:
                    found += chase_claims.claims(self.chase)
                case Paper.PATROL:
                    found += patrol_claims.claims(self.patrol)
                case Paper.COVERAGE:
                    found += coverage_claims.claims(self.patrol)
                case Paper.VMC_LP:
                    found += vmc_lp_claims.claims(self.vmc_lp)
                case Paper.TEAMS:
                    found += patrol_teams_claims.claims(self.teams)
        return found

    def pages(self, papers: Collection[Paper]) -> dict[str, Page]:
        """Pages of documentation about papers, by the names of their files."""
        pages = {}
        if Paper.CHASE in papers:
            pages["chase.md"] = chase_page.build(self.chase)
        if Paper.PATROL in papers or Paper.COVERAGE in papers:
            pages["patrol.md"] = patrol_page.build(self.patrol)
        if Paper.VMC_LP in papers:
            pages["vmc-lp.md"] = vmc_lp_page.build(self.vmc_lp)
        if Paper.TEAMS in papers:
            pages["patrol-teams.md"] = patrol_teams_page.build(self.teams)
        return pages
