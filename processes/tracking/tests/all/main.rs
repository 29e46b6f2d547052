//! The filter and its memo in whole scenes; one program, to be linked once.

mod memo;
mod tracker;
