//! Declaration of a process: its inputs and outputs. The order of a tick, the checks of a scenario, the capacity
//! of buffers and the picture of the dataflow follow from it.

mod written;

pub use written::{
    DeclarationError, WrittenDeclaration, WrittenOutput, WrittenTopic, input, readable,
    reading_time,
};

use core::fmt;

use ipc_types::bus::AnyTopic;
use ipc_types::topics::{
    Commands, Coverage, MeasuredPoses, ObstacleEvents, RobotEvents, Scan, Service, Topic, TopicId,
    Tree, Waypoints, WorldEvents, WorldMap, WorldShapes, WorldState,
};

/// A stream of messages between processes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flow {
    /// The messages of a topic.
    Topic(TopicId),
    /// The requests to the service with this name.
    Requests(&'static str),
    /// The answers of the service with this name.
    Answers(&'static str),
}

impl Flow {
    /// Returns the flow of a topic, and registers the topic if it is not built in.
    pub fn for_topic<T: Topic>() -> Self {
        AnyTopic::register::<T>();
        Self::Topic(T::id())
    }

    /// Returns `true` if the simulator or the orchestrator alone writes it, in every run.
    pub fn is_of_the_run(self) -> bool {
        matches!(self, Self::Topic(topic) if topic.has_one_publisher())
    }
}

impl fmt::Display for Flow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Topic(topic) => f.write_str(topic.name()),
            Self::Requests(name) => write!(f, "requests of {name}"),
            Self::Answers(name) => write!(f, "answers of {name}"),
        }
    }
}

/// Time at which a message counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// In the tick of its stamp: a reader steps after the writers.
    ThisTick,
    /// In the tick after that of its stamp.
    NextTick,
    /// From its tick until the next message.
    Latched,
    /// On its arrival.
    Event,
}

/// An input of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Input {
    /// Its messages.
    pub flow: Flow,
    /// The time at which they count.
    pub when: When,
    /// `true` if the process cannot do without it.
    pub is_required: bool,
}

impl Input {
    /// A required input.
    pub const fn new(flow: Flow, when: When) -> Self {
        Self {
            flow,
            when,
            is_required: true,
        }
    }

    /// The same input of a process that works without it, too.
    #[must_use]
    pub const fn optional(self) -> Self {
        Self {
            is_required: false,
            ..self
        }
    }

    /// The state of all robots.
    pub const STATE: Self = Self::new(Flow::Topic(TopicId::WorldState), When::ThisTick);
    /// The grids of the map.
    pub const MAP: Self = Self::new(Flow::Topic(TopicId::WorldMap), When::Latched);
    /// The exact pieces of the map.
    pub const SHAPES: Self = Self::new(Flow::Topic(TopicId::WorldShapes), When::Latched);
    /// Range scans of its robots.
    pub const SCANS: Self = Self::new(Flow::Topic(TopicId::Scan), When::ThisTick);
    /// Beliefs about its opponents.
    pub const BELIEFS: Self = Self::new(Flow::Topic(TopicId::Belief), When::ThisTick);
}

/// An output of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Output {
    /// Its messages.
    pub flow: Flow,
    /// The time at which they count.
    pub when: When,
    /// Maximum number of elements of a message; 0 if the process derives it from the run.
    pub elements: usize,
    /// `true` if only one process of a run may write it.
    pub is_sole: bool,
}

impl Output {
    /// An output for viewers, the log and later ticks, with messages of at most `elements`.
    pub fn new<T: Topic>(elements: usize) -> Self {
        Self {
            flow: Flow::for_topic::<T>(),
            when: When::NextTick,
            elements,
            is_sole: false,
        }
    }

    /// The search tree behind a plan, of at most `edges`.
    pub fn tree(edges: usize) -> Self {
        Self::new::<Tree>(edges)
    }

    /// At most `most` waypoints that end in a tick.
    pub fn waypoints(most: usize) -> Self {
        Self::new::<Waypoints>(most)
    }

    /// At most `most` events of a robot in a tick.
    pub fn events(most: usize) -> Self {
        Self::new::<RobotEvents>(most)
    }

    /// The same output, counting at another time.
    #[must_use]
    pub const fn at(self, when: When) -> Self {
        Self { when, ..self }
    }

    /// The same output, of only one process of a run.
    #[must_use]
    pub const fn sole(self) -> Self {
        Self {
            is_sole: true,
            ..self
        }
    }
}

/// Inputs and outputs of a process with given parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Declaration {
    /// Inputs, each flow once.
    pub inputs: Vec<Input>,
    /// Outputs, each flow once.
    pub outputs: Vec<Output>,
    /// `true` if each of its robots needs a goal in the scenario.
    pub needs_goals: bool,
    /// Time limit of a lap (s); `None` without laps.
    pub lap_limit_s: Option<f64>,
}

