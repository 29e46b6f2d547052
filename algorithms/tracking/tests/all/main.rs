//! The filter in whole scenes; one program, to be linked once.

mod tracker;
