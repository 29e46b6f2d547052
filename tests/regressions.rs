//! Defects that were found: one file for each, named by its symptom.

mod evader_aims_through_a_wall;
mod false_length_in_a_log_ends_the_program;
mod paced_world_runs_ahead;
mod patrol_outside_the_map;
mod police_push_at_the_exit_and_queue;
mod studio_opens_no_log;
