//! The smaller parts of an experiment file: names, seeds, `[run]`, `[[figures]]`.

use config::{Code, FieldPath, suggest};

use super::options::LoadOptions;
use super::parameters::Parameter;
use super::reader::Reader;
use super::seeds::Seeds;
use super::spec::{FigureSpec, MAX_MISSIONS, MAX_NAME, RunSpec, SeedsSpec};

/// Checks a name: it becomes the name of a directory, and part of file names.
pub fn check_name(reader: &mut Reader, path: &FieldPath, name: &str) {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !(1..=MAX_NAME).contains(&name.len()) || !name.chars().all(plain) {
        let message = format!("`{name}` cannot be a name");
        let expected = format!("1 to {MAX_NAME} of a-z, A-Z, 0-9, `_`, `-`");
        reader.refuse(path, Code::OutOfRange, &message, &expected);
    }
}

pub fn read_seeds(reader: &mut Reader, options: &LoadOptions) -> Option<Seeds> {
    const FORM: &str = "{ first = 1, count = 200 }";
    let path = FieldPath::key("seeds");
    let read = match reader.root.get("seeds").cloned() {
        // The command line gives the seeds.
        None if options.seeds.is_some() => Some(Seeds::default()),
        None => {
            reader.refuse(&path, Code::MissingKey, "missing key `seeds`", FORM);
            None
        }
        Some(node) if node.as_table().is_none() => {
            reader.wrong_type(&path, &node, FORM);
            return None;
        }
        Some(node) => {
            let spec: SeedsSpec = reader.read(&node, &path)?;
            reader.check(&node, &path, &spec);
            Seeds::range(spec.first, spec.count.min(MAX_MISSIONS as u64))
        }
    };
    let seeds = match &options.seeds {
        Some(seeds) => seeds.clone(),
        None => read?,
    };
    if seeds.is_empty() {
        reader.refuse(&path, Code::Requirement, "no seeds: nothing to run", FORM);
        return None;
    }
    Some(seeds)
}

pub fn read_run(reader: &mut Reader) -> Option<RunSpec> {
    let path = FieldPath::key("run");
    let Some(node) = reader.root.get("run").cloned() else {
        return Some(RunSpec::default());
    };
    let run: RunSpec = reader.read(&node, &path)?;
    reader.check(&node, &path, &run);
    Some(run)
}

pub fn read_figures(reader: &mut Reader, parameters: &[Parameter]) -> Option<Vec<FigureSpec>> {
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    let mut figures: Vec<FigureSpec> = Vec::new();
    let mut complete = true;
    for (path, node) in reader.blocks("figures") {
        let Some(figure) = reader.read::<FigureSpec>(&node, &path) else {
            complete = false;
            continue;
        };
        check_name(reader, &path.then("name"), &figure.name);
        if figures.iter().any(|f| f.name == figure.name) {
            let message = format!("two figures `{}`", figure.name);
            reader.refuse(
                &path.then("name"),
                Code::Duplicate,
                &message,
                "different names",
            );
        }
        if !names.contains(&figure.x.as_str()) {
            let message = format!("`{}` is not a parameter of this experiment", figure.x);
            let problem = reader.problem(&path.then("x"), Code::UnknownName, message);
            reader
                .problems
                .push(suggest(problem, &figure.x, &names, ""));
        }
        figures.push(figure);
    }
    complete.then_some(figures)
}
