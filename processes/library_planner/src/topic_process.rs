//! A process in a library: it reads and writes topics of its own.

use planner::{RawOutput, TopicProgram, View, planner_seed};
use runtime::config::ProcessConfig;
use runtime::declaration::WrittenDeclaration;
use runtime::error::ProcessError;
use runtime::raw_inputs::RawInputs;

use crate::abi::Point;
use crate::library::Library;
use crate::params::LibraryParams;
use crate::process::{LibraryInstance, Rules};
use crate::records::Records;

/// The process that a library has created.
#[derive(Debug)]
pub struct LibraryProgram {
    driven: LibraryInstance,
    exits: Vec<Point>,
}

impl TopicProgram for LibraryProgram {
    const NAME: &'static str = "library";
    const SUMMARY: &'static str = "reads and writes topics by a library in C or C++";

    type Params = LibraryParams;

    fn declared(params: &LibraryParams) -> WrittenDeclaration {
        let declared = params.library.map(Library::declaration);
        // The library was checked.
        declared.and_then(Result::ok).unwrap_or_default()
    }

    fn open(config: &ProcessConfig, params: &LibraryParams) -> Result<Self, ProcessError> {
        let seed = planner_seed(config.run.seed, Self::NAME, &config.name);
        let exits: Vec<Point> = (config.run.exits.iter())
            .map(|exit| exit.center().into())
            .collect();
        let rules = Rules {
            exits: &exits,
            capture_radius: config.run.capture_radius,
        };
        let driven = LibraryInstance::open(config, params, None, &rules, seed)?;
        Ok(Self { driven, exits })
    }

    fn step(
        &mut self,
        view: &View<'_>,
        inputs: &RawInputs,
        outputs: &mut [RawOutput],
    ) -> Result<(), ProcessError> {
        let records = Records::new(inputs);
        let stepped = self.driven.call(
            view,
            &self.exits,
            None,
            &records,
            outputs,
            |driven, tick| {
                driven.library.step(driven.planner, tick);
            },
        );
        stepped.map_err(|error| {
            let text = format!("at {} s the process fails: {error}", view.time_s);
            ProcessError::Algorithm(text)
        })
    }
}
