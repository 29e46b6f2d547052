//! The filter in whole scenes; one program, so that it is linked once.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod tracker;
