//! One real process with the test in the place of everybody else.
