//! Drawings as SVG: the page to draw on ([`canvas`]), the colours of everything that is drawn
//! ([`palette`]) and charts of measured points ([`figures`]).

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod canvas;
pub mod figures;
pub mod palette;
