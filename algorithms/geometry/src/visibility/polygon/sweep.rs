//! Angular sweep: the nearest wall in each direction.

use nalgebra::Vector2;

use super::span::{Span, direction};

/// A direction in which walls begin or end.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    pub(super) direction: f64,
    /// The span that begins there.
    pub(super) begins: Option<usize>,
}

/// An angular sweep over the walls, from one direction to the next.
///
/// Walls do not cross: the nearest one remains so until it ends or a nearer one begins. So only new
/// walls are compared with it, and all open walls only at its end.
pub struct Sweep {
    begin: f64,
    spans: Vec<Span>,
    /// Walls that have begun; some may have ended.
    open: Vec<usize>,
    /// The nearest wall at the last direction.
    nearest: Option<usize>,
}

impl Sweep {
    /// Begins at an angle (rad), to which the spans' directions are relative.
    pub(super) fn new(begin: f64, spans: Vec<Span>) -> Self {
        // Walls across the start are already open.
        let open = (0..spans.len()).filter(|&span| spans[span].begins == 0.0);
        Self {
            begin,
            open: open.collect(),
            spans,
            nearest: None,
        }
    }

    /// The span with this index.
    pub(super) fn span(&self, span: usize) -> &Span {
        &self.spans[span]
    }

    /// Opens a wall that begins before the middle of the current directions; `ray` is the direction
    /// of the middle, once known.
    pub(super) fn open(&mut self, span: usize, middle: f64, ray: &mut Option<Vector2<f64>>) {
        self.open.push(span);
        let here = &self.spans[span];
        if let Some(nearest) = self.nearest
            && self.spans[nearest].ends > middle
            && here.ends > middle
            && !self.spans[nearest].hides(here)
        {
            let ray = *ray.get_or_insert_with(|| direction(self.begin + middle));
            if here.distance(ray) < self.spans[nearest].distance(ray) {
                self.nearest = Some(span);
            }
        }
    }

    /// The nearest wall in the middle of the current directions, after all earlier walls have been
    /// opened.
    pub(super) fn nearest(&mut self, middle: f64, ray: &mut Option<Vector2<f64>>) -> Option<usize> {
        let spans = &self.spans;
        if self.nearest.is_none_or(|span| spans[span].ends <= middle) {
            self.open.retain(|&span| spans[span].ends > middle);
            let ray = *ray.get_or_insert_with(|| direction(self.begin + middle));
            let distances = self
                .open
                .iter()
                .map(|&span| (span, spans[span].distance(ray)));
            self.nearest = distances
                .min_by(|(_, a), (_, b)| a.total_cmp(b))
                .map(|(span, _)| span);
        }
        self.nearest
    }

    /// Returns `true` if two spans are parts of one wall.
    pub(super) fn is_one_wall(&self, a: usize, b: usize) -> bool {
        a == b || self.spans[a].from == self.spans[b].from
    }
}