impl Declaration {
    /// Returns that of the simulator. The size of its messages follows from the world.
    pub fn of_simulator() -> Self {
        let commands = Input::new(Flow::for_topic::<Commands>(), When::NextTick);
        let changes = Input::new(Flow::for_topic::<ObstacleEvents>(), When::Event);
        let poses = Input::new(Flow::for_topic::<MeasuredPoses>(), When::Event);
        Self::default()
            .reads(commands)
            .reads(changes)
            .reads(poses.optional())
            .writes(Output::new::<WorldState>(0).at(When::ThisTick))
            .writes(Output::new::<Scan>(0).at(When::ThisTick))
            .writes(Output::new::<WorldMap>(0).at(When::Latched))
            .writes(Output::new::<WorldShapes>(0).at(When::Latched))
            .writes(Output::new::<WorldEvents>(0))
            .writes(Output::new::<Coverage>(0))
            .writes(Output::new::<ObstacleEvents>(1).at(When::Event))
    }

    /// Adds an input.
    #[must_use]
    pub fn reads(mut self, input: Input) -> Self {
        self.inputs.push(input);
        self
    }

    /// Adds an input if a condition holds.
    #[must_use]
    pub fn reads_if(self, condition: bool, input: Input) -> Self {
        if condition { self.reads(input) } else { self }
    }

    /// Adds the topics with these names to the inputs; unknown ones are refused when they are opened.
    #[must_use]
    pub fn reads_named<'a>(self, names: impl IntoIterator<Item = &'a str>) -> Self {
        let topics = names.into_iter().filter_map(|name| readable(name).ok());
        topics.fold(self, |declared, topic| {
            let input = input(topic, &[]);
            let is_new = declared.input(input.flow).is_none();
            declared.reads_if(is_new, input)
        })
    }

    /// Adds an output.
    #[must_use]
    pub fn writes(mut self, output: Output) -> Self {
        self.outputs.push(output);
        self
    }

    /// Adds requests to a service of at most `elements`, and its answers.
    #[must_use]
    pub fn asks<S: Service>(self, elements: usize) -> Self {
        self.reads(Input::new(Flow::Answers(S::NAME), When::Event))
            .writes(Output {
                flow: Flow::Requests(S::NAME),
                when: When::Event,
                elements,
                is_sole: false,
            })
    }

    /// Adds answers of at most `elements` to the requests to a service; one process of a run gives them.
    #[must_use]
    pub fn answers<S: Service>(self, elements: usize) -> Self {
        let requests = Input::new(Flow::Requests(S::NAME), When::Event);
        self.reads(requests.optional()).writes(Output {
            flow: Flow::Answers(S::NAME),
            when: When::Event,
            elements,
            is_sole: true,
        })
    }

    /// Returns the input of this flow.
    pub fn input(&self, flow: Flow) -> Option<&Input> {
        self.inputs.iter().find(|input| input.flow == flow)
    }

    /// Returns the output of this flow.
    pub fn output(&self, flow: Flow) -> Option<&Output> {
        self.outputs.iter().find(|output| output.flow == flow)
    }

    /// Returns the flows that it cannot do without.
    pub fn required(&self) -> impl Iterator<Item = Flow> {
        let inputs = self.inputs.iter().filter(|input| input.is_required);
        inputs.map(|input| input.flow)
    }

    /// Returns `true` if it commands robots.
    pub fn drives_robots(&self) -> bool {
        self.output(Flow::for_topic::<Commands>()).is_some()
    }

    /// Returns `true` if processes may wait for its outputs within a tick.
    pub fn is_within_tick(&self) -> bool {
        let mut outputs = self.outputs.iter();
        outputs.any(|output| output.when == When::ThisTick)
    }
}

/// Returns what one process writes for another, and when the reader takes it. An external program (`None`) commands robots,
/// and may read all that others write for the tick.
pub fn between(writer: Option<&Declaration>, reader: Option<&Declaration>) -> Vec<(Flow, When)> {
    let commands = [Output::new::<Commands>(1)];
    let outputs = writer.map_or(&commands[..], |known| &known.outputs);
    let taken = |output: &Output| {
        let when = match reader {
            Some(known) => known.input(output.flow).map(|input| input.when),
            None => (output.when != When::NextTick).then_some(output.when),
        };
        Some((output.flow, when?))
    };
    outputs.iter().filter_map(taken).collect()
}

