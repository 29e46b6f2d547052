//! Drawings as SVG: the canvas ([`canvas`]), the colours of all drawings ([`palette`]), legends ([`legend`]),
//! charts of measured points ([`figures`]); the same as PNG, PDF and pixels ([`raster`]).
//!
//! ```
//! use draw::figures::{Chart, Point, Series, draw};
//!
//! let point = |x, y| Point {
//!     x,
//!     y,
//!     interval: None,
//! };
//! let chart = Chart {
//!     title: "Escapes".to_owned(),
//!     series: vec![Series {
//!         name: "measured".to_owned(),
//!         points: vec![point(0.4, 0.1), point(0.6, 0.3)],
//!         ..Series::default()
//!     }],
//!     ..Chart::default()
//! };
//! assert!(draw(&chart).svg().starts_with("<svg"));
//! ```

pub mod canvas;
pub mod figures;
pub mod legend;
pub mod palette;
pub mod raster;
