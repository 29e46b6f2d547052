"""The experiments of the papers: the files of `experiments/`, as parts of the package.

They are linked one by one: wheels follow no linked folder.
"""

from dataclasses import dataclass
from pathlib import Path

from .claim import Paper

#: Number of seeds of the single plans of the RRT* evaders: all, and those of a quick reproduction.
PLAN_SEEDS, QUICK_PLAN_SEEDS = 100, 20
#: CPU time of the plans of a seed (s), measured as `Experiment.seed_s`.
PLAN_SEED_S = 0.5


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
        Number of seeds that a quick reproduction takes, from 1 on.
    seed_s
        CPU time of one seed of all its cells (s), without those of `reuse`; measured on a core of a busy AMD EPYC.
    reuse
        Experiment with some of the same missions.
    """

    name: str
    paper: Paper
    quick: int
    seed_s: float
    reuse: str | None = None

    @property
    def file(self) -> Path:
        """Its file."""
        return Path(__file__).with_name("experiment_files") / f"{self.name}.toml"


#: All experiments, in the order of their execution.
EXPERIMENTS = (
    Experiment("escape_vs_speed", Paper.CHASE, 40, 8.4),
    Experiment("escape_vs_speed_rrt_star", Paper.CHASE, 10, 57.0),
    Experiment("escape_vs_speed_paper", Paper.CHASE, 50, 2.4),
    Experiment("knowledge", Paper.CHASE, 40, 1.2, "escape_vs_speed"),
    Experiment("knowledge_paper", Paper.CHASE, 50, 0.8, "escape_vs_speed_paper"),
    Experiment("patrol_alpha", Paper.PATROL, 5, 3.5),
    Experiment("patrol_square", Paper.PATROL, 3, 11.0),
    Experiment("coverage_sources", Paper.COVERAGE, 3, 52.0),
    Experiment("patrol_team", Paper.TEAMS, 1, 120.0),
    Experiment("patrol_failure", Paper.TEAMS, 1, 20.0),
    Experiment("patrol_strategies", Paper.TEAMS, 2, 15.0),
    Experiment("patrol_predictability", Paper.TEAMS, 1, 60.0),
    Experiment("patrol_attacks", Paper.TEAMS, 1, 32.0),
    Experiment("vmc_lp_sensitivity", Paper.VMC_LP, 100, 0.32),
    Experiment("vmc_lp_tables_3_4", Paper.VMC_LP, 100, 0.07),
)
