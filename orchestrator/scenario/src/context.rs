//! What every part of the resolution needs: the texts, the tree, and somewhere to complain.

use config::{Code, Diagnostic, Diagnostics, FieldPath, Node, Origin, Sources, problem_at, read};
use parameters::{Fault, ParamsError};
use serde::de::DeserializeOwned;

use super::kind::Kind;

/// The scenario being resolved.
pub struct Context<'a> {
    /// The texts that it was read from.
    pub sources: Sources,
    /// Its tree, overrides applied.
    pub root: Node,
    /// The kinds of processes that there are.
    pub kinds: &'a [Kind],
    /// What was found wrong.
    pub problems: Diagnostics,
}

impl Context<'_> {
    /// The elements of a top-level array of tables (`[[robots]]`) with their paths. Something else
    /// in its place is reported.
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

    /// Reads a node; everything wrong with it is reported.
    pub fn read<T: DeserializeOwned>(&mut self, node: &Node, path: &FieldPath) -> Option<T> {
        read(&self.sources, node, path, &mut self.problems)
    }

    /// Reads a top-level table; an absent one is its default.
    pub fn section<T: DeserializeOwned + Default>(&mut self, key: &str) -> Option<T> {
        match self.root.get(key) {
            Some(_) => {
                let path = FieldPath::key(key);
                let node = self.root.follow(&path).clone();
                self.read(&node, &path)
            }
            None => Some(T::default()),
        }
    }

    /// A problem at a field below a node with this path.
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

    /// Reports a value that a type's own check refused.
    pub fn refuse(&mut self, node: &Node, base: &FieldPath, found: ParamsError) {
        let ParamsError { field, fault } = found;
        let message = match &fault {
            Fault::Refused(message) => message.clone(),
            Fault::Value { .. } if field.is_empty() => "value out of range".to_owned(),
            Fault::Value { .. } => format!("`{field}` is out of range"),
        };
        let mut problem = self.problem(node, base, &field, Code::OutOfRange, message);
        if let Fault::Value { found, expected } = fault {
            problem = problem.value(found).expected(expected);
        }
        self.problems.push(problem);
    }

    /// Reports a number of a top-level table that is not within its limits.
    pub fn check_range(&mut self, path: &str, value: f64, low: f64, high: f64, unit: &str) {
        if (low..=high).contains(&value) {
            return;
        }
        let path = FieldPath::parse(path);
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" [{unit}]")
        };
        let message = format!("`{path}` is out of range");
        let problem = problem_at(&self.sources, &self.root, &path, Code::OutOfRange, message)
            .value(value)
            .expected(format!("a number from {low} to {high}{unit}"));
        self.problems.push(problem);
    }

    /// A problem at a node as a whole, shown at its first line.
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
