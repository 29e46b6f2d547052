//! Drawings as SVG: the canvas ([`canvas`]), the colours of all drawings ([`palette`]), legends ([`legend`]); the same as
//! PNG, PDF and pixels ([`raster`]).

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod canvas;
pub mod legend;
pub mod palette;
pub mod raster;
