//! What cases run in: devices that are opened once and shared, the user's models, and faults to seed.

use std::cell::{Cell, OnceCell};
use std::fmt;
use std::str::FromStr;

use glob::Pattern;

use crate::conformance::bench::{Bench, Seen};
use crate::conformance::random::Random;
use crate::error::{Error, Result};
use crate::gpu::{ExtraFeatures, Slots, Workaround};
use crate::host::{Device, DeviceInfo, Instance, devices, unsuitable};
use crate::mesh::Model;

/// How the suite is run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Vulkan device: an index or a part of a name.
    pub device: Option<String>,
    /// Under the validation layer.
    pub validation: bool,
    /// With the workarounds for driver faults where our own surfaces are drawn. Raw draws never have them.
    pub workarounds: bool,
    /// Bytes of the scratch ring, where a case has no reason for another size.
    pub ring_bytes: u64,
    /// Who gives slots, likewise.
    pub slots: Slots,
    /// Where random numbers begin.
    pub seed: u64,
    /// A fault to seed, so that a test sees it caught.
    pub fault: Option<Fault>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            device: None,
            validation: false,
            workarounds: true,
            ring_bytes: 1 << 20,
            slots: Slots::Counter,
            seed: 0,
            fault: None,
        }
    }
}

/// A deliberate fault in some cases.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// The cases in which it does; `device` stands for the moment when the device is opened.
    pub cases: Pattern,
}

/// What goes wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// What is compared differs from what it should be: each group's file says how.
    Wrong,
    /// The process aborts.
    Crash,
    /// Our own code panics.
    Panic,
    /// The case never ends.
    Hang,
    /// Every second run fails.
    Flicker,
}

const FAULTS: [(&str, FaultKind); 5] = [
    ("wrong", FaultKind::Wrong),
    ("crash", FaultKind::Crash),
    ("panic", FaultKind::Panic),
    ("hang", FaultKind::Hang),
    ("flicker", FaultKind::Flicker),
];

impl FromStr for Fault {
    type Err = Error;

    /// Reads `KIND:GLOB`, such as `crash:scale.*`.
    fn from_str(text: &str) -> Result<Fault> {
        let read = || {
            let (kind, cases) = text.split_once(':')?;
            let (_, kind) = FAULTS.iter().find(|(name, _)| *name == kind)?;
            let cases = Pattern::new(cases).ok()?;
            Some(Fault { kind: *kind, cases })
        };
        read().ok_or_else(|| Error::Option {
            option: "--fault",
            problem: format!("'{text}' is no fault"),
            remedy: "write wrong, crash, panic, hang or flicker, then ':' and a pattern of cases"
                .into(),
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, _) = FAULTS
            .iter()
            .find(|(_, kind)| *kind == self.kind)
            .expect("every kind has a name");
        write!(f, "{name}:{}", self.cases)
    }
}

/// What a case runs in.
pub struct Context {
    /// How the suite is run.
    pub settings: Settings,
    /// The user's models by name; none when the suite runs on its own.
    pub models: Vec<(String, Model)>,
    instance: OnceCell<Instance>,
    bench: OnceCell<Bench>,
    robust_bench: OnceCell<Bench>,
    device: OnceCell<Device>,
    memory_model_device: OnceCell<Device>,
    full_device: OnceCell<Device>,
    wrong: Cell<bool>,
    seen: Seen,
}

impl Context {
    /// Vulkan is loaded, and devices are opened, when a case asks for one: what goes wrong meanwhile belongs to that case.
    pub fn new(settings: Settings, models: Vec<(String, Model)>) -> Context {
        Context {
            instance: OnceCell::new(),
            settings,
            models,
            bench: OnceCell::new(),
            robust_bench: OnceCell::new(),
            device: OnceCell::new(),
            memory_model_device: OnceCell::new(),
            full_device: OnceCell::new(),
            wrong: Cell::new(false),
            seen: Seen::default(),
        }
    }

    /// The device.
    pub fn device(&self) -> Result<&Device> {
        opened(&self.device, || self.open(ExtraFeatures::default()))
    }

    /// The device that is asked for and there, but lacks what every case needs.
    pub(super) fn unsuitable(&self) -> Result<Option<DeviceInfo>> {
        let instance = opened(&self.instance, || Instance::new(self.settings.validation))?;
        let asked = self.settings.device.as_deref();
        Ok(unsuitable(&devices(instance)?, asked))
    }

