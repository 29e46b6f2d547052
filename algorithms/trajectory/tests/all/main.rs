//! The optimiser as a whole: problems in, plans out.

mod bad_input;
mod curves;
mod ends;
mod inertia;
mod methods;
mod problems;
mod random;
