//! `[grid]`: the values of the parameters; all combinations are run.

use config::{Code, FieldPath, Node, suggest};

use super::cell::Value;
use super::parameters::Parameter;
use super::reader::Reader;
use super::spec::MAX_CELLS;

/// A value and its location.
#[derive(Debug, Clone)]
pub struct LocatedValue {
    pub value: Value,
    pub node: Node,
}

/// Returns the combinations in order, each with a value for every parameter; one empty combination
/// if there are no parameters. `None` after a reported problem.
pub fn read(reader: &mut Reader, parameters: &[Parameter]) -> Option<Vec<Vec<LocatedValue>>> {
    if reader.root.get("grid").is_none() {
        if let Some(parameter) = parameters.first() {
            let message = format!("parameter `{}` is not in the grid", parameter.name);
            reader.refuse(
                &FieldPath::key("parameters").then(&parameter.name),
                Code::Requirement,
                &message,
                "a [grid] with a list of values for every parameter",
            );
            return None;
        }
        return Some(vec![Vec::new()]);
    }
    let before = reader.problems.len();
    let found = cartesian(reader, parameters);
    (reader.problems.len() == before).then_some(found)
}

/// Reports a name that is not that of a parameter.
fn check_known(reader: &mut Reader, parameters: &[Parameter], path: &FieldPath, name: &str) {
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    if names.contains(&name) {
        return;
    }
    let message = format!("unknown parameter `{name}`");
    let problem = reader.problem(path, Code::UnknownName, message);
    let problem = suggest(problem, name, &names, "a name from [parameters]: ");
    reader.problems.push(problem);
}

fn cartesian(reader: &mut Reader, parameters: &[Parameter]) -> Vec<Vec<LocatedValue>> {
    const VALUES: &str = "a list of at least one value";
    let axes = reader.table("grid");
    for (name, path, _) in &axes {
        check_known(reader, parameters, path, name);
    }
    if axes.is_empty() {
        reader.refuse(
            &FieldPath::key("grid"),
            Code::Requirement,
            "the grid is empty",
            "a list of values for every parameter, for example relative_speed = [1.0, 1.5]",
        );
    }
    let mut combinations = vec![Vec::new()];
    for parameter in parameters {
        let path = FieldPath::key("grid").then(&parameter.name);
        let Some((_, _, node)) = axes.iter().find(|a| a.0 == parameter.name) else {
            if !axes.is_empty() {
                let message = format!("parameter `{}` has no values", parameter.name);
                reader.refuse(&path, Code::MissingKey, &message, VALUES);
            }
            continue;
        };
        let Some(list) = node.as_array().filter(|list| !list.is_empty()) else {
            reader.wrong_type(&path, node, VALUES);
            continue;
        };
        if combinations.len().saturating_mul(list.len()) > MAX_CELLS {
            let message = format!("the grid has more than {MAX_CELLS} combinations");
            reader.refuse(
                &path,
                Code::Limit,
                &message,
                "fewer values, or several experiments",
            );
            return Vec::new();
        }
        let values = distinct(reader, parameter, &path, list);
        combinations = combinations
            .iter()
            .flat_map(|c: &Vec<LocatedValue>| {
                values
                    .iter()
                    .map(move |v| c.iter().chain([v]).cloned().collect())
            })
            .collect();
    }
    combinations
}

/// Returns the values of an axis; reports duplicates.
fn distinct(
    reader: &mut Reader,
    parameter: &Parameter,
    path: &FieldPath,
    list: &[Node],
) -> Vec<LocatedValue> {
    let mut values: Vec<LocatedValue> = Vec::new();
    for (i, node) in list.iter().enumerate() {
        let path = path.step(node.element_step(i));
        let Some(value) = parameter.check(reader, &path, node) else {
            continue;
        };
        if values.iter().any(|v| v.value.same(&value)) {
            let message = format!("`{}` has the value {value} twice", parameter.name);
            reader.refuse(&path, Code::Duplicate, &message, "different values");
        }
        values.push(LocatedValue {
            value,
            node: node.clone(),
        });
    }
    values
}
