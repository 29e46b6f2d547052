//! The crate from outside; one program, because linking two costs.

mod inputs;
mod lockstep;
