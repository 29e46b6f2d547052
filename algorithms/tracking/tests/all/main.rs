//! The filter in whole scenes; one program, so that it is linked once.

mod tracker;
