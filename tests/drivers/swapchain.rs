//! Calls about windows that fail: what tells that a window has changed is followed, and everything else ends with an error that names the call.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use ash::vk::Result as Code;
use failing_driver::Fault;

use crate::common::cli::has_device;
use crate::display::Display;
use crate::failures::{EVERY, complains};
use crate::trial::{Bench, Outcome, Program, example, is_there};

/// What part of it says that all failures are tried.
const NAME: &str = "the window";

/// Six frames in a window.
const WINDOW: Program = example("window", "6");

/// The only calls that tell that a window has changed, and what they tell so with.
const TELL: [&str; 2] = ["vkAcquireNextImageKHR", "vkQueuePresentKHR"];
const CHANGED: [Code; 2] = [Code::ERROR_OUT_OF_DATE_KHR, Code::SUBOPTIMAL_KHR];

const NO_MEMORY: [Code; 2] = [
    Code::ERROR_OUT_OF_HOST_MEMORY,
    Code::ERROR_OUT_OF_DEVICE_MEMORY,
];

/// What else calls may return (Vulkan spec, "WSI Swapchain").
fn codes(call: &str) -> Vec<Code> {
    let lost: &[Code] = match call {
        "vkCreateSwapchainKHR" => &[
            Code::ERROR_DEVICE_LOST,
            Code::ERROR_SURFACE_LOST_KHR,
            Code::ERROR_NATIVE_WINDOW_IN_USE_KHR,
            Code::ERROR_INITIALIZATION_FAILED,
        ],
        call if TELL.contains(&call) => &[
            Code::ERROR_OUT_OF_DATE_KHR,
            Code::SUBOPTIMAL_KHR,
            Code::ERROR_SURFACE_LOST_KHR,
            Code::ERROR_DEVICE_LOST,
        ],
        call if call.starts_with("vkGetPhysicalDeviceSurface") => &[Code::ERROR_SURFACE_LOST_KHR],
        call if is_of_windows(call) => &[],
        _ => &[Code::ERROR_DEVICE_LOST],
    };
    [lost, &NO_MEMORY].concat()
}

fn is_of_windows(call: &str) -> bool {
    call.ends_with("KHR")
}

/// Which of these are tried: every call's first ones; or, as a sample, of calls about windows one code each, and all of what tells that a window has changed.
fn trials(calls: &BTreeMap<String, u32>, every: bool) -> Vec<(&str, u32, Code)> {
    let mut trials = Vec::new();
    for (number, (call, &count)) in calls.iter().enumerate() {
        let codes = codes(call);
        if every {
            for occurrence in 1..=count.min(3) {
                trials.extend(codes.iter().map(|&code| (call.as_str(), occurrence, code)));
            }
        } else if TELL.contains(&call.as_str()) {
            trials.extend(codes[..3].iter().map(|&code| (call.as_str(), 2, code)));
        } else if is_of_windows(call) {
            trials.push((call, 1, codes[number % codes.len()]));
        }
    }
    trials
}

/// What is wrong about how the window took a failure.
fn judge((call, _, code): (&str, u32, Code), outcome: &Outcome) -> Vec<&'static str> {
    let words = outcome.words();
    let follows = TELL.contains(&call) && CHANGED.contains(&code);
    // The allocator asks for other memory where there is none of the best; and at the end of all one wait stands in for another.
    let may_recover = ["vkAllocateMemory", "vkQueueWaitIdle", "vkWaitForFences"];
    let recovers = may_recover.contains(&call) && outcome.code() == Some(0);
    let ends_well = follows || recovers;
    // Which call that is on which system is the business of the library that makes it; and the loader makes another by itself.
    let named = match call {
        "vkCreateXlibSurfaceKHR" => words.contains("no surface for the window"),
        "vkEnumerateDeviceExtensionProperties" if words.contains("vkCreateDevice failed") => true,
        call => words.contains(&format!("{call} failed: {code:?}")),
    };
    let rules = [
        (outcome.fired(), "the call was never made"),
        (
            outcome.faults().is_empty(),
            "objects were left or destroyed too early",
        ),
        (!words.contains("panicked"), "it panicked"),
        (!complains(outcome), "the validation layer has words"),
        (
            outcome.code() == Some(if ends_well { 0 } else { 1 }),
            "the exit code",
        ),
        (ends_well || named, "the call is not named"),
    ];
    let broken = rules.into_iter().filter(|(holds, _)| !holds);
    broken.map(|(_, what)| what).collect()
}

#[test]
fn a_window_follows_its_changes_and_every_other_failure_is_an_error() {
    let part = std::env::var(EVERY).ok();
    if part.as_ref().is_some_and(|part| !NAME.contains(part)) {
        return;
    }
    let every = part.is_some();
    if !has_device() || !is_there(WINDOW) {
        return;
    }
    let Some(display) = Display::start() else {
        assert!(std::env::var_os("CI").is_none(), "Xvfb is missing");
        println!("skipped: Xvfb is not installed (scripts/setup does it)");
        return;
    };
    let bench = || Bench::validating(every).shown_on(&display.name);
    let sound = bench().run(WINDOW, &Fault::Nothing);
    assert_eq!(sound.code(), Some(0), "{}", sound.describe());
    assert!(sound.faults().is_empty() && !complains(&sound));
    let calls = &sound.reports.first().expect("the layer was there").calls;
    let trials = trials(calls, every);
    let (next, failures) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let bench = bench();
                while let Some(&trial) = trials.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let (call, occurrence, code) = trial;
                    let outcome = bench.run(WINDOW, &Fault::once(call, occurrence, code));
                    for wrong in judge(trial, &outcome) {
                        let what = format!("{call} {occurrence}, {code:?}: {wrong}");
                        println!("{what}");
                        let all = format!("{what}: {}", outcome.describe());
                        failures.lock().expect("nobody panics").push(all);
                    }
                }
            });
        }
    });
    let failures = failures.into_inner().expect("nobody panicked");
    println!("{} failures of {} calls", trials.len(), calls.len());
    assert!(trials.len() >= 12, "{trials:?}");
    assert!(
        failures.is_empty(),
        "{} of {} went wrong:\n{}",
        failures.len(),
        trials.len(),
        failures.join("\n")
    );
}
