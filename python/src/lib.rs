//! The compiled part of the Python package `protean_robotics`.

// Arguments come from Python as values, and doc comments of what it sees are docstrings.
#![allow(clippy::needless_pass_by_value, clippy::doc_markdown)]

mod environments;
mod lab;
mod log;
mod planner;
mod routes;
mod run;
mod sweep;

use pyo3::prelude::*;

/// Functions and classes that `protean_robotics` hands on.
#[pymodule(gil_used = false)]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::environments::{Environments, Variant};
    #[pymodule_export]
    use crate::log::{Column, LogFile};
    #[pymodule_export]
    use crate::planner::{Belief, Function, PySteering, Robot, Scan, World, go_to, serve};
    #[pymodule_export]
    use crate::routes::{plan_coverage, plan_patrol, predict_patrol};
    #[pymodule_export]
    use crate::run::run_in_process;
    #[pymodule_export]
    use crate::sweep::{Interruption, missions_to_run, sweep_in_process};
    #[pymodule_export]
    use python_algorithms::map::Map;

    #[pymodule]
    mod steering {
        #[pymodule_export]
        use python_algorithms::fields::{attraction, linearise, obstacle_push, repulsion};
        #[pymodule_export]
        use python_algorithms::followers::{PathTracker, TangentBug};
        #[pymodule_export]
        use python_algorithms::steering::go_to;
    }

    #[pymodule]
    mod navigation {
        #[pymodule_export]
        use python_algorithms::navigation::{arrival_times, dominance, shortest_paths};
    }

    #[pymodule]
    mod tracking {
        #[pymodule_export]
        use python_algorithms::tracking::{ParticleFilter, visibility};
    }

    #[pymodule]
    mod patrol {
        #[pymodule_export]
        use python_algorithms::patrol::{ZigZag, detection};
    }

    #[pymodule]
    mod coverage {
        #[pymodule_export]
        use python_algorithms::coverage::Plan;
    }

    #[pymodule]
    mod trajectory {
        #[pymodule_export]
        use python_algorithms::trajectory::{Trajectory, plan, plan_instance};
    }

    #[pymodule]
    mod rrt_star {
        #[pymodule_export]
        use python_algorithms::rrt_star::{Tree, plan};
    }

    #[pymodule]
    mod lab {
        #[pymodule_export]
        use crate::lab::{
            chebyshev_difference, chebyshev_exponents, chebyshev_key, patrol_laps, ros_map,
            scenario_problems, single_plans,
        };
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        python_algorithms::interpreter::register(module)?;
        module.add("MAX_MISSIONS", sweep::spec::MAX_MISSIONS)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
