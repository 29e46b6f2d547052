//! Dataflow of a run as a picture: which processes write and read what. It follows from their declarations.

use core::fmt::Write as _;

use ipc_types::topics::ObstacleEvents;
use runtime::declaration::{self, Declaration, Flow, Output, When};
use runtime::link::Link;

use mission::plan::{Launch, Plan};

/// Processes of a run, and the flows between them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dataflow {
    nodes: Vec<Node>,
    edges: Vec<Edge>,
}

/// Processes of one kind with the same declaration and period, or the orchestrator.
#[derive(Debug, Clone, PartialEq)]
struct Node {
    kind: String,
    names: Vec<String>,
    declaration: Option<Declaration>,
    period: u64,
    /// Indices of its processes in the run.
    indices: Vec<u32>,
    /// The links to each of its processes.
    links: Vec<Vec<Link>>,
}

/// Flows from one node to another.
#[derive(Debug, Clone, PartialEq)]
struct Edge {
    from: usize,
    to: usize,
    flows: Vec<String>,
    /// `true` if the reader waits for the writer within the tick.
    is_awaited: bool,
}

impl Dataflow {
    /// Returns the dataflow of a planned run, in the order of its processes.
    pub(crate) fn new(plan: &Plan) -> Self {
        let mut nodes: Vec<Node> = Vec::new();
        if !plan.obstacle_changes.is_empty() {
            nodes.push(Node {
                kind: "orchestrator".to_owned(),
                names: Vec::new(),
                declaration: Some(Declaration {
                    outputs: vec![Output::new::<ObstacleEvents>(1)],
                    ..Declaration::default()
                }),
                period: 1,
                indices: vec![plan.orchestrator_index()],
                links: vec![Vec::new()],
            });
        }
        for launch in &plan.launches {
            let Launch {
                config,
                declaration,
                ..
            } = launch;
            let flows = |known: &Option<Declaration>| known.as_ref().map(flows_of);
            let like = nodes.iter_mut().find(|node| {
                node.declaration.is_some()
                    && (&node.kind, node.period) == (&config.kind, config.period)
                    && flows(&node.declaration) == flows(declaration)
            });
            match like {
                Some(node) => {
                    node.names.push(config.name.clone());
                    node.indices.push(config.index);
                    node.links.push(config.links.clone());
                }
                None => nodes.push(Node {
                    kind: config.kind.clone(),
                    names: vec![config.name.clone()],
                    declaration: declaration.clone(),
                    period: config.period,
                    indices: vec![config.index],
                    links: vec![config.links.clone()],
                }),
            }
        }
        let mut edges = Vec::new();
        for (from, writer) in nodes.iter().enumerate() {
            for (to, reader) in nodes.iter().enumerate() {
                let (flows, is_awaited) = between(writer, reader, plan.run.tick_period());
                if !flows.is_empty() && from != to {
                    edges.push(Edge {
                        from,
                        to,
                        flows,
                        is_awaited,
                    });
                }
            }
        }
        Self { nodes, edges }
    }

    /// Returns it as a flowchart in Mermaid. A dotted arrow is for the next tick.
    pub(crate) fn mermaid(&self) -> String {
        let mut text = String::from("flowchart LR\n");
        for (at, node) in self.nodes.iter().enumerate() {
            // A write to a String cannot fail.
            let _ = writeln!(
                text,
                "    n{at}[\"{}\"]",
                node.title("<b>", "</b>", "<br/>")
            );
        }
        for edge in &self.edges {
            let Edge { from, to, .. } = edge;
            let label = edge.flows.join("<br/>");
            let _ = if edge.is_awaited {
                writeln!(text, "    n{from} -- \"{label}\" --> n{to}")
            } else {
                writeln!(text, "    n{from} -. \"{label}\" .-> n{to}")
            };
        }
        text
    }

    /// Returns it as an N² chart in SVG: processes on the diagonal, and in row i and column j what i writes for j. Flows
    /// for the next tick are in italics.
    pub(crate) fn svg(&self) -> String {
        const WIDTH: usize = 190;
        const LINE: usize = 16;
        let rows: Vec<usize> = (0..self.nodes.len())
            .map(|row| {
                let own = self.edges.iter().filter(|edge| edge.from == row);
                let flows = own.map(|edge| edge.flows.len()).max().unwrap_or(0);
                (flows.max(2) + 1) * LINE
            })
            .collect();
        let (width, height) = (self.nodes.len() * WIDTH, rows.iter().sum::<usize>());
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\" text-anchor=\"middle\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
        );
        let mut top = 0;
        for (row, node) in self.nodes.iter().enumerate() {
            let (left, high) = (row * WIDTH, rows[row]);
            let middle = top + high / 2;
            let _ = writeln!(
                svg,
                "<path d=\"M0 {top}H{width}\" stroke=\"#ddd\"/>\n\
                 <rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"5\" fill=\"#e8eef7\" stroke=\"#4a6fa5\"/>",
                left + 4,
                top + 4,
                WIDTH - 8,
                high - 8
            );
            let title = node.title("", "", "\n");
            lines(&mut svg, title.lines(), left + WIDTH / 2, middle, "", LINE);
            for edge in self.edges.iter().filter(|edge| edge.from == row) {
                let style = if edge.is_awaited {
                    ""
                } else {
                    " font-style=\"italic\" fill=\"#666\""
                };
                let x = edge.to * WIDTH + WIDTH / 2;
                let flows = edge.flows.iter().map(|flow| &**flow);
                lines(&mut svg, flows, x, middle, style, LINE);
            }
            top += high;
        }
        svg.push_str("</svg>\n");
        svg
    }
}

