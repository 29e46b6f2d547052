//! Messages of any topic as structured arrays.

use ipc_types::bus::{AnySubscriber, AnyTopic, Bus};
use ipc_types::message::{Descriptor, FieldKind};
use ipc_types::topics::TopicId;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};
use runtime::config::{Clock, ProcessConfig};
use runtime::declaration::{When, readable, reading_time};
use runtime::error::ProcessError;

/// Messages taken from a topic at once.
const BATCH: usize = 1024;

/// The topics that a process reads, with the messages of the current tick.
#[derive(Debug, Default)]
pub(super) struct Messages {
    topics: Vec<TopicInput>,
}

struct TopicInput {
    topic: TopicId,
    port: Box<dyn AnySubscriber>,
    when: When,
    is_lock_step: bool,
    /// Messages of later ticks.
    waiting: Vec<Held>,
    /// Messages of the current tick.
    current: Vec<Held>,
}

/// A message, copied.
#[derive(Debug)]
struct Held {
    tick: u64,
    source: u32,
    header: Vec<u8>,
    elements: Vec<u8>,
}

impl core::fmt::Debug for TopicInput {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("TopicInput").field(&self.topic).finish()
    }
}

impl Messages {
    /// Opens the topics with these names.
    pub(super) fn open(
        names: &[String],
        config: &ProcessConfig,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let open = |name: &String| {
            let topic = readable(name).map_err(ProcessError::Algorithm)?;
            let unknown = || ProcessError::Algorithm(format!("topic {name} is not registered"));
            Ok(TopicInput {
                topic,
                port: AnyTopic::find(topic).ok_or_else(unknown)?.subscriber(bus)?,
                when: reading_time(topic, &config.run.topics),
                is_lock_step: config.run.clock == Clock::LockStep,
                waiting: Vec::new(),
                current: Vec::new(),
            })
        };
        let topics = names
            .iter()
            .map(open)
            .collect::<Result<_, ProcessError>>()?;
        Ok(Self { topics })
    }

    /// Connects all topics.
    pub(super) fn connect(&self) -> Result<(), ProcessError> {
        for input in &self.topics {
            input.port.update_connections()?;
        }
        Ok(())
    }

    /// Receives the messages of a tick.
    pub(super) fn receive(&mut self, tick: u64) -> Result<(), ProcessError> {
        for input in &mut self.topics {
            let waiting = &mut input.waiting;
            while !input.port.drain(BATCH, &mut |message| {
                waiting.push(Held {
                    tick: message.stamp.tick,
                    source: message.stamp.source,
                    header: message.header.to_vec(),
                    elements: message.elements.to_vec(),
                });
            })? {}
            let (when, is_lock_step) = (input.when, input.is_lock_step);
            let counts = |held: &mut Held| {
                !is_lock_step || held.tick < tick || (held.tick == tick && when != When::NextTick)
            };
            let mut counted: Vec<Held> = input.waiting.extract_if(.., counts).collect();
            // Of several senders, whatever arrived first.
            counted.sort_by_key(|held| (held.tick, held.source));
            if when != When::Latched {
                input.current = counted;
            } else if let Some(newest) = counted.pop() {
                input.current = vec![newest];
            }
        }
        Ok(())
    }

    /// Returns the messages of the tick: a list of (header, elements) for each topic.
    pub(super) fn take(&self, py: Python<'_>) -> PyResult<Py<PyDict>> {
        let all = PyDict::new(py);
        let message = py.import("protean_robotics._process")?.getattr("Message")?;
        for input in &self.topics {
            let facts = input.topic.facts();
            let (header_type, element_type) =
                (dtype(py, &facts.header)?, dtype(py, &facts.element)?);
            let messages = PyList::empty(py);
            for held in &input.current {
                let header = view(py, &held.header, &header_type)?.get_item(0)?;
                let elements = view(py, &held.elements, &element_type)?;
                messages.append(message.call1((header, elements))?)?;
            }
            all.set_item(facts.name, messages)?;
        }
        Ok(all.unbind())
    }
}

/// Returns the structured type of a message in NumPy.
pub(super) fn dtype<'py>(py: Python<'py>, of: &Descriptor) -> PyResult<Bound<'py, PyAny>> {
    let number = |ros: &str| {
        let bits: usize = ros
            .trim_start_matches(|c: char| !c.is_ascii_digit())
            .parse()
            .unwrap_or(8);
        let kind = if ros.starts_with("float") {
            'f'
        } else if ros.starts_with('u') {
            'u'
        } else {
            'i'
        };
        format!("<{kind}{}", bits / 8)
    };
    let numpy = py.import("numpy")?;
    if of.fields.is_empty() {
        return numpy.call_method1("dtype", (number(of.name),));
    }
    let fields = PyList::empty(py);
    for field in of.fields {
        match field.kind {
            FieldKind::Number(ros) => fields.append((field.name, number(ros)))?,
            FieldKind::Array(ros, count) => {
                fields.append((field.name, number(ros), PyTuple::new(py, [count])?))?;
            }
            FieldKind::Nested(inner) => fields.append((field.name, dtype(py, inner)?))?,
        }
    }
    numpy.call_method1("dtype", (fields,))
}

/// Returns bytes as a read-only array of a type.
fn view<'py>(
    py: Python<'py>,
    bytes: &[u8],
    dtype: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    if bytes.is_empty() {
        return numpy.call_method1("empty", (0, dtype));
    }
    numpy.call_method1("frombuffer", (PyBytes::new(py, bytes), dtype))
}
