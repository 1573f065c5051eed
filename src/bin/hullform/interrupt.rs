//! What the signals INT, TERM and HUP do: nothing half-written stays, and the process ends by the signal, so that whoever started it sees which.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the next signal does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Duty {
    /// Ends the process.
    End,
    /// Asks for an end, and is remembered.
    Ask,
    /// Nothing: a worker's life hangs on its runner's pipe.
    Ignore,
}

/// The duty, and the signal that asked for an end.
static STATE: Mutex<(Duty, Option<i32>)> = Mutex::new((Duty::End, None));

/// Set when a signal asks for an end.
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on signals end the process without remains. Those that are ignored, as under `nohup`, stay so.
#[cfg(unix)]
pub fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let heard = [SIGINT, SIGTERM, SIGHUP];
    let heard = heard.into_iter().filter(|&signal| !is_ignored(signal));
    // Without the thread signals do what they always did.
    if let Ok(mut signals) = signal_hook::iterator::Signals::new(heard) {
        std::thread::spawn(move || signals.forever().for_each(hear));
    }
}

/// Other systems end a process in their own way.
#[cfg(not(unix))]
pub fn listen() {}

#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: with no new action this only writes the present one; zeros are a value of the type if it fails.
    let action = unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr());
        action.assume_init()
    };
    action.sa_sigaction == libc::SIG_IGN
}

#[cfg(unix)]
fn hear(signal: i32) {
    let mut state = state();
    match *state {
        (Duty::Ignore, _) => {}
        (Duty::Ask, None) => {
            state.1 = Some(signal);
            ASKED.store(true, Ordering::Relaxed);
        }
        _ => end(signal),
    }
}

/// Removes what is half-written and ends the process by the signal.
#[cfg(unix)]
fn end(signal: i32) -> ! {
    let _nothing_new = crate::output::remove_unfinished();
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    std::process::exit(128 + signal)
}

#[cfg(not(unix))]
fn end(_: i32) -> ! {
    unreachable!("no signal is heard")
}

fn state() -> std::sync::MutexGuard<'static, (Duty, Option<i32>)> {
    // Nobody panics with it.
    STATE.lock().unwrap_or_else(|poison| poison.into_inner())
}

/// Lets signals pass, for good.
pub fn ignore() {
    state().0 = Duty::Ignore;
}

/// While this lives, the first signal only asks for an end; the second one ends the process.
pub struct Asking(());

/// Begins to take a signal for a question.
pub fn ask() -> Asking {
    state().0 = Duty::Ask;
    Asking(())
}

impl Asking {
    /// Whether an end is asked for.
    pub fn asked(&self) -> &'static AtomicBool {
        &ASKED
    }

    /// Ends the process by the signal that asked for it, if one did.
    pub fn answer(self) {
        let caught = state().1;
        if let Some(signal) = caught {
            end(signal);
        }
    }
}

impl Drop for Asking {
    fn drop(&mut self) {
        state().0 = Duty::End;
    }
}
