//! Drawings as SVG: the canvas ([`canvas`]), the colours of all drawings ([`palette`]), legends ([`legend`]); the same as
//! PNG, PDF and pixels ([`raster`]).

pub mod canvas;
pub mod legend;
pub mod palette;
pub mod raster;