    /// The device with what our surfaces share.
    pub(super) fn bench(&self) -> Result<&Bench> {
        opened(&self.bench, || Bench::new(self.device()?, &self.seen))
    }

    /// The same with robust buffer access: on a logical device of its own.
    pub(super) fn robust_bench(&self) -> Result<&Bench> {
        opened(&self.robust_bench, || {
            let extra = ExtraFeatures {
                robust_buffer_access: true,
                ..Default::default()
            };
            Bench::new(&self.open(extra)?, &self.seen)
        })
    }

    /// The device with the Vulkan memory model: a logical device of its own.
    pub fn memory_model_device(&self) -> Result<&Device> {
        opened(&self.memory_model_device, || {
            self.open(ExtraFeatures {
                vulkan_memory_model: true,
                ..Default::default()
            })
        })
    }

    /// The device with all that it has, but for what changes how shaders run: a logical device of its own.
    pub fn full_device(&self) -> Result<&Device> {
        let extra = ExtraFeatures {
            robust_buffer_access: false,
            vulkan_memory_model: false,
            ..self.device()?.possible()?
        };
        opened(&self.full_device, || self.open(extra))
    }

    fn open(&self, extra: ExtraFeatures) -> Result<Device> {
        let instance = opened(&self.instance, || Instance::new(self.settings.validation))?;
        Device::open_with(instance, self.settings.device.as_deref(), extra)
    }

    /// The workarounds for our own surfaces.
    pub fn workarounds(&self) -> Result<Vec<&'static Workaround>> {
        if self.settings.workarounds {
            Ok(self.device()?.info().workarounds.clone())
        } else {
            Ok(Vec::new())
        }
    }

    /// Random numbers that depend on the seed and on `stream` alone.
    pub fn random(&self, stream: &str) -> Random {
        Random::new(self.settings.seed, stream)
    }

    /// Whether the case that runs shall compare with something wrong: each group's file says with what.
    pub fn is_wrong(&self) -> bool {
        self.wrong.get()
    }

    /// A mesh of the user's.
    ///
    /// # Errors
    /// When there is none of this name.
    pub(super) fn model(&self, name: &str) -> Result<&Model> {
        let found = self.models.iter().find(|(known, _)| known == name);
        let (_, model) = found.ok_or_else(|| Error::Refused(format!("there is no {name}")))?;
        Ok(model)
    }

    /// Counts what a case sees of what it drew. A case that sees nothing does not pass, see [`Case::run`](super::Case::run).
    pub(super) fn saw(&self, count: u64) {
        self.seen.set(self.seen.get() + count);
    }

    /// What was seen since this was asked last.
    pub(super) fn take_seen(&self) -> u64 {
        self.seen.take()
    }

    /// Every validation message so far.
    pub fn validation_messages(&self) -> Vec<String> {
        let instance = self.instance.get();
        instance.map_or_else(Vec::new, Instance::validation_messages)
    }

    /// Seeds the fault, if there is one for the case `name` that is about to run for the `run`-th time.
    pub(super) fn seed_fault(&self, name: &str, run: u32) {
        let fault = self.settings.fault.as_ref();
        let kind = fault
            .filter(|fault| fault.cases.matches(name))
            .map(|fault| fault.kind);
        self.wrong.set(match kind {
            Some(FaultKind::Wrong) => true,
            Some(FaultKind::Flicker) => run % 2 == 1,
            Some(FaultKind::Crash) => std::process::abort(),
            Some(FaultKind::Panic) => panic!("a fault was seeded in {name}"),
            Some(FaultKind::Hang) => loop {
                std::thread::park();
            },
            None => false,
        });
    }
}

fn opened<T>(cell: &OnceCell<T>, open: impl FnOnce() -> Result<T>) -> Result<&T> {
    if let Some(there) = cell.get() {
        return Ok(there);
    }
    let made = open()?;
    Ok(cell.get_or_init(|| made))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_read_back() {
        for text in ["wrong:*", "crash:a.b.*", "panic:y", "hang:x", "flicker:?"] {
            let fault: Fault = text.parse().expect(text);
            assert_eq!(fault.to_string(), text);
        }
        for text in ["", "wrong", "melt:*", "wrong:[", "wrong:***"] {
            assert!(text.parse::<Fault>().is_err(), "{text}");
        }
    }
}
