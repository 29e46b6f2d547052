//! `[[links]]`: messages between processes that come later or not at all.

use config::{Code, FieldPath, Node, suggest};
use ipc_types::topics::{TopicId, fits};
use runtime::declaration::{Declaration, Flow, When, between as flows_between};
use runtime::link::Link;

use super::context::Context;
use super::resolved::{ProcessSpec, ResolvedScenario};
use super::spec::{ANY, LinkSpec};

/// Name and kind of the simulator.
const SIMULATOR: &str = "simulator";

/// A sender and receiver of messages.
struct Party<'s> {
    name: &'s str,
    kind: &'s str,
    declaration: Option<Declaration>,
}

impl Party<'_> {
    /// Returns `true` if a link names it.
    fn is_named(&self, pattern: &str) -> bool {
        pattern == ANY || pattern == self.kind || fits(pattern, self.name)
    }
}

/// Returns the simulator and the processes, in the order of their indices in the run.
fn parties(processes: &[ProcessSpec]) -> Vec<Party<'_>> {
    let simulator = Party {
        name: SIMULATOR,
        kind: SIMULATOR,
        declaration: Some(Declaration::of_simulator()),
    };
    let processes = processes.iter().map(|process| Party {
        name: &process.name,
        kind: process.program.kind_name().unwrap_or_default(),
        declaration: process.declaration(),
    });
    [simulator].into_iter().chain(processes).collect()
}

/// Returns the topics from one party to another, and when they count.
fn topics(from: &Party<'_>, to: &Party<'_>) -> impl Iterator<Item = (TopicId, When)> {
    let flows = flows_between(from.declaration.as_ref(), to.declaration.as_ref());
    flows.into_iter().filter_map(|(flow, when)| match flow {
        Flow::Topic(topic) => Some((topic, when)),
        Flow::Requests(_) | Flow::Answers(_) => None,
    })
}

/// Returns `true` if messages that count at this time may come later or not at all. Others are lasting states and orders,
/// which a receiver may not miss.
fn is_linkable(when: When) -> bool {
    matches!(when, When::ThisTick | When::NextTick)
}

impl ResolvedScenario {
    /// Returns the links to the simulator and to every process, in the order of their indices in the run. Of several
    /// links of the same messages the last one counts.
    pub fn links_by_receiver(&self) -> Vec<Vec<Link>> {
        let parties = parties(&self.processes);
        let to_one = |to: &Party<'_>| {
            let mut links = Vec::new();
            for (from, source) in parties.iter().zip(0..) {
                for (topic, when) in topics(from, to) {
                    let name = topic.name();
                    let mut specs = self.links.iter().rev();
                    let spec = specs.find(|spec| {
                        let named = from.is_named(&spec.from) && to.is_named(&spec.to);
                        named && is_linkable(when) && fits(&spec.topic, name)
                    });
                    links.extend(spec.map(|spec| Link {
                        topic: name.to_owned(),
                        source,
                        from: from.name.to_owned(),
                        to: to.name.to_owned(),
                        delay: (spec.delay_s / self.run.dt).round() as u64,
                        loss: spec.loss,
                    }));
                }
            }
            links
        };
        if self.links.is_empty() {
            return vec![Vec::new(); parties.len()];
        }
        parties.iter().map(to_one).collect()
    }
}

/// Reads all links and checks that each joins processes of the run. Reports all problems.
pub(super) fn resolve(ctx: &mut Context<'_>, processes: &[ProcessSpec]) -> Vec<LinkSpec> {
    // A program that is still to be asked may have topics of its own.
    let is_open = processes.iter().any(ProcessSpec::is_to_be_asked);
    let are_processes_known = ctx.problems.is_empty() && !is_open;
    let parties = parties(processes);
    let mut links = Vec::new();
    for (path, node) in ctx.blocks("links") {
        let Some(link) = ctx.read::<LinkSpec>(&node, &path) else {
            continue;
        };
        if ctx.check(&node, &path, &link) && are_processes_known {
            check(ctx, &node, &path, &link, &parties);
        }
        links.push(link);
    }
    links
}

/// Reports a link that joins no processes.
fn check(
    ctx: &mut Context<'_>,
    node: &Node,
    path: &FieldPath,
    link: &LinkSpec,
    parties: &[Party<'_>],
) {
    let mut unknown = |field: &str, given: &str, what: &str, mut known: Vec<&str>| {
        known.sort_unstable();
        known.dedup();
        let message = format!("no {what} is called `{given}`");
        let blank = ctx.problem(node, path, field, Code::UnknownName, message);
        ctx.problems.push(suggest(blank, given, &known, ""));
    };
    let names: Vec<&str> = TopicId::all().map(TopicId::name).collect();
    if !names.iter().any(|name| fits(&link.topic, name)) {
        return unknown("topic", &link.topic, "topic", names);
    }
    for (field, given) in [("from", &link.from), ("to", &link.to)] {
        if !parties.iter().any(|party| party.is_named(given)) {
            let known = parties.iter().flat_map(|party| [party.name, party.kind]);
            let known = known.chain([ANY]).filter(|name| !name.is_empty()).collect();
            return unknown(field, given, "process or kind", known);
        }
    }
    let all = parties.iter().flat_map(|from| {
        let flows = move |to| topics(from, to).map(move |(topic, when)| (from, to, topic, when));
        parties.iter().flat_map(flows)
    });
    let mut joined = Vec::new();
    let mut topics_between = Vec::new();
    for (from, to, topic, when) in all {
        if from.is_named(&link.from) && to.is_named(&link.to) {
            if fits(&link.topic, topic.name()) {
                joined.push(when);
            }
            if is_linkable(when) {
                topics_between.push(topic.name());
            }
        }
    }
    if joined.iter().any(|&when| is_linkable(when)) {
        return;
    }
    topics_between.sort_unstable();
    topics_between.dedup();
    let (message, expected) = if joined.is_empty() {
        let message = "no message goes over this link";
        (
            message,
            "a topic that the sender writes and the receiver reads",
        )
    } else {
        let message = "maps and changes of obstacles always arrive, in their tick";
        (message, "a topic with messages of single ticks")
    };
    let expected = if topics_between.is_empty() {
        expected.to_owned()
    } else {
        format!("{expected}: {}", topics_between.join(", "))
    };
    ctx.problems.push(
        ctx.problem(node, path, "topic", Code::Requirement, message)
            .value(format!("{} from {} to {}", link.topic, link.from, link.to))
            .expected(expected),
    );
}
