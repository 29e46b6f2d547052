//! The picture as a whole, and logs that cannot be drawn.

mod drawing;
mod logs;
