//! An experiment's text, and somewhere to complain.

use config::{
    Code, Diagnostic, Diagnostics, FieldPath, Node, SourceKind, Sources, parse_document,
    problem_at, read,
};
use parameters::{Parameters, faults};
use scenario::refusal;
use serde::de::DeserializeOwned;

/// The text being read.
pub(super) struct Reader {
    pub sources: Sources,
    pub root: Node,
    pub problems: Diagnostics,
}

impl Reader {
    /// Parses the text; `file` is what errors call it.
    ///
    /// # Errors
    /// It is not TOML.
    pub fn new(file: &str, text: &str) -> Result<Self, Diagnostics> {
        let mut sources = Sources::default();
        let mut problems = Diagnostics::default();
        let source = sources.add(SourceKind::File, file, text);
        let Some(root) = parse_document(&sources, source, &mut problems) else {
            problems.push_if_empty(|| Diagnostic::new(Code::Syntax, "not an experiment"));
            return Err(problems.sorted());
        };
        Ok(Self {
            sources,
            root,
            problems,
        })
    }

    /// Reads a node into a type; everything wrong with it is reported.
    pub fn read<T: DeserializeOwned>(&mut self, node: &Node, path: &FieldPath) -> Option<T> {
        read(&self.sources, node, path, &mut self.problems)
    }

    /// Checks ranges and relations of a value that a node says; everything wrong is reported.
    pub fn check<T: Parameters>(&mut self, node: &Node, path: &FieldPath, value: &T) {
        for fault in faults(value) {
            let problem = refusal(&self.sources, node, path, fault);
            self.problems.push(problem);
        }
    }

    /// A top-level table with the names in it; something else in its place is reported.
    pub fn table(&mut self, key: &str) -> Vec<(String, FieldPath, Node)> {
        let Some(node) = self.root.get(key).cloned() else {
            return Vec::new();
        };
        let path = FieldPath::key(key);
        let Some(table) = node.as_table() else {
            self.wrong_type(&path, &node, &format!("a table [{key}]"));
            return Vec::new();
        };
        let entries = table.entries.iter();
        entries
            .map(|e| (e.key.clone(), path.then(&e.key), e.node.clone()))
            .collect()
    }

    /// The elements of a top-level array of tables; something else in its place is reported.
    pub fn blocks(&mut self, key: &str) -> Vec<(FieldPath, Node)> {
        let Some(node) = self.root.get(key).cloned() else {
            return Vec::new();
        };
        let path = FieldPath::key(key);
        let Some(list) = node.as_array() else {
            self.wrong_type(&path, &node, &format!("[[{key}]] blocks"));
            return Vec::new();
        };
        list.iter()
            .enumerate()
            .map(|(i, n)| (path.step(n.element_step(i)), n.clone()))
            .collect()
    }

    /// A problem at a field, with the place and the value that stand there.
    pub fn problem(&self, path: &FieldPath, code: Code, message: impl Into<String>) -> Diagnostic {
        problem_at(&self.sources, &self.root, path, code, message)
    }

    /// Reports that a field is not what it should be.
    pub fn refuse(&mut self, path: &FieldPath, code: Code, message: &str, expected: &str) {
        let problem = self.problem(path, code, message).expected(expected);
        self.problems.push(problem);
    }

    /// Reports a value of the wrong type.
    pub fn wrong_type(&mut self, path: &FieldPath, node: &Node, expected: &str) {
        let message = format!("wrong type: {}", node.type_name());
        let problem = Diagnostic::new(Code::WrongType, message)
            .at(self.sources.place(node.origin))
            .field(path)
            .value(node.render_short())
            .expected(expected);
        self.problems.push(problem);
    }

    /// `file:line`, for what is derived from a place in the text.
    pub fn line_of(&self, node: &Node) -> String {
        match self.sources.place(node.origin) {
            Some(place) => format!("{}:{}", place.file, place.line),
            None => "experiment".to_owned(),
        }
    }
}
