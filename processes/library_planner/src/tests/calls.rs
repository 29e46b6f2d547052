//! A planner that checks all that it gets, its faults, and exceptions.

use serde_json::{Value as Json, json};

use super::world::{start, steer};
use super::{build, folder};
use crate::Library;

/// The probe, built and loaded, and its number of planners; `None` without a compiler.
struct Probe {
    _folder: tempfile::TempDir,
    library: Library,
    loaded: libloading::Library,
}

impl Probe {
    #[expect(
        unsafe_code,
        reason = "a second handle, to call a function of the test"
    )]
    fn new() -> Option<Self> {
        let folder = folder();
        let path = build(folder.path(), "probe.c", include_str!("probe.c"))?;
        Some(Self {
            library: Library::load(&path).unwrap(),
            // SAFETY: the library has no initialisers.
            loaded: unsafe { libloading::Library::new(&path) }.unwrap(),
            _folder: folder,
        })
    }

    #[expect(unsafe_code, reason = "a function of the test")]
    fn living(&self) -> i32 {
        type Living = unsafe extern "C" fn() -> i32;
        // SAFETY: `probe.c` defines the function with this type.
        unsafe { self.loaded.get::<Living>(b"living_planners").unwrap()() }
    }

    fn refusal(&self, params: &Json) -> String {
        start(self.library, params).unwrap_err().to_string()
    }
}

#[test]
fn a_library_gets_robots_rules_view_and_map_and_is_freed_once() {
    let Some(probe) = Probe::new() else { return };
    let mut first = start(probe.library, &json!({ "mode": 0 })).unwrap();
    let second = start(probe.library, &json!({})).unwrap();
    assert_eq!(probe.living(), 2);
    let steering = steer(&mut first).unwrap();
    assert!(steering.command.v > 0.0, "{steering:?}");
    assert_eq!(steering.target, Some(2));
    let exit = nalgebra::Point2::new(3.5, 1.0);
    assert_eq!((steering.aim, steering.waypoint), (Some(exit), Some(exit)));
    drop((first, second));
    assert_eq!(probe.living(), 0);
}

#[test]
fn parameters_are_checked_and_refusals_have_the_text_of_the_library() {
    let Some(probe) = Probe::new() else { return };
    assert_eq!(
        probe.refusal(&json!({ "mode": "fast" })),
        "`mode` is \"fast\": expected a number"
    );
    assert_eq!(
        probe.refusal(&json!({ "moed": 2 })),
        "unknown parameter `moed`: expected one of `mode`, `truth`"
    );
    assert_eq!(
        probe.refusal(&json!({ "mode": 1 })),
        "create returned NULL without protean_refuse"
    );
    // Refused with all parameters as text, although it returns a planner.
    assert_eq!(
        probe.refusal(&json!({ "other": [1], "truth": true })),
        r#"{"other":[1],"truth":true}"#
    );
    assert_eq!(probe.living(), 0);
}

#[test]
fn commands_are_clipped_and_numbers_that_are_not_finite_refused() {
    let Some(probe) = Probe::new() else { return };
    let mode = |mode: i32| {
        let mut driven = start(probe.library, &json!({ "mode": mode })).unwrap();
        steer(&mut driven)
    };
    assert_eq!(
        mode(2).unwrap_err().to_string(),
        "v = NaN, omega = 0: expected finite numbers"
    );
    let clipped = mode(3).unwrap().command;
    assert_eq!((clipped.v, clipped.omega), (0.22, -2.84));
    assert_eq!(mode(4).unwrap_err().to_string(), "no fuel");
    // The random stream is that of seed and robot.
    assert_eq!(mode(5).unwrap().command, mode(5).unwrap().command);
}

#[test]
fn exceptions_of_cpp_end_at_the_boundary_with_their_text() {
    let folder = folder();
    let source = "#include \"protean_planner.h\"\n#include <stdexcept>\nstruct Thrower {\n\
                  explicit Thrower(const protean_start &start) {\n\
                  if (protean_number(&start, \"early\", 0) == 1) throw std::runtime_error(\"too early\");\n\
                  if (protean_number(&start, \"early\", 0) == 2) throw 2;\n}\n\
                  void steer(const protean_tick &, protean_steering &) { throw std::runtime_error(\"too late\"); }\n\
                  };\nPROTEAN_PLANNER(Thrower, 0)\n";
    let Some(path) = build(folder.path(), "thrower.cpp", source) else {
        return;
    };
    let library = Library::load(&path).unwrap();
    let early = |value: i32| start(library, &json!({ "early": value }));
    assert_eq!(early(1).unwrap_err().to_string(), "too early");
    assert_eq!(early(2).unwrap_err().to_string(), "unknown exception");
    assert_eq!(
        steer(&mut early(0).unwrap()).unwrap_err().to_string(),
        "too late"
    );
}
