"""The experiments of the papers: the files of `experiments/`, as parts of the package.

They are linked one by one: wheels follow no linked folder.
"""

from dataclasses import dataclass
from pathlib import Path

from .claim import Paper

#: Number of seeds of the single plans of the RRT* evaders: all, and those of a quick reproduction.
PLAN_SEEDS, QUICK_PLAN_SEEDS = 100, 20


@dataclass(frozen=True)
class Experiment:
    """An experiment.

    Attributes
    ----------
    name
        Its name, and the folder of its results.
    paper
        The paper.
    quick
        Number of seeds that a quick reproduction takes, from 1 on; all of them together need less than ten minutes of two
        cores.
    reuse
        Experiment with some of the same missions.
    """

    name: str
    paper: Paper
    quick: int
    reuse: str | None = None

    @property
    def file(self) -> Path:
        """Its file."""
        return Path(__file__).with_name("experiment_files") / f"{self.name}.toml"


#: All experiments, in the order of their execution.
EXPERIMENTS = (
    Experiment("escape_vs_speed", Paper.CHASE, 40),
    Experiment("escape_vs_speed_rrt_star", Paper.CHASE, 10),
    Experiment("escape_vs_speed_paper", Paper.CHASE, 50),
    Experiment("knowledge", Paper.CHASE, 40, "escape_vs_speed"),
    Experiment("knowledge_paper", Paper.CHASE, 50, "escape_vs_speed_paper"),
    Experiment("patrol_alpha", Paper.PATROL, 5),
    Experiment("patrol_square", Paper.PATROL, 3),
    Experiment("coverage_sources", Paper.COVERAGE, 3),
    Experiment("patrol_team", Paper.TEAMS, 1),
    Experiment("patrol_failure", Paper.TEAMS, 1),
    Experiment("vmc_lp_sensitivity", Paper.VMC_LP, 100),
    Experiment("vmc_lp_tables_3_4", Paper.VMC_LP, 100),
)
