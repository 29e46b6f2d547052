//! Tables of topics that are refused, and the declaration of a process.

use runtime::declaration::WrittenDeclaration;

use super::{build, folder};
use crate::Library;

const FIELDS: &str =
    "PROTEAN_FIELD(echo, range, \"float64\"), PROTEAN_FIELD(echo, cells, \"uint8[8]\")";
const TOPIC: &str = "\"NAME\", PROTEAN_ELEMENTS(echo, ECHO), .capacity = 4";
const TABLE: &str =
    ".create = create, .destroy = destroy, .step = step, .writes = &ECHOES, .write_count = 1";

/// Loads a process with these parts; `None` without a compiler.
fn load(name: &str, fields: &str, topic: &str, table: &str) -> Option<Result<Library, String>> {
    let folder = folder();
    let topic = topic.replace("NAME", &format!("own_c/{name}"));
    let source = format!(
        "#include \"protean_planner.h\"\n\
         typedef struct echo {{ double range; uint8_t cells[8]; }} echo;\n\
         void *create(const protean_start *s) {{ return (void *)s; }}\n\
         void steer(void *p, const protean_tick *t, protean_steering *s) {{ (void)p; (void)t; (void)s; }}\n\
         void step(void *p, const protean_tick *t) {{ (void)p; (void)t; }}\n\
         void destroy(void *p) {{ (void)p; }}\n\
         const protean_field ECHO[] = {{{fields}}};\n\
         const protean_topic ECHOES = {{{topic}}};\n\
         const protean_planner *protean_planner_table(void) {{\n\
         static const protean_planner table = {{.version = PROTEAN_PLANNER_VERSION, {table}}};\nreturn &table;\n}}\n"
    );
    let path = build(folder.path(), &format!("{name}.c"), &source)?;
    Some(Library::load(&path).map_err(|error| error.to_string()))
}

#[test]
fn a_process_declares_its_topics_and_their_layouts() {
    let topic =
        format!("{TOPIC}, .may_be_infinite = \"range\", .flags = PROTEAN_LATER | PROTEAN_SOLE");
    let table = format!("{TABLE}, .reads = &ECHOES, .read_count = 1");
    let Some(library) = load("whole", FIELDS, &topic, &table) else {
        return;
    };
    let library = library.unwrap();
    assert!(library.is_process());
    let json = serde_json::json!({
        "reads": ["own_c/whole"],
        "writes": [{
            "name": "own_c/whole", "message": "float64 range\nuint8[8] cells\n", "elements": 4,
            "later": true, "sole": true, "may_be_infinite": ["range"],
        }],
    });
    let expected: WrittenDeclaration = serde_json::from_value(json).unwrap();
    assert_eq!(library.declaration().unwrap(), expected);
}

/// Checks the errors of processes that differ from the whole one in one part: the word of its source, and what replaces it.
fn refused(cases: &[(&str, &str, &str, &str)]) {
    for (name, from, to, expected) in cases {
        let [fields, topic, table] = [FIELDS, TOPIC, TABLE].map(|part| part.replace(from, to));
        let Some(loaded) = load(name, &fields, &topic, &table) else {
            return;
        };
        let error = loaded.unwrap_err();
        assert!(error.contains(expected), "{name}: {error}");
    }
}

#[test]
fn faults_of_layouts_are_named_with_field_and_expectation() {
    refused(&[
        (
            "size",
            "PROTEAN_ELEMENTS(echo, ECHO)",
            "24, ECHO, 2",
            "topic \"own_c/size\": the structure has 24 bytes: expected 16",
        ),
        (
            "narrow",
            "float64",
            "float32",
            "the structure has field range with 8 bytes at byte 0: expected field range with 4 bytes at byte 0",
        ),
        (
            "short",
            "PROTEAN_ELEMENTS(echo, ECHO)",
            "sizeof(echo), ECHO, 1",
            "the structure has 16 bytes: expected 8",
        ),
        (
            "shifted",
            "echo, cells, \"uint8[8]\"",
            "echo, cells, \"uint8[8]\"), PROTEAN_FIELD(echo, range, \"float64\"",
            "field \"range\": expected a name of its own",
        ),
        (
            "overlap",
            FIELDS,
            "PROTEAN_FIELD(echo, range, \"float64\"), {\"cells\", \"uint8[8]\", 4, 8}",
            "field cells with 8 bytes at byte 4: expected field cells with 8 bytes at byte 8",
        ),
        (
            "kind",
            "float64",
            "double",
            "type \"double\": expected one of float64",
        ),
        (
            "unnamed",
            "\"NAME\"",
            "0",
            "topic \"\": expected a name of lower-case words",
        ),
        (
            "built_in",
            "NAME",
            "world/state",
            "expected a name that Protean's own topics do not have",
        ),
        (
            "missing",
            "PROTEAN_ELEMENTS(echo, ECHO)",
            "sizeof(echo), 0, 2",
            "fields: 2 at NULL: expected an array",
        ),
        (
            "long",
            "PROTEAN_ELEMENTS(echo, ECHO)",
            "sizeof(echo), ECHO, 1u << 30",
            "fields: 1073741824 at an address: expected an array of at most 256",
        ),
        (
            "empty",
            ".capacity = 4",
            ".capacity = 0",
            "elements = 0: expected from 1",
        ),
        (
            "flags",
            ".capacity = 4",
            ".capacity = 4, .flags = 8",
            "flags = 8: expected a sum of PROTEAN_LATER",
        ),
        (
            "drawing",
            ".capacity = 4",
            ".capacity = 4, .drawing = \"x\"",
            "drawing: \"x\": expected words as x=FIELD",
        ),
        (
            "infinite",
            ".capacity = 4",
            ".capacity = 4, .may_be_infinite = \"cell\"",
            "may_be_infinite: \"cell\": expected a field of the messages",
        ),
    ]);
}

#[test]
fn faults_of_tables_of_topics_are_named() {
    refused(&[
        (
            "null",
            "&ECHOES",
            "0",
            "writes: 1 at NULL: expected an array",
        ),
        (
            "both",
            ".step = step",
            ".step = step, .steer = steer",
            "either steer or step",
        ),
        (
            "planner",
            ".step = step",
            ".steer = steer",
            "writes of a planner: expected none, or step",
        ),
        (
            "inputs",
            ".step = step",
            ".step = step, .inputs = 1",
            "inputs of a process: expected 0",
        ),
        (
            "reads",
            ".step = step",
            ".step = step, .reads = 0, .read_count = 3",
            "reads: 3 at NULL: expected an array",
        ),
    ]);
}

#[test]
fn a_class_of_cpp_is_a_process() {
    let folder = folder();
    let source = "#include \"protean_planner.h\"\nstruct echo { double range; };\n\
                  static const protean_field ECHO[] = {PROTEAN_FIELD(echo, range, \"float64\")};\n\
                  static const protean_topic ECHOES[] = {\n\
                  {\"own_c/class\", PROTEAN_ELEMENTS(echo, ECHO), 4, nullptr, nullptr, 0}};\n\
                  struct Sonar {\nexplicit Sonar(const protean_start &) {}\n\
                  void step(const protean_tick &tick) { protean_write(&tick, \"own_c/class\", nullptr, 0); }\n};\n\
                  PROTEAN_PROCESS(Sonar, nullptr, ECHOES)\n";
    let Some(path) = build(folder.path(), "sonar.cpp", source) else {
        return;
    };
    let declared = Library::load(&path).unwrap().declaration().unwrap();
    assert_eq!((declared.reads.len(), declared.writes.len()), (0, 1));
}
