//! Reader of the text of an experiment or a test, with the list of problems.

use config::{
    Code, Diagnostic, Diagnostics, FieldPath, Node, SourceKind, Sources, parse_document,
    problem_at, read,
};
use parameters::{Parameters, faults};
use scenario::refusal;
use serde::de::DeserializeOwned;

/// Text and problems of a file.
pub struct Reader {
    /// The text.
    pub sources: Sources,
    /// Its values.
    pub root: Node,
    /// The problems found so far.
    pub problems: Diagnostics,
}

impl Reader {
    /// Parses the text; `file` is its name in errors.
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

    /// Deserialises a node; reports all problems.
    pub fn read<T: DeserializeOwned>(&mut self, node: &Node, path: &FieldPath) -> Option<T> {
        read(&self.sources, node, path, &mut self.problems)
    }

    /// Checks ranges and relations of a value of a node; reports all problems.
    pub fn check<T: Parameters>(&mut self, node: &Node, path: &FieldPath, value: &T) {
        for fault in faults(value) {
            let problem = refusal(&self.sources, node, path, fault);
            self.problems.push(problem);
        }
    }

    /// Returns the entries of a top-level table; reports a value of another type.
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

    /// Returns the elements of a top-level array of tables; reports a value of another type.
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

    /// Returns a problem at a field, with location and value of the field.
    pub fn problem(&self, path: &FieldPath, code: Code, message: impl Into<String>) -> Diagnostic {
        problem_at(&self.sources, &self.root, path, code, message)
    }

    /// Reports an invalid field.
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

    /// Returns `file:line` of a node.
    pub(super) fn line_of(&self, node: &Node) -> String {
        match self.sources.place(node.origin) {
            Some(place) => format!("{}:{}", place.file, place.line),
            None => "experiment".to_owned(),
        }
    }
}
