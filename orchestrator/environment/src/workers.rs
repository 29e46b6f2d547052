//! Threads, each with its own instances for as long as it lives.

use core::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use crate::arrays::{Arrays, ArraysMut, Shape};
use crate::backend::Backend;
use crate::chunk::Chunk;
use crate::error::EnvironmentError;
use crate::running::Look;
use crate::shared::SharedData;
use crate::start::Start;

/// Memory of the instances of a thread, which goes to it with a request and comes back with the reply.
#[derive(Debug)]
struct Block {
    actions: Vec<f32>,
    arrays: Arrays,
}

enum Request {
    Reset(Vec<Option<Start>>, Box<Block>),
    Step(Box<Block>),
    Look(usize, Look),
}

enum Reply {
    Done(Box<Block>, Result<(), EnvironmentError>),
    Looked(Result<(), EnvironmentError>),
}

/// A thread and its instances. The processes of a run cannot change their thread.
#[derive(Debug)]
pub struct Worker {
    /// Process that has the thread: a forked child has not.
    process: u32,
    range: Range<usize>,
    shape: Shape,
    block: Option<Box<Block>>,
    /// `None` while it ends.
    requests: Option<SyncSender<Request>>,
    replies: Receiver<Reply>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts a thread for the instances in `range`.
    pub fn start<B: Backend + 'static>(
        shared: &Arc<SharedData>,
        range: Range<usize>,
    ) -> Result<Self, EnvironmentError> {
        let shape = shared.shape.with_instances(range.len());
        let (requests, incoming) = sync_channel(1);
        let (outgoing, replies) = sync_channel(1);
        let (own, instances) = (Arc::clone(shared), range.clone());
        let thread = std::thread::Builder::new()
            .name("environments".to_owned())
            .spawn(move || serve(&mut Chunk::<B>::new(own, instances), &incoming, &outgoing))
            .map_err(|error| EnvironmentError::Thread(format!("cannot start: {error}")))?;
        let block = Block {
            actions: vec![0.0; shape.actions()],
            arrays: Arrays::new(shape),
        };
        Ok(Self {
            process: std::process::id(),
            range,
            shape,
            block: Some(Box::new(block)),
            requests: Some(requests),
            replies,
            thread: Some(thread),
        })
    }

    /// Returns the indices of its instances.
    pub fn range(&self) -> &Range<usize> {
        &self.range
    }

    /// Begins a reset with the starts of all instances; [`Self::finish`] waits for it.
    pub fn begin_reset(&mut self, starts: &[Option<Start>]) -> Result<(), EnvironmentError> {
        let block = self.take_block()?;
        let own = starts[self.range.clone()].to_vec();
        self.send(Request::Reset(own, block))
    }

    /// Begins a step with the actions of all instances; [`Self::finish`] waits for it.
    pub fn begin_step(&mut self, actions: &[f32]) -> Result<(), EnvironmentError> {
        let width = self.shape.with_instances(1).actions();
        let mut block = self.take_block()?;
        let own = &actions[self.range.start * width..self.range.end * width];
        block.actions.copy_from_slice(own);
        self.send(Request::Step(block))
    }

    /// Waits for the end of what has begun, and copies the results to those of all instances.
    pub fn finish(&mut self, arrays: &mut ArraysMut<'_>) -> Result<(), EnvironmentError> {
        let Ok(Reply::Done(block, result)) = self.replies.recv() else {
            return Err(lost());
        };
        arrays.copy_from(&self.range, &block.arrays, &self.shape);
        self.block = Some(block);
        result
    }

    /// Lets `look` see the running episode of an instance, by its index among all.
    pub fn look(&self, instance: usize, look: Look) -> Result<(), EnvironmentError> {
        self.check_process()?;
        self.send(Request::Look(instance, look))?;
        match self.replies.recv() {
            Ok(Reply::Looked(result)) => result,
            _ => Err(lost()),
        }
    }

    fn take_block(&mut self) -> Result<Box<Block>, EnvironmentError> {
        self.check_process()?;
        self.block.take().ok_or_else(lost)
    }

    fn check_process(&self) -> Result<(), EnvironmentError> {
        if self.process == std::process::id() {
            Ok(())
        } else {
            Err(EnvironmentError::OtherProcess)
        }
    }

    fn send(&self, request: Request) -> Result<(), EnvironmentError> {
        let requests = self.requests.as_ref().ok_or_else(lost)?;
        requests.send(request).map_err(|_| lost())
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // The thread ends when it can receive no more requests.
        self.requests = None;
        let thread = self.thread.take();
        if self.check_process().is_err() {
            // Its handle may be that of a thread of this process by now.
            core::mem::forget(thread);
        } else if let Some(thread) = thread {
            // A panic, which stderr shows, has been reported by the request that it ended.
            let _ = thread.join();
        }
    }
}

fn lost() -> EnvironmentError {
    EnvironmentError::Thread("ended unexpectedly".to_owned())
}

fn serve<B: Backend>(
    chunk: &mut Chunk<B>,
    requests: &Receiver<Request>,
    replies: &SyncSender<Reply>,
) {
    while let Ok(request) = requests.recv() {
        let reply = match request {
            Request::Reset(starts, mut block) => {
                let result = chunk.reset(&starts, &mut block.arrays.as_mut());
                Reply::Done(block, result)
            }
            Request::Step(mut block) => {
                let Block { actions, arrays } = &mut *block;
                let result = chunk.step(actions, &mut arrays.as_mut());
                Reply::Done(block, result)
            }
            Request::Look(instance, look) => Reply::Looked(chunk.look(instance, look)),
        };
        if replies.send(reply).is_err() {
            return;
        }
    }
}
