//! Every call that can fail, failing in turn: no crash, no leak, the right exit code, words that name the call, and nothing half-written.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use ash::vk;
use failing_driver::Fault;

use crate::common::cli::has_device;
use crate::trial::{Bench, Outcome, Program, What, example, is_there, program, test};
use crate::way;

/// What calls return.
const CODES: [vk::Result; 3] = [
    vk::Result::ERROR_OUT_OF_HOST_MEMORY,
    vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
    vk::Result::ERROR_DEVICE_LOST,
];

/// Calls without which there is no device: exit code 3.
const NO_DEVICE: [&str; 7] = [
    "vkEnumerateInstanceVersion",
    "vkEnumerateInstanceExtensionProperties",
    "vkEnumerateInstanceLayerProperties",
    "vkCreateInstance",
    "vkEnumeratePhysicalDevices",
    "vkEnumerateDeviceExtensionProperties",
    "vkCreateDevice",
];

/// Set to a part of programs' names, every occurrence of every call of these fails with every code, and not a sample, under validation: "e" is in all. Takes hours.
pub const EVERY: &str = "HULLFORM_EVERY_FAILURE";

/// Programs that take long: of these only the calls are sampled that no program before makes.
const LONG: [&str; 4] = [
    "render by the device's levels",
    "bench of a cache",
    "verify caches",
    "edges",
];

/// Every way that the program and the examples have to Vulkan, with little to draw.
const PROGRAMS: [Program; 16] = [
    program("devices", "devices --device 0"),
    program(
        "render",
        "render builtin:cube --size 32x24 --level 4 --method flat --wireframe -o OUT/a.png --stats OUT/a.json",
    ),
    program(
        "render by patterns",
        "render builtin:cube --size 32x24 --level 4 --method pn --backend pattern --points device -o OUT/a.png",
    ),
    program(
        "render from a cache",
        "render builtin:cube --size 32x24 --level 4 --residence cache -o OUT/a.png",
    ),
    program(
        "tessellate",
        "tessellate builtin:cube --level 4 --method flat -o OUT/a.csv",
    ),
    program(
        "tessellate in batches",
        "tessellate builtin:cube --level 4 --ring-bytes 4KiB --slots host -o OUT/a.ply",
    ),
    program(
        "compare",
        "compare builtin:cube --size 32x24 --level 4 --methods flat,phong --costs 1 -o OUT/a.png",
    ),
    program(
        "bench",
        "bench builtin:cube --levels 2 --methods phong --frames 1 --json OUT/a.json --csv OUT/a.csv --plot OUT/a.svg",
    ),
    program(
        "verify",
        "verify --jobs 1 --filter coordinates.isolines-equal.counts --csv OUT/a.csv",
    ),
    program(
        "verify caches",
        "verify --jobs 1 --filter determinism.cache.pole-64-equal --csv OUT/a.csv",
    ),
    example("headless_png", ""),
    program(
        "render by the device's levels",
        "render builtin:cube --size 32x24 --adaptive screen:8 --cull all -o OUT/a.png",
    ),
    program(
        "bench of a cache",
        "bench builtin:cube --levels 2 --methods quadtree --residence cache --static --passes 2 --instances 2 --frames 1 --csv OUT/a.csv",
    ),
    test(way::NAME),
    example("engine", "--frames 2 -o OUT/a.png"),
    example("edges", "--levels 1 cube"),
];

/// A failure to be tried.
struct Trial {
    program: Program,
    call: String,
    occurrence: u32,
    code: vk::Result,
}

/// What a program does on a sound driver.
struct Sound {
    calls: BTreeMap<String, u32>,
    files: Vec<(String, Vec<u8>)>,
}

