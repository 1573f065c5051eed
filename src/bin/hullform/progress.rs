//! A bar on stderr for what takes more than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

const PATIENCE: Duration = Duration::from_secs(1);
const TICK: Duration = Duration::from_millis(100);

/// Does `work`, telling `what` is done once it has taken a second. The work may set a length and advance the bar.
pub fn during<T>(what: &'static str, work: impl FnOnce(&ProgressBar) -> T) -> T {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    bar.set_style(ProgressStyle::default_spinner());
    bar.set_message(what);
    let (working, done) = mpsc::channel::<()>();
    let result = thread::scope(|scope| {
        scope.spawn(|| show_later(&bar, done));
        // Moved in here, so that a panic in the work releases the thread above as well.
        let _working = working;
        work(&bar)
    });
    bar.finish_and_clear();
    result
}

/// Shows the bar unless `done` hangs up within a second.
fn show_later(bar: &ProgressBar, done: mpsc::Receiver<()>) {
    if done.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
        // Draws only if stderr is a terminal.
        bar.set_draw_target(ProgressDrawTarget::stderr());
        bar.enable_steady_tick(TICK);
    }
}
