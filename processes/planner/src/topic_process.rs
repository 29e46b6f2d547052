//! Process of a program that reads and writes topics by their names: a function in Python, a library in C.

use core::fmt;

use ipc_types::bus::{Bus, PublisherOptions, RawPublisher};
use ipc_types::topics::TopicId;
use parameters::Parameters;
use planner_view::view::{RobotView, View};
use robot::team::Team;
use runtime::config::ProcessConfig;
use runtime::declaration::{
    Declaration, DeclarationError, Input, WrittenDeclaration, input, readable,
};
use runtime::error::ProcessError;
use runtime::inputs::{StateInput, reply_stamp};
use runtime::kind::{Process, ProcessKind};
use runtime::raw_inputs::RawInputs;

use crate::views::{robot_views, teams};

/// Program of a [`TopicProcess`].
pub trait TopicProgram: Sized + 'static {
    /// Name of its kind.
    const NAME: &'static str;

    /// One-line description.
    const SUMMARY: &'static str;

    /// Parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + fmt::Debug + Send + Sync;

    /// Returns the topics that it reads and writes.
    fn declared(params: &Self::Params) -> WrittenDeclaration;

    /// Returns the program at its start.
    ///
    /// # Errors
    /// Ends the process before it is ready.
    fn open(config: &ProcessConfig, params: &Self::Params) -> Result<Self, ProcessError>;

    /// Takes the messages of a tick, and fills the outputs that have one. The view has no own robot.
    ///
    /// # Errors
    /// Ends the process.
    fn step(
        &mut self,
        view: &View<'_>,
        inputs: &RawInputs,
        outputs: &mut [RawOutput],
    ) -> Result<(), ProcessError>;
}

/// A topic that a program writes.
#[derive(Debug)]
pub struct RawOutput {
    topic: TopicId,
    port: RawPublisher,
    /// Maximum number of elements of a message.
    capacity: usize,
    /// Bytes of the elements of the tick.
    elements: Option<Vec<u8>>,
}

impl RawOutput {
    /// Returns the topic.
    pub fn topic(&self) -> TopicId {
        self.topic
    }

    /// Returns the maximum number of elements of a message.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// Sets the bytes of the elements of the tick; returns `false` if it has some already.
    pub fn fill(&mut self, elements: Vec<u8>) -> bool {
        self.elements.replace(elements).is_none()
    }
}

/// Runs a program that reads and writes topics by their names.
#[derive(Debug)]
pub struct TopicProcess<P> {
    config: ProcessConfig,
    program: P,
    state: StateInput,
    inputs: RawInputs,
    outputs: Vec<RawOutput>,
    teams: Vec<Team>,
    views: Vec<RobotView>,
}

impl<P: TopicProgram> ProcessKind for TopicProcess<P> {
    const NAME: &'static str = P::NAME;
    const SUMMARY: &'static str = P::SUMMARY;

    type Params = P::Params;

    fn declare(params: &P::Params) -> Declaration {
        // Unknown topics are refused when they are opened.
        P::declared(params).declaration().unwrap_or_default()
    }

    fn open(config: &ProcessConfig, params: &P::Params, bus: &Bus) -> Result<Self, ProcessError> {
        let declared = P::declared(params);
        let outputs = declared.writes.iter().map(|output| {
            let topic = output.topic.register().map_err(DeclarationError::from)?;
            let options = PublisherOptions::new(config.index, output.elements);
            Ok(RawOutput {
                topic,
                port: RawPublisher::open(bus, topic, options)?,
                capacity: output.elements,
                elements: None,
            })
        });
        let outputs = outputs.collect::<Result<_, ProcessError>>()?;
        let inputs = RawInputs::open(&declared.reads, config, bus)?;
        Ok(Self {
            program: P::open(config, params)?,
            state: StateInput::open(bus, config.run.robots.len())?,
            inputs,
            outputs,
            teams: teams(&config.run.robots),
            views: Vec::new(),
            config: config.clone(),
        })
    }
}

impl<P: TopicProgram> Process for TopicProcess<P> {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.inputs.connect()?;
        for output in &self.outputs {
            output.port.update_connections()?;
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let run = &self.config.run;
        self.state.take_turn(tick, run.clock)?;
        self.inputs.receive(tick)?;
        let received_ns = self.state.received_ns;
        robot_views(&self.state, &run.robots, &self.teams, &mut self.views);
        let view = View {
            time_s: self.state.header.stamp.time_ns as f64 * 1e-9,
            dt: run.tick_period(),
            me: 0,
            robots: &self.views,
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        self.program.step(&view, &self.inputs, &mut self.outputs)?;
        let stamp = reply_stamp(&self.state.header, received_ns);
        for output in &mut self.outputs {
            if let Some(elements) = output.elements.take() {
                output.port.send(stamp, &elements)?;
            }
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected
    }
}

/// Returns the declaration of a planner that reads topics by these names beside its own inputs.
pub fn planner_reads(names: &[String]) -> Declaration {
    const OWN: [Input; 5] = [
        Input::STATE,
        Input::MAP,
        Input::BELIEFS,
        Input::SCANS,
        Input::SHAPES,
    ];
    // Unknown topics are refused when they are opened.
    let topics = names.iter().filter_map(|name| readable(name).ok());
    topics.fold(Declaration::default(), |declared, topic| {
        let input = input(topic, &[]);
        let is_own = OWN.iter().any(|own| own.flow == input.flow);
        declared.reads_if(!is_own, input)
    })
}