#[test]
fn every_call_that_fails_is_an_error_and_no_crash() {
    if !has_device() {
        return;
    }
    let part = std::env::var(EVERY).ok();
    let every = part.is_some();
    let part = part.unwrap_or_default();
    let bench = Bench::validating(every);
    let mut trials = Vec::new();
    let mut sound = BTreeMap::new();
    let wanted = |program: &Program| program.name.contains(&part) && is_there(*program);
    for program in PROGRAMS.into_iter().filter(wanted) {
        let outcome = bench.run(program, &Fault::Nothing);
        assert_eq!(
            outcome.code(),
            Some(0),
            "{}: {}",
            program.name,
            outcome.describe()
        );
        assert_eq!(outcome.faults(), [""; 0], "{}", program.name);
        assert!(!complains(&outcome), "{}", outcome.describe());
        assert!(
            !outcome.reports.is_empty(),
            "{}: the layer was there",
            program.name
        );
        let mut calls = BTreeMap::new();
        for (call, count) in outcome.reports.iter().flat_map(|report| &report.calls) {
            let most = calls.entry(call.clone()).or_default();
            *most = (*count).max(*most);
        }
        for (number, (call, &count)) in calls.iter().enumerate() {
            let known = sound
                .values()
                .any(|sound: &Sound| sound.calls.contains_key(call));
            if every || !known || !LONG.contains(&program.name) {
                trials.extend(sample(program, call, count, number, every));
            }
        }
        let files = outcome.files;
        sound.insert(program.name, Sound { calls, files });
    }
    let failures = try_all(&trials, &sound, every);
    println!("{} failures of {} programs", trials.len(), sound.len());
    for program in sound.keys() {
        let own = trials.iter().filter(|trial| trial.program.name == *program);
        println!(
            "  {program}: {} of {} calls",
            own.count(),
            sound[program].calls.len()
        );
    }
    assert!(
        failures.is_empty(),
        "{} of {} went wrong:\n{}",
        failures.len(),
        trials.len(),
        failures.join("\n")
    );
}

/// The first and the last occurrence with one code each, that of the first changing from call to call; or all.
fn sample(program: Program, call: &str, count: u32, number: usize, every: bool) -> Vec<Trial> {
    let trial = |occurrence, code| Trial {
        program,
        call: call.to_owned(),
        occurrence,
        code,
    };
    if every {
        let occurrences =
            (1..=count).flat_map(|occurrence| CODES.map(|code| trial(occurrence, code)));
        return occurrences.collect();
    }
    let mut sample = vec![trial(1, CODES[number % 3])];
    if count > 1 {
        sample.push(trial(count, CODES[(number + 1) % 3]));
    }
    sample
}

/// Tries all, two at a time, and returns what went wrong.
fn try_all(trials: &[Trial], sound: &BTreeMap<&str, Sound>, validates: bool) -> Vec<String> {
    let next = AtomicUsize::new(0);
    let failures = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let bench = Bench::validating(validates);
                while let Some(trial) = trials.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let fault = Fault::once(&trial.call, trial.occurrence, trial.code);
                    let outcome = bench.run(trial.program, &fault);
                    let wrong = judge(trial, &outcome, &sound[trial.program.name]);
                    let Trial {
                        program,
                        call,
                        occurrence,
                        code,
                    } = trial;
                    let words = wrong.into_iter().map(|wrong| {
                        format!(
                            "{}, {call} {occurrence}, {code:?}: {wrong}: {}",
                            program.name,
                            outcome.describe()
                        )
                    });
                    let words = words.inspect(|words| println!("{words}"));
                    failures.lock().expect("nobody panics").extend(words);
                }
            });
        }
    });
    failures.into_inner().expect("nobody panicked")
}

pub fn complains(outcome: &Outcome) -> bool {
    let words = outcome.words();
    ["VUID-", "SYNC-HAZARD", "UNASSIGNED-"]
        .iter()
        .any(|word| words.contains(word))
}

/// What is wrong about how a program took a failure.
fn judge(trial: &Trial, outcome: &Outcome, sound: &Sound) -> Vec<&'static str> {
    let mut wrong = Vec::new();
    let mut hold = |holds: bool, what| {
        if !holds {
            wrong.push(what);
        }
    };
    hold(outcome.fired(), "the call was never made");
    hold(
        outcome.faults().is_empty(),
        "objects were left or destroyed too early",
    );
    hold(!outcome.words().contains("panicked"), "it panicked");
    hold(!complains(outcome), "the validation layer has words");
    // The allocator asks for other memory where there is none of the best.
    let may_recover = trial.call == "vkAllocateMemory";
    if may_recover && outcome.code() == Some(0) {
        hold(outcome.files == sound.files, "it did not notice");
        return wrong;
    }
    let hullform = trial.program.what == What::Hullform;
    let no_device = NO_DEVICE.contains(&&*trial.call) && hullform;
    hold(
        outcome.code() == Some(if no_device { 3 } else { 1 }),
        "the exit code",
    );
    // The loader makes this call too, while it creates the device.
    let by_loader = trial.call == "vkEnumerateDeviceExtensionProperties";
    let named = |call: &str| outcome.words().contains(&format!("{call} failed: "));
    let is_named = named(&trial.call) || by_loader && named("vkCreateDevice");
    hold(is_named, "the call is not named");
    // What a suite found out is written whatever that is.
    let may_write = trial.program.name.starts_with("verify") && !no_device;
    hold(
        outcome.files.is_empty() || may_write,
        "something was written",
    );
    wrong
}
