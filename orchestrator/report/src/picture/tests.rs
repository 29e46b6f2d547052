//! Tests of whole pictures, and of logs that cannot be drawn.

mod before_run;
mod drawing;
mod logs;
