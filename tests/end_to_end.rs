//! The whole program as its users meet it: real processes over real shared memory, judged by what
//! they print, what they log and what they leave behind.
//!
//! One program for all of it, because linking nine costs minutes; `cargo test -p end_to_end
//! sweep::` runs the tests of one file.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

mod attacks;
mod bad_input;
mod branch;
mod c_sensor;
mod causes;
mod chaos;
mod chase;
mod command_line;
mod coverage;
mod cpp_planner;
mod determinism;
mod diff;
mod documentation;
mod external;
mod external_planner;
mod external_sensor;
mod goldens;
mod growth;
mod hostile;
mod import;
mod in_process;
mod language;
mod latency;
mod lifecycle;
mod links;
mod live;
mod logs;
mod maps;
mod metadata;
mod mission_tests;
mod missions;
mod namespaces;
mod navigation;
mod package;
mod patrol;
mod patrol_team;
mod plan;
mod planning;
mod policy;
mod process;
mod regressions;
mod replay;
mod report;
mod reproduce;
mod ros;
mod ros2;
mod structure;
mod supervision;
mod sweep;
mod system_calls;
mod tables;
mod teams;
mod triggers;
mod viewers;
