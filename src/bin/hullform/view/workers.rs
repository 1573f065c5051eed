//! Work that takes longer than a frame: done beside the window, which is woken when something is ready.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use hullform::{Error, Result};

/// What wakes the window.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Threads that each do one thing, and what they have done. `T` is what they bring; `S` is what they share, and get only as long as the window is there.
pub struct Workers<S, T> {
    shared: Arc<Mutex<Option<Arc<S>>>>,
    sender: Sender<T>,
    receiver: Receiver<T>,
    wake: Wake,
    running: Vec<Running>,
}

struct Running {
    thread: JoinHandle<()>,
    /// Whether it is waited for in the end.
    entered: Arc<AtomicBool>,
}

/// Where work gets what is shared. Work that only computes is left to itself when the window goes; from here on it is waited for.
pub struct Entrance<S> {
    shared: Arc<Mutex<Option<Arc<S>>>>,
    entered: Arc<AtomicBool>,
}

impl<S> Entrance<S> {
    /// What is shared. Whoever has it gives up nothing half-done: the window's end waits.
    ///
    /// # Errors
    /// The window has gone, and nobody wants what is worked on any more.
    pub fn enter(&self) -> Result<Arc<S>> {
        let shared = locked(&self.shared);
        // Under the lock: whoever closes the entrance sees all that have entered.
        self.entered.store(true, Ordering::Release);
        let gone = || Error::Refused("the window has gone".into());
        shared.clone().ok_or_else(gone)
    }
}

fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<S: Send + Sync + 'static, T: Send + 'static> Workers<S, T> {
    /// Nothing runs yet.
    pub fn new(shared: Arc<S>, wake: Wake) -> Workers<S, T> {
        let (sender, receiver) = channel();
        Workers {
            shared: Arc::new(Mutex::new(Some(shared))),
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
        work: impl FnOnce(&Entrance<S>) -> Result<R> + Send + 'static,
        told: impl FnOnce(Result<R>) -> T + Send + 'static,
    ) -> Result<()> {
        let (sender, wake) = (self.sender.clone(), self.wake.clone());
        let entrance = self.entrance();
        let entered = entrance.entered.clone();
        let started = spawn(name, move || {
            let work = || work(&entrance);
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
        self.remember(Running { thread, entered });
        Ok(())
    }

    /// Lets something go beside the window: to give much back takes time.
    pub fn let_go(&mut self, thing: impl Send + 'static) {
        let entered = Arc::new(AtomicBool::new(true));
        // Where there is no thread it goes at once.
        if let Ok(thread) = spawn("let go", move || drop(thing)) {
            self.remember(Running { thread, entered });
        }
    }

    fn entrance(&self) -> Entrance<S> {
        Entrance {
            shared: self.shared.clone(),
            entered: Arc::default(),
        }
    }

    fn remember(&mut self, running: Running) {
        self.running.retain(|other| !other.thread.is_finished());
        self.running.push(running);
    }

    /// What has been done since this was asked last.
    pub fn done(&mut self) -> Vec<T> {
        self.receiver.try_iter().collect()
    }

    /// Lets nobody enter any more, and waits until nobody runs who has, or patience has run out; whether nobody does.
    pub fn finish(&mut self, patience: Duration) -> bool {
        let started = Instant::now();
        locked(&self.shared).take();
        let waited_for = |running: &Running| {
            running.entered.load(Ordering::Acquire) && !running.thread.is_finished()
        };
        while self.running.iter().any(waited_for) {
            if started.elapsed() > patience {
                return false;
            }
            // What they bring may be great, and nobody takes it any more.
            drop(self.done());
            std::thread::sleep(Duration::from_millis(2));
        }
        true
    }
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> std::io::Result<JoinHandle<()>> {
    let thread = std::thread::Builder::new().name(name.into());
    thread.spawn(move || {
        stand_back();
        work();
    })
}

/// Has what computes in parallel stand back as well.
pub fn stand_back_in_parallel() {
    let pool = rayon::ThreadPoolBuilder::new().start_handler(|_| stand_back());
    // There may be a pool by now: then it stays as it is.
    let _ = pool.build_global();
}

/// From here on this thread gives way to others: to what draws, where software does that.
fn stand_back() {
    // By five steps, which leave it a third of the others' share.
    // SAFETY: no memory is involved. On Linux a priority is a thread's own (nice(2), "C library/kernel differences").
    #[cfg(target_os = "linux")]
    unsafe {
        // Where it may not be changed it stays.
        let _ = libc::nice(5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    const LONG: Duration = Duration::from_secs(20);

    fn workers() -> Workers<u32, Result<u32>> {
        Workers::new(Arc::new(5), Arc::new(|| {}))
    }

    #[test]
    fn work_that_breaks_down_is_told_like_any_failure() {
        let mut workers = workers();
        let broken = |_: &Entrance<u32>| -> Result<u32> {
            panic!("this panic is meant to be seen by a test")
        };
        workers
            .start("fails", broken, |result| result)
            .expect("a thread");
        workers
            .start("works", |entrance| Ok(*entrance.enter()?), |result| result)
            .expect("a thread");
        let (started, mut done) = (Instant::now(), Vec::new());
        while done.len() < 2 && started.elapsed() < LONG {
            done.extend(workers.done());
        }
        let good: Vec<u32> = done
            .iter()
            .filter_map(|r| r.as_ref().ok())
            .copied()
            .collect();
        assert_eq!((done.len(), good), (2, vec![5]));
    }

    #[test]
    fn in_the_end_those_who_have_entered_are_waited_for_and_nobody_enters_any_more() {
        let mut workers = workers();
        let (inside, is_inside) = mpsc::channel();
        let (go, may_go) = mpsc::channel::<()>();
        let user = move |entrance: &Entrance<u32>| {
            let shared = entrance.enter()?;
            inside.send(()).expect("the test waits");
            std::thread::sleep(Duration::from_millis(100));
            Ok(*shared)
        };
        let thinker = move |entrance: &Entrance<u32>| {
            may_go.recv().expect("the test says so");
            Ok(*entrance.enter()?)
        };
        let (told, hears) = mpsc::channel();
        workers
            .start("uses", user, |result| result)
            .expect("a thread");
        let tell = move |result: Result<u32>| {
            told.send(result.is_err()).expect("the test hears");
            result
        };
        workers.start("thinks", thinker, tell).expect("a thread");
        is_inside.recv().expect("it enters");
        let shared = Arc::downgrade(&locked(&workers.shared).clone().expect("it is open"));
        assert!(!workers.finish(Duration::ZERO), "one is inside");
        assert!(workers.finish(LONG), "the other is not waited for");
        assert!(shared.upgrade().is_none(), "and keeps nothing");
        go.send(()).expect("it waits");
        assert!(hears.recv().expect("it ends"), "it is not let in");
    }
}
