//! The process: it steps ticks, which need no work, while the service runs beside it.

use ipc_types::bus::{Attendant, Bus};
use ipc_types::messages::optimiser::PlanResponse;
use ipc_types::topics::OptimiserPlan;
use runtime::declaration::Declaration;
use runtime::{Process, ProcessConfig, ProcessError, ProcessKind};

use crate::params::OptimiserParams;
use crate::service::{self, Dispatcher, DispatcherInput, Memory};
use crate::wire::{Refusal, decode_request, encode_answer};

/// Serves `optimiser/plan`.
#[derive(Debug)]
pub struct OptimiserProcess {
    service: Service,
}

#[derive(Debug)]
enum Service {
    /// Beside the process's own thread.
    Threads(Dispatcher),
    /// Answers within the request call, in a run in one thread.
    Call {
        _attendant: Attendant<OptimiserPlan>,
    },
}

impl ProcessKind for OptimiserProcess {
    const NAME: &'static str = "optimiser";
    const SUMMARY: &'static str = "plans minimum-time trajectories for other processes";

    type Params = OptimiserParams;

    fn declare(_: &OptimiserParams) -> Declaration {
        Declaration::default().answers::<OptimiserPlan>(PlanResponse::MAX_SAMPLES)
    }

    fn open(
        config: &ProcessConfig,
        params: &OptimiserParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let service = match bus.space() {
            Some(space) => Service::Threads(Dispatcher::start(DispatcherInput {
                space: space.clone(),
                options: *bus.options(),
                name: config.name.clone(),
                source: config.index,
                workers: params.workers,
            })?),
            None => Service::Call {
                _attendant: attend(bus)?,
            },
        };
        Ok(Self { service })
    }
}

impl Process for OptimiserProcess {
    fn connect(&mut self) -> Result<(), ProcessError> {
        // Both sides of a service connect when they send and receive.
        Ok(())
    }

    fn step(&mut self, _tick: u64) -> Result<(), ProcessError> {
        match &mut self.service {
            Service::Threads(dispatcher) => dispatcher.check(),
            Service::Call { .. } => Ok(()),
        }
    }

    fn rejected(&self) -> u64 {
        match &self.service {
            Service::Threads(dispatcher) => dispatcher.refused(),
            Service::Call { .. } => 0,
        }
    }
}

/// Answers in the client's thread, without a clock: planning takes no time there.
fn attend(bus: &Bus) -> Result<Attendant<OptimiserPlan>, ProcessError> {
    let mut memory = Memory::default();
    let attendant = bus.attend::<OptimiserPlan>(move |header, points| {
        let last = memory.followed(header);
        let result = decode_request(header, points)
            .map_err(Refusal::from)
            .and_then(|(problem, options)| {
                service::solve(&problem, &options, last.as_deref(), &mut || false)
            });
        let answer = encode_answer(header, &result, 0);
        if let Ok(plan) = result {
            memory.keep(header, plan);
        }
        answer
    })?;
    Ok(attendant)
}