/// Returns, for each process, the indices of those whose output of a tick it waits for. An external program (`None`) has an
/// unknown declaration: it steps after all possible inputs.
pub fn upstream(declarations: &[Option<Declaration>]) -> Vec<Vec<usize>> {
    let waits_for = |reader: &Option<Declaration>, output: &Output| {
        output.when == When::ThisTick
            && reader.as_ref().is_none_or(|reader| {
                let input = reader.input(output.flow);
                input.is_some_and(|input| input.when == When::ThisTick)
            })
    };
    let of_one = |(at, reader): (usize, &Option<Declaration>)| {
        let writers = declarations.iter().enumerate();
        let writers = writers.filter(|(index, _)| *index != at);
        writers
            .filter(|(_, writer)| {
                let mut outputs = writer.iter().flat_map(|writer| &writer.outputs);
                outputs.any(|output| waits_for(reader, output))
            })
            .map(|(index, _)| index)
            .collect()
    };
    declarations.iter().enumerate().map(of_one).collect()
}

/// Returns an order of processes in which each comes after those that it waits for, and those that are late after all that do
/// not wait for them; otherwise the order of the list holds.
///
/// # Errors
/// The indices of the processes that wait for each other in a circle, and of those that wait for them.
pub fn order(
    upstream: &[Vec<usize>],
    is_late: impl Fn(usize) -> bool,
) -> Result<Vec<usize>, Vec<usize>> {
    let mut waiting: Vec<usize> = (0..upstream.len()).collect();
    let mut ordered = Vec::with_capacity(waiting.len());
    while !waiting.is_empty() {
        let is_ready = |&index: &usize| !upstream[index].iter().any(|up| waiting.contains(up));
        let ready = |&index: &usize| is_ready(&index) && !is_late(index);
        let early = waiting.iter().position(ready);
        match early.or_else(|| waiting.iter().position(is_ready)) {
            Some(at) => ordered.push(waiting.remove(at)),
            None => return Err(waiting),
        }
    }
    Ok(ordered)
}

#[cfg(test)]
mod tests {
    use ipc_types::topics::{Belief, OptimiserPlan, Sightings, Verdicts};

    use super::*;

    fn within<T: Topic>() -> Input {
        Input::new(Flow::for_topic::<T>(), When::ThisTick)
    }

    fn sensor() -> Declaration {
        Declaration::default().writes(Output::new::<Sightings>(1).at(When::ThisTick))
    }

    fn tracker() -> Declaration {
        Declaration::default()
            .reads(within::<Sightings>())
            .writes(Output::new::<Belief>(9).at(When::ThisTick).sole())
    }

    fn planner() -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .reads_if(true, Input::BELIEFS)
            .writes(Output::new::<Commands>(1))
    }

    #[test]
    fn a_process_waits_for_the_writers_of_its_inputs_of_the_tick() {
        let all = [
            planner(),
            tracker(),
            sensor(),
            planner().asks::<OptimiserPlan>(3),
        ]
        .map(Some);
        let upstream = upstream(&all);
        assert_eq!(upstream, [vec![1], vec![2], vec![], vec![1]]);
        assert_eq!(order(&upstream, |_| false), Ok(vec![2, 1, 0, 3]));
        // A late process, and those that wait for it, come last.
        let slow = Declaration::default().writes(Output::new::<Verdicts>(1));
        let all = [Some(tracker()), Some(slow), Some(planner())];
        let upstream = super::upstream(&all);
        assert_eq!(order(&upstream, |at| at == 0), Ok(vec![1, 0, 2]));
    }

    #[test]
    fn an_external_program_waits_for_all_and_none_waits_for_it() {
        let all = [None, Some(tracker()), Some(sensor()), None];
        assert_eq!(upstream(&all), [vec![1, 2], vec![2], vec![], vec![1, 2]]);
    }

    #[test]
    fn processes_that_wait_for_each_other_have_no_order() {
        let back = Declaration::default()
            .reads(Input::BELIEFS)
            .writes(Output::new::<Sightings>(1).at(When::ThisTick));
        let all = [Some(sensor()), Some(back), Some(tracker()), Some(planner())];
        assert_eq!(order(&upstream(&all), |_| false), Err(vec![1, 2, 3]));
    }

    #[test]
    fn only_later_inputs_and_outputs_let_all_step_at_once() {
        let later = Input {
            when: When::NextTick,
            ..Input::BELIEFS
        };
        let all = [Declaration::default().reads(later), tracker()].map(Some);
        assert_eq!(upstream(&all), [vec![], Vec::<usize>::new()]);
        let all = [planner(), planner()].map(Some);
        assert_eq!(upstream(&all), [vec![], Vec::<usize>::new()]);
    }

    #[test]
    fn flows_of_the_run_need_no_writer_among_its_processes() {
        let of_the_run = |input: Input| input.flow.is_of_the_run();
        for input in [Input::STATE, Input::MAP, Input::SHAPES, Input::SCANS] {
            assert!(of_the_run(input), "{}", input.flow);
        }
        assert!(!of_the_run(Input::BELIEFS));
        assert!(!Flow::Answers(OptimiserPlan::NAME).is_of_the_run());
        assert_eq!(
            Flow::Answers(OptimiserPlan::NAME).to_string(),
            "answers of optimiser/plan"
        );
    }
}
