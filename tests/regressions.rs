//! Defects that were found: one file for each, named by its symptom.

#[path = "regressions/evader_aims_through_a_wall.rs"]
mod evader_aims_through_a_wall;
#[path = "regressions/false_length_in_a_log_ends_the_program.rs"]
mod false_length_in_a_log_ends_the_program;
#[path = "regressions/paced_world_runs_ahead.rs"]
mod paced_world_runs_ahead;
#[path = "regressions/patrol_outside_the_map.rs"]
mod patrol_outside_the_map;
#[path = "regressions/police_push_at_the_exit_and_queue.rs"]
mod police_push_at_the_exit_and_queue;
#[path = "regressions/studio_opens_no_log.rs"]
mod studio_opens_no_log;
