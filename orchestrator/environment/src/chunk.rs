//! The instances of one thread.

use std::sync::Arc;

use core::ops::Range;

use crate::arrays::ArraysMut;
use crate::backend::Backend;
use crate::error::EnvironmentError;
use crate::instance::{Instance, Scratch};
use crate::options::{Autoreset, Start};
use crate::running::Look;
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

    /// Begins new episodes; `starts` and `arrays` are those of this chunk alone.
    pub fn reset(
        &mut self,
        starts: &[Start],
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let shared = &self.shared;
        if self.instances.is_empty() {
            let seed = shared.options.seed;
            let begin = |(index, &start)| match start {
                Start::Keep => Err(EnvironmentError::NotReset),
                Start::Next => Instance::new(shared, index, seed),
                Start::First { seed, instance } => Instance::new(shared, instance, seed),
            };
            let starts = self.range.clone().zip(starts);
            self.instances = starts.map(begin).collect::<Result<_, _>>()?;
        } else {
            for (own, &start) in self.instances.iter_mut().zip(starts) {
                match start {
                    Start::Keep => {}
                    Start::Next => own.begin_next(shared)?,
                    Start::First { seed, instance } => {
                        *own = Instance::new(shared, instance, seed)?;
                    }
                }
            }
        }
        let shape = shared.shape;
        for (row, (own, start)) in self.instances.iter_mut().zip(starts).enumerate() {
            if *start != Start::Keep {
                let mut row = arrays.row(row, &shape);
                own.write_reset(shared, &mut self.scratch, &mut row)?;
            }
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
        if self.shared.options.autoreset == Autoreset::Disabled
            && let Some(ended) = self.instances.iter().position(Instance::is_over)
        {
            let instance = self.range.start + ended;
            return Err(EnvironmentError::Ended { instance });
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

    /// Lets `look` see the running episode of an instance, by its index among all.
    pub fn look(&self, instance: usize, look: Look) -> Result<(), EnvironmentError> {
        let at = instance.checked_sub(self.range.start);
        let found = at.and_then(|at| self.instances.get(at));
        let found = found.ok_or(EnvironmentError::NotReset)?;
        found.look(&self.shared, look);
        Ok(())
    }
}
