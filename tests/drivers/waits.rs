//! Waits that fail: what may still run is not destroyed, and a device of which nothing is known stays.

use ash::vk;
use failing_driver::Fault;

use crate::common::cli::has_device;
use crate::trial::{Bench, Program, program};

const RENDER: Program = program(
    "render",
    "render builtin:hull --size 64x48 --level 8 -o OUT/a.png",
);

/// `calls` fail for good, from the first on.
fn lasting(calls: &[&str], code: vk::Result) -> Fault {
    Fault::Fail {
        calls: calls.iter().map(|call| call.to_string()).collect(),
        occurrence: 1,
        code,
        lasting: true,
    }
}

#[test]
fn where_fences_cannot_be_waited_for_the_device_is() {
    if !has_device() {
        return;
    }
    let bench = Bench::new();
    for code in [
        vk::Result::ERROR_OUT_OF_HOST_MEMORY,
        vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
    ] {
        let outcome = bench.run(RENDER, &lasting(&["vkWaitForFences"], code));
        assert_eq!(outcome.code(), Some(1), "{}", outcome.describe());
        assert!(
            outcome
                .words()
                .contains("vkWaitForFences failed: ERROR_OUT_OF")
        );
        assert!(outcome.faults().is_empty(), "{}", outcome.describe());
        assert!(outcome.files.is_empty());
    }
}

#[test]
fn a_lost_device_is_destroyed_with_all_that_it_made() {
    if !has_device() {
        return;
    }
    let bench = Bench::new();
    for call in ["vkQueueSubmit", "vkWaitForFences"] {
        let lost = vk::Result::ERROR_DEVICE_LOST;
        let outcome = bench.run(RENDER, &lasting(&[call], lost));
        assert_eq!(outcome.code(), Some(1), "{}", outcome.describe());
        let words = format!("{call} failed: ERROR_DEVICE_LOST; try again");
        assert!(outcome.words().contains(&words), "{}", outcome.describe());
        assert!(outcome.faults().is_empty(), "{}", outcome.describe());
        assert!(outcome.files.is_empty());
    }
}

/// Nothing is known of what runs: then nothing that it may use is destroyed, and the device stays to the end of the process.
#[test]
fn a_device_of_which_nothing_is_known_stays() {
    if !has_device() {
        return;
    }
    let waits = [
        "vkWaitForFences",
        "vkDeviceWaitIdle",
        "vkQueueWaitIdle",
        "vkGetFenceStatus",
    ];
    let bench = Bench::new();
    let fault = lasting(&waits, vk::Result::ERROR_OUT_OF_HOST_MEMORY);
    let outcome = bench.run(RENDER, &fault);
    assert_eq!(outcome.code(), Some(1), "{}", outcome.describe());
    assert!(
        outcome
            .words()
            .contains("vkWaitForFences failed: ERROR_OUT_OF_HOST_MEMORY")
    );
    assert!(outcome.files.is_empty());
    let [report] = &outcome.reports[..] else {
        panic!("one process: {}", outcome.describe());
    };
    assert!(report.wrong.is_empty(), "{}", outcome.describe());
    assert_eq!(
        report.left.get("Device"),
        Some(&1),
        "{}",
        outcome.describe()
    );
}
