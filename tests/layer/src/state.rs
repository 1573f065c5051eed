//! What the layer knows of the process that it is in.

use std::collections::{BTreeMap, HashSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

use ash::vk;

use crate::report::Report;
use crate::{FAULT, Fault, Lost, REPORTS};

/// Calls that wait for the device. One that is to find it lost waits first all the same: then nothing runs any more, as on a lost device.
pub const WAITS: [&str; 4] = [
    "vkWaitForFences",
    "vkQueueWaitIdle",
    "vkDeviceWaitIdle",
    "vkGetFenceStatus",
];

/// Other calls that tell of a lost device (Vulkan spec, "Lost Device").
const TELL_LOSS: [&str; 2] = ["vkQueueSubmit", "vkGetQueryPoolResults"];

#[derive(Default)]
pub struct State {
    fault: Option<Fault>,
    fired: bool,
    lost: bool,
    /// Calls that count for the fault.
    counted: u32,
    calls: BTreeMap<&'static str, u32>,
    draws: u32,
    live: HashSet<(&'static str, u64)>,
    wrong: Vec<String>,
    /// Whether a submission may still run.
    pending: bool,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

/// What becomes of a draw.
pub enum Draw {
    Whole,
    Half,
    Nothing,
}

/// The state, for the caller alone.
pub fn with<T>(use_it: impl FnOnce(&mut State) -> T) -> T {
    let mut state: MutexGuard<'_, Option<State>> =
        STATE.lock().unwrap_or_else(PoisonError::into_inner);
    use_it(state.get_or_insert_with(State::default))
}

impl State {
    /// What goes wrong in this process.
    fn fault(&mut self) -> Fault {
        let read = || {
            let text = std::env::var(FAULT).unwrap_or_else(|_| "nothing".into());
            let fault = text.parse().expect("the test writes faults");
            match fault {
                Fault::Only(argument, fault) => {
                    let here = std::env::args_os().any(|word| word == *argument);
                    if here { *fault } else { Fault::Nothing }
                }
                fault => fault,
            }
        };
        self.fault.get_or_insert_with(read).clone()
    }

    /// Counts a call, and tells what it is to return if it is to fail.
    pub fn call(&mut self, name: &'static str) -> Option<vk::Result> {
        *self.calls.entry(name).or_default() += 1;
        let lost = vk::Result::ERROR_DEVICE_LOST;
        if self.lost && (WAITS.contains(&name) || TELL_LOSS.contains(&name)) {
            return Some(lost);
        }
        let Fault::Fail {
            calls,
            occurrence,
            code,
            lasting,
        } = self.fault()
        else {
            return None;
        };
        if !calls.iter().any(|call| call == name) {
            return None;
        }
        self.counted += 1;
        let fails = self.counted == occurrence || lasting && self.counted > occurrence;
        if !fails {
            return None;
        }
        self.lost |= lasting && code == lost;
        self.fire();
        Some(code)
    }

    /// Counts a draw, and tells how much of it is recorded.
    pub fn draw(&mut self) -> Draw {
        self.draws += 1;
        let draw = match self.fault() {
            Fault::Lose(Lost::All) => Draw::Nothing,
            Fault::Lose(Lost::One(number)) if number == self.draws => Draw::Nothing,
            Fault::Lose(Lost::Half(number)) if number == self.draws => Draw::Half,
            _ => return Draw::Whole,
        };
        self.fire();
        draw
    }

    /// Whether all formats of a display encode.
    pub fn encodes(&mut self) -> bool {
        let encodes = self.fault() == Fault::Encode;
        if encodes {
            self.fire();
        }
        encodes
    }

    fn fire(&mut self) {
        if !self.fired {
            self.fired = true;
            self.write();
        }
    }

    pub fn made(&mut self, kind: &'static str, handle: u64) {
        self.live.insert((kind, handle));
    }

    /// Of a null handle nothing happens, as in Vulkan.
    pub fn destroyed(&mut self, kind: &'static str, handle: u64) {
        if handle == 0 {
            return;
        }
        if !self.live.remove(&(kind, handle)) {
            self.wrong
                .push(format!("a {kind} was destroyed that is none"));
        }
        if self.pending {
            let wrong = format!("a {kind} was destroyed while a submission may use it");
            self.wrong.push(wrong);
        }
    }

    pub fn submitted(&mut self) {
        self.pending = true;
    }

    pub fn idle(&mut self) {
        self.pending = false;
    }

    /// A function is called that the layer does not know.
    pub fn unknown(&mut self, name: &str) {
        self.wrong
            .push(format!("{name} is called, which the layer does not know"));
        self.write();
    }

    /// Writes the report as things stand. It replaces the one before.
    pub fn write(&self) {
        let Some(folder) = std::env::var_os(REPORTS) else {
            return;
        };
        let mut left = BTreeMap::new();
        for (kind, _) in &self.live {
            *left.entry(kind.to_string()).or_default() += 1;
        }
        let calls = self
            .calls
            .iter()
            .map(|(name, &count)| (name.to_string(), count));
        let report = Report {
            fired: self.fired,
            calls: calls.collect(),
            draws: self.draws,
            left,
            wrong: self.wrong.clone(),
        };
        let path = std::path::Path::new(&folder).join(std::process::id().to_string());
        std::fs::write(path, report.to_string()).expect("reports can be written");
    }
}