impl Node {
    /// Returns its kind, the name or the number of its processes, and their period.
    fn title(&self, open: &str, close: &str, newline: &str) -> String {
        let kind = &self.kind;
        let names = match self.names.as_slice() {
            [name] if name != kind => format!("{newline}{name}"),
            [] | [_] => String::new(),
            names => format!("{newline}{} processes", names.len()),
        };
        let period = match self.period {
            1 => String::new(),
            period => format!("{newline}every {} tick", ordinal(period)),
        };
        format!("{open}{kind}{close}{names}{period}")
    }
}

/// Returns the flows of a declaration without the sizes of messages.
fn flows_of(declaration: &Declaration) -> (Vec<Flow>, Vec<Flow>) {
    let inputs = declaration.inputs.iter().map(|input| input.flow);
    let outputs = declaration.outputs.iter().map(|output| output.flow);
    (inputs.collect(), outputs.collect())
}

/// Returns what the processes of a node write for those of another, with the links between them, and whether any of it counts
/// within the tick.
fn between(writer: &Node, reader: &Node, tick_period_s: f64) -> (Vec<String>, bool) {
    let flows = declaration::between(writer.declaration.as_ref(), reader.declaration.as_ref());
    let mut labels: Vec<String> = Vec::new();
    let mut is_awaited = false;
    for (flow, when) in flows {
        is_awaited |= when == When::ThisTick;
        let name = flow.to_string();
        for source in &writer.indices {
            for links in &reader.links {
                let mut links = links.iter();
                let link = links.find(|link| link.source == *source && link.topic == name);
                let link = link.map(|link| link_text(link, tick_period_s));
                let label = format!("{name}{}", link.unwrap_or_default());
                if !labels.contains(&label) {
                    labels.push(label);
                }
            }
        }
    }
    (labels, is_awaited)
}

/// Returns a number of a series: 2nd, 3rd, 11th.
fn ordinal(number: u64) -> String {
    let ending = match (number % 10, number % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{number}{ending}")
}

/// Returns delay and loss of a link as the end of its label.
fn link_text(link: &Link, tick_period_s: f64) -> String {
    // Without the rounding error of the product.
    let delay_s = (link.delay as f64 * tick_period_s * 1e6).round() / 1e6;
    let delay = (link.delay > 0).then(|| format!("+{delay_s} s"));
    let lost_percent = (link.loss * 1e6).round() / 1e4;
    let loss = (link.loss > 0.0).then(|| format!("{lost_percent} % lost"));
    let parts: Vec<String> = [delay, loss].into_iter().flatten().collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" ({})", parts.join(", "))
    }
}

/// Writes lines of text about a centre.
fn lines<'a>(
    svg: &mut String,
    text: impl Iterator<Item = &'a str>,
    x: usize,
    middle: usize,
    style: &str,
    line: usize,
) {
    let text: Vec<&str> = text.collect();
    let first = middle + line / 3 - (text.len().saturating_sub(1)) * line / 2;
    for (at, text) in text.iter().enumerate() {
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let y = first + at * line;
        let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\"{style}>{text}</text>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinds::load;

    fn dataflow(name: &str) -> Dataflow {
        let scenario = load(name, &[], None).unwrap();
        Dataflow::new(&Plan::new(&scenario, "warn").unwrap())
    }

    #[test]
    fn the_police_read_the_beliefs_of_perception_within_the_tick() {
        let text = dataflow("chase").mermaid();
        let node = |kind: &str| {
            let line = text
                .lines()
                .find(|line| line.contains(&format!("<b>{kind}</b>")));
            line.unwrap().trim().split('[').next().unwrap().to_owned()
        };
        let (simulator, perception) = (node("simulator"), node("perception"));
        let (pursuer, evader) = (node("pursuer"), node("evader_potential"));
        for line in [
            format!("{perception} -- \"perception/belief\" --> {pursuer}"),
            format!("{simulator} -- \"world/state<br/>world/map\" --> {evader}"),
            format!("{pursuer} -. \"robot/command\" .-> {simulator}"),
        ] {
            assert!(text.contains(&line), "{line}\n{text}");
        }
        assert!(!text.contains(&format!(
            "{perception} -- \"perception/belief\" --> {evader}"
        )));
    }

    #[test]
    fn requests_and_answers_are_flows() {
        let text = dataflow("popup").mermaid();
        assert!(text.contains("requests of optimiser/plan"), "{text}");
        assert!(text.contains("answers of optimiser/plan"), "{text}");
        let svg = dataflow("popup").svg();
        assert_eq!(
            svg.matches("<rect").count(),
            1 + dataflow("popup").nodes.len()
        );
    }
}
