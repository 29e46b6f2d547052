//! Checks of single parameters, and the error that names what is wrong with one.

pub use parameters::{
    Fidelity, ParamsError, finite, fraction, not_negative, positive, require, within,
};
