//! The instances of one thread.

use std::sync::Arc;

use core::ops::Range;

use crate::arrays::ArraysMut;
use crate::backend::Backend;
use crate::episode::{Episode, WhichEpisode};
use crate::error::EnvironmentError;
use crate::instance::{Instance, Scratch};
use crate::shared::Shared;

/// Consecutive instances, stepped one after the other.
#[derive(Debug)]
pub(crate) struct Chunk<B> {
    shared: Arc<Shared>,
    range: Range<usize>,
    scratch: Scratch,
    /// Empty before the first reset, and after an error.
    instances: Vec<Instance<B>>,
}

impl<B: Backend> Chunk<B> {
    pub fn new(shared: Arc<Shared>, range: Range<usize>) -> Self {
        Self {
            scratch: Scratch::new(&shared),
            shared,
            range,
            instances: Vec::new(),
        }
    }

    /// Begins new episodes: the first ones of a seed, or the next ones.
    pub fn reset(
        &mut self,
        seed: Option<u64>,
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        if seed.is_some() || self.instances.is_empty() {
            let seed = seed.unwrap_or(self.shared.options.seed);
            let begin = |index| Instance::new(&self.shared, index, seed);
            self.instances = self.range.clone().map(begin).collect::<Result<_, _>>()?;
        } else {
            let mut instances = self.instances.iter_mut();
            instances.try_for_each(|instance| instance.begin_next(&self.shared))?;
        }
        let shape = self.shared.shape;
        for (row, instance) in self.instances.iter_mut().enumerate() {
            let mut row = arrays.row(row, &shape);
            instance.write_reset(&self.shared, &mut self.scratch, &mut row)?;
        }
        Ok(())
    }

    /// Steps all instances; `actions` and `arrays` are those of this chunk alone.
    pub fn step(
        &mut self,
        actions: &[f32],
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        if self.instances.is_empty() {
            return Err(EnvironmentError::NotReset);
        }
        let shape = self.shared.shape;
        let width = shape.with_instances(1).actions();
        let rows = actions.chunks_exact(width);
        for (row, (instance, actions)) in self.instances.iter_mut().zip(rows).enumerate() {
            let mut row = arrays.row(row, &shape);
            let stepped = instance.step(&self.shared, &mut self.scratch, actions, &mut row);
            if let Err(error) = stepped {
                // Some instances have stepped and others not.
                self.instances.clear();
                return Err(error);
            }
        }
        Ok(())
    }

    /// Returns a recorded episode of an instance, by its index among all.
    pub fn episode(
        &self,
        instance: usize,
        which: WhichEpisode,
    ) -> Result<Episode, EnvironmentError> {
        let at = instance.checked_sub(self.range.start);
        let found = at.and_then(|at| self.instances.get(at));
        let found = found.ok_or(EnvironmentError::NotReset)?;
        let episode = found.episode(which);
        episode.ok_or(EnvironmentError::NoEpisode { instance })
    }
}
