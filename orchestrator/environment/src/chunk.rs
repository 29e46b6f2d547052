//! The instances of one thread.

use std::sync::Arc;

use core::ops::Range;

use crate::arrays::ArraysMut;
use crate::backend::Backend;
use crate::error::EnvironmentError;
use crate::instance::{Instance, Scratch};
use crate::options::Autoreset;
use crate::running::Look;
use crate::shared::SharedData;
use crate::start::Start;

/// Consecutive instances, stepped one after the other.
#[derive(Debug)]
pub struct Chunk<B> {
    shared: Arc<SharedData>,
    range: Range<usize>,
    scratch: Scratch,
    /// Empty before the first reset, and after an error.
    instances: Vec<Instance<B>>,
}

impl<B: Backend> Chunk<B> {
    pub fn new(shared: Arc<SharedData>, range: Range<usize>) -> Self {
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
        starts: &[Option<Start>],
        arrays: &mut ArraysMut<'_>,
    ) -> Result<(), EnvironmentError> {
        let begun = self.begin(starts);
        if begun.is_err() {
            // Some instances have begun and others not.
            self.instances.clear();
        }
        begun?;
        let shape = self.shared.shape;
        for (row, (own, start)) in self.instances.iter_mut().zip(starts).enumerate() {
            if start.is_some() {
                own.write_reset(&mut self.scratch, &mut arrays.row(row, &shape))?;
            }
        }
        Ok(())
    }

    fn begin(&mut self, starts: &[Option<Start>]) -> Result<(), EnvironmentError> {
        let is_first = self.instances.is_empty();
        for (at, start) in starts.iter().enumerate() {
            self.shared.check_interrupted()?;
            let Some(Start { first, variant }) = start else {
                if is_first {
                    return Err(EnvironmentError::NotReset);
                }
                continue;
            };
            let own = self.instances.get_mut(at);
            let former = own.as_ref().map_or(&self.shared, |own| own.shared());
            let shared = Arc::clone(variant.as_ref().map_or(former, |variant| &variant.0));
            let options = (shared.options.seed, self.range.start + at);
            match (own, first) {
                (Some(own), None) => own.begin_next(&shared)?,
                (Some(own), Some((seed, index))) => *own = Instance::new(&shared, *index, *seed)?,
                (None, first) => {
                    let (seed, index) = first.unwrap_or(options);
                    self.instances.push(Instance::new(&shared, index, seed)?);
                }
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
            let stepped = instance.step(&mut self.scratch, actions, &mut row);
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
        found.look(look);
        Ok(())
    }
}
