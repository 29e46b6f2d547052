//! Parameters that name a file: its contents take the place of its path.

use config::{Code, FieldPath, Node};
use runtime::files::{self, MAX_FILE};

use crate::context::Context;
use crate::files::Base;
use crate::kind::Kind;

/// Returns the parameters with the contents of all files; reports those that cannot be read.
pub fn insert(
    ctx: &mut Context<'_>,
    base: &Base,
    params: Node,
    path: &FieldPath,
    kind: &Kind,
) -> Option<Node> {
    let mut filled = params;
    for key in kind.files {
        // Other types are reported where the parameters are read.
        let Some(file) = filled.get(key).and_then(Node::as_str) else {
            continue;
        };
        if file.is_empty() || files::is_contents(file) {
            continue;
        }
        match base.read(file, MAX_FILE) {
            Ok(contents) => {
                let origin = filled.get(key).map_or(filled.origin, |node| node.origin);
                let mut value = Node::implied_str(&files::value(&contents));
                value.origin = origin;
                if let Some(table) = filled.as_table_mut() {
                    table.set(key, origin, value);
                }
            }
            Err(refused) => {
                ctx.problems.push(
                    ctx.problem(&filled, path, key, Code::File, refused.message)
                        .value(file)
                        .expected(refused.expected),
                );
                return None;
            }
        }
    }
    Some(filled)
}
