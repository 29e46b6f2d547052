//! State that every part of the resolution shares: the texts, the tree and the diagnostics.

use config::{Code, Diagnostic, Diagnostics, FieldPath, Node, Origin, Sources, problem_at, read};
use parameters::{Fault, Parameters, ParamsError, faults};
use serde::de::DeserializeOwned;

use super::kind::Kind;

/// The scenario being resolved.
pub struct Context<'a> {
    /// Texts that the scenario was read from.
    pub sources: Sources,
    /// Tree of the scenario, with the overrides applied.
    pub root: Node,
    /// Available kinds of processes.
    pub kinds: &'a [Kind],
    /// Problems found so far.
    pub problems: Diagnostics,
}

impl Context<'_> {
    /// Returns the elements of a top-level array of tables (`[[robots]]`) with their paths. Reports a value
    /// of another type.
    pub fn blocks(&mut self, key: &str) -> Vec<(FieldPath, Node)> {
        let path = FieldPath::key(key);
        let Some(node) = self.root.get(key) else {
            return Vec::new();
        };
        if let Some(list) = node.as_array() {
            let with_path = |(i, n): (usize, &Node)| (path.step(n.element_step(i)), n.clone());
            return list.iter().enumerate().map(with_path).collect();
        }
        let found = format!("wrong type: {}", node.type_name());
        let problem = problem_at(&self.sources, &self.root, &path, Code::WrongType, found)
            .expected(format!("[[{key}]] blocks"));
        self.problems.push(problem);
        Vec::new()
    }

    /// Reads a node and reports everything wrong with it.
    pub fn read<T: DeserializeOwned>(&mut self, node: &Node, path: &FieldPath) -> Option<T> {
        read(&self.sources, node, path, &mut self.problems)
    }

    /// Reads and checks a top-level table; an absent table has its defaults.
    pub fn section<T: Parameters + Default>(&mut self, key: &str) -> Option<T> {
        if self.root.get(key).is_none() {
            return Some(T::default());
        }
        let path = FieldPath::key(key);
        let node = self.root.follow(&path).clone();
        let value = self.read(&node, &path)?;
        self.check_section(key, &value);
        Some(value)
    }

    /// Checks ranges and relations of a top-level table; messages contain its path.
    pub fn check_section<T: Parameters>(&mut self, key: &str, value: &T) {
        for fault in faults(value) {
            let root = self.root.clone();
            self.refuse(&root, &FieldPath::default(), fault.within(key));
        }
    }

    /// Adds a problem at a field below the node with this path.
    pub fn problem(
        &self,
        node: &Node,
        base: &FieldPath,
        field: &str,
        code: Code,
        message: impl Into<String>,
    ) -> Diagnostic {
        let below = if field.is_empty() {
            FieldPath::default()
        } else {
            FieldPath::parse(field)
        };
        problem_at(&self.sources, node, &below, code, message).field(base.join(&below))
    }

    /// Reports a value that the check of its type refused.
    pub fn refuse(&mut self, node: &Node, base: &FieldPath, found: ParamsError) {
        self.problems
            .push(refusal(&self.sources, node, base, found));
    }

    /// Checks ranges and relations of a value read from a node. Returns `true` if all hold.
    pub fn check<T: Parameters>(&mut self, node: &Node, base: &FieldPath, value: &T) -> bool {
        let faults = faults(value);
        let holds = faults.is_empty();
        for fault in faults {
            self.refuse(node, base, fault);
        }
        holds
    }

    /// Adds a problem at a whole node, shown at the node's first line.
    pub fn block_problem(
        &self,
        origin: Origin,
        path: &FieldPath,
        code: Code,
        message: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic::new(code, message)
            .at(self.sources.place(origin))
            .field(path)
    }
}

/// The problem that a declaration's check finds with a value below a node.
pub fn refusal(sources: &Sources, node: &Node, base: &FieldPath, found: ParamsError) -> Diagnostic {
    let ParamsError { field, fault } = found;
    let message = match &fault {
        Fault::Refused(message) => message.clone(),
        Fault::Value { .. } if field.is_empty() => "value out of range".to_owned(),
        Fault::Value { .. } => format!("`{field}` is out of range"),
    };
    let below = if field.is_empty() {
        FieldPath::default()
    } else {
        FieldPath::parse(&field)
    };
    let problem = problem_at(sources, node, &below, Code::OutOfRange, message);
    let problem = problem.field(base.join(&below));
    match fault {
        Fault::Value { found, expected } => problem.value(found).expected(expected),
        Fault::Refused(_) => problem,
    }
}
