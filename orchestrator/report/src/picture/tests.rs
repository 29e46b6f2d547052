//! Tests of whole pictures, and of logs that cannot be drawn.

mod drawing;
mod logs;
