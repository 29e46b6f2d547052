//! The particles, one array per quantity.

use core::ops::Range;

/// Hypotheses of one opponent's state. All arrays have the same length.
#[derive(Debug, Clone, Default)]
pub struct Cloud {
    /// Position (m).
    pub x: Vec<f32>,
    /// Position (m).
    pub y: Vec<f32>,
    /// Heading (rad), in [−π, π].
    pub heading: Vec<f32>,
    /// Forward speed (m/s); values beyond the limit mean the limit.
    pub v: Vec<f32>,
    /// Turning rate (rad/s); values beyond a limit mean the limit.
    pub omega: Vec<f32>,
}

/// A range of a [`Cloud`], borrowed for writing.
pub struct Stretch<'a> {
    pub x: &'a mut [f32],
    pub y: &'a mut [f32],
    pub heading: &'a mut [f32],
    pub v: &'a mut [f32],
    pub omega: &'a mut [f32],
}

impl Cloud {
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Sets the number of particles; new ones are zero until they are written.
    pub fn resize(&mut self, n: usize) {
        for array in [
            &mut self.x,
            &mut self.y,
            &mut self.heading,
            &mut self.v,
            &mut self.omega,
        ] {
            array.resize(n, 0.0);
        }
    }

    pub fn stretch(&mut self, range: Range<usize>) -> Stretch<'_> {
        Stretch {
            x: &mut self.x[range.clone()],
            y: &mut self.y[range.clone()],
            heading: &mut self.heading[range.clone()],
            v: &mut self.v[range.clone()],
            omega: &mut self.omega[range],
        }
    }
}
