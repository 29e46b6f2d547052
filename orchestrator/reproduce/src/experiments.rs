//! The experiments of the papers: the files of `experiments/`, as parts of the program.

use sweep::Kind;

use crate::claim::Paper;

/// An experiment.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// Name, and folder of its results.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
    /// Kind of its missions.
    pub kind: Kind,
    /// The paper.
    pub paper: Paper,
    /// Number of seeds that a quick reproduction takes, from 1 on; all of them together need less than ten minutes
    /// of two cores.
    pub quick: u64,
    /// Experiment with some of the same missions.
    pub reuse: Option<&'static str>,
}

/// Number of seeds of the single plans of the RRT* evaders: all, and those of a quick reproduction.
pub const PLAN_SEEDS: [u64; 2] = [100, 20];

/// Returns the file of an experiment.
macro_rules! file {
    ($name:literal) => {
        include_str!(concat!("../../../experiments/", $name, ".toml"))
    };
}

/// All experiments, in the order of their execution.
pub const EXPERIMENTS: [Experiment; 10] = [
    Experiment {
        name: "escape_vs_speed",
        text: file!("escape_vs_speed"),
        kind: Kind::Missions,
        paper: Paper::Chase,
        quick: 40,
        reuse: None,
    },
    Experiment {
        name: "escape_vs_speed_rrt_star",
        text: file!("escape_vs_speed_rrt_star"),
        kind: Kind::Missions,
        paper: Paper::Chase,
        quick: 10,
        reuse: None,
    },
    Experiment {
        name: "escape_vs_speed_paper",
        text: file!("escape_vs_speed_paper"),
        kind: Kind::Missions,
        paper: Paper::Chase,
        quick: 50,
        reuse: None,
    },
    Experiment {
        name: "knowledge",
        text: file!("knowledge"),
        kind: Kind::Missions,
        paper: Paper::Chase,
        quick: 40,
        reuse: Some("escape_vs_speed"),
    },
    Experiment {
        name: "knowledge_paper",
        text: file!("knowledge_paper"),
        kind: Kind::Missions,
        paper: Paper::Chase,
        quick: 50,
        reuse: Some("escape_vs_speed_paper"),
    },
    Experiment {
        name: "patrol_alpha",
        text: file!("patrol_alpha"),
        kind: Kind::Missions,
        paper: Paper::Patrol,
        quick: 5,
        reuse: None,
    },
    Experiment {
        name: "patrol_square",
        text: file!("patrol_square"),
        kind: Kind::Missions,
        paper: Paper::Patrol,
        quick: 3,
        reuse: None,
    },
    Experiment {
        name: "coverage_sources",
        text: file!("coverage_sources"),
        kind: Kind::Missions,
        paper: Paper::Coverage,
        quick: 3,
        reuse: None,
    },
    Experiment {
        name: "vmc_lp_sensitivity",
        text: file!("vmc_lp_sensitivity"),
        kind: Kind::Planning,
        paper: Paper::VmcLp,
        quick: 100,
        reuse: None,
    },
    Experiment {
        name: "vmc_lp_tables_3_4",
        text: file!("vmc_lp_tables_3_4"),
        kind: Kind::Planning,
        paper: Paper::VmcLp,
        quick: 100,
        reuse: None,
    },
];

#[cfg(test)]
mod tests {
    use sweep::planning::PlanExperiment;
    use sweep::{Experiment as Missions, LoadOptions};

    use super::*;

    #[test]
    fn every_experiment_is_valid_and_a_quick_reproduction_takes_some_of_its_seeds() {
        let options = LoadOptions::new(kinds::KINDS);
        for experiment in EXPERIMENTS {
            let (name, text) = (experiment.name, experiment.text);
            let (read, seeds) = match experiment.kind {
                Kind::Missions => {
                    let read = Missions::from_text(name, text, &options).unwrap();
                    (read.name, read.seeds)
                }
                Kind::Planning => {
                    let read = PlanExperiment::from_text(name, text, &options).unwrap();
                    (read.name, read.seeds)
                }
            };
            assert_eq!(read, name);
            assert_eq!(seeds.iter().next(), Some(1), "{name}");
            assert!(seeds.len() as u64 >= experiment.quick, "{name}");
        }
    }
}
