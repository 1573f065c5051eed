//! Work that takes longer than a frame: done beside the window, which is woken when something is ready.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use hullform::{Error, Result};

/// What wakes the window.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Threads that each do one thing, and what they have done. `T` is what they bring.
pub struct Workers<T> {
    sender: Sender<T>,
    receiver: Receiver<T>,
    wake: Wake,
    running: Vec<JoinHandle<()>>,
}

impl<T: Send + 'static> Workers<T> {
    /// Nothing runs yet.
    pub fn new(wake: Wake) -> Workers<T> {
        let (sender, receiver) = channel();
        Workers {
            sender,
            receiver,
            wake,
            running: Vec::new(),
        }
    }

    /// Does work beside the window; `told` makes what is brought of it, also where it failed or broke down.
    pub fn start<R: 'static>(
        &mut self,
        name: &str,
        work: impl FnOnce() -> Result<R> + Send + 'static,
        told: impl FnOnce(Result<R>) -> T + Send + 'static,
    ) -> Result<()> {
        let (sender, wake) = (self.sender.clone(), self.wake.clone());
        let thread = std::thread::Builder::new().name(name.into());
        let started = thread.spawn(move || {
            let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
                let words = "a worker broke down, which is a fault of hullform; report it with the model and what was done";
                Err(Error::Refused(words.into()))
            });
            // Nobody listens any more once the window has gone.
            let _ = sender.send(told(result));
            wake();
        });
        let thread = started.map_err(|error| {
            Error::Refused(format!(
                "no thread could be started ({error}); close other programs"
            ))
        })?;
        self.running.retain(|thread| !thread.is_finished());
        self.running.push(thread);
        Ok(())
    }

    /// What has been done since this was asked last.
    pub fn done(&mut self) -> Vec<T> {
        self.receiver.try_iter().collect()
    }

    /// Waits until nothing runs any more, or patience has run out; whether nothing does.
    pub fn finish(&mut self, patience: Duration) -> bool {
        let started = Instant::now();
        while started.elapsed() < patience {
            self.running.retain(|thread| !thread.is_finished());
            if self.running.is_empty() {
                return true;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_that_breaks_down_is_told_like_any_failure() {
        let mut workers = Workers::<Result<u32>>::new(Arc::new(|| {}));
        let broken = || -> Result<u32> { panic!("this panic is meant to be seen by a test") };
        workers
            .start("fails", broken, |result| result)
            .expect("a thread");
        workers
            .start("works", || Ok(5), |result| result)
            .expect("a thread");
        assert!(workers.finish(Duration::from_secs(20)));
        let done = workers.done();
        let good: Vec<u32> = done
            .iter()
            .filter_map(|r| r.as_ref().ok())
            .copied()
            .collect();
        assert_eq!((done.len(), good), (2, vec![5]));
    }
}
