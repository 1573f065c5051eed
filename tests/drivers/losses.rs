//! Draws that get lost without a word from the driver: all of them, one, or half of one.

use failing_driver::{Fault, Lost};

use crate::common::cli::has_device;
use crate::trial::{Bench, Program, example, is_there, program};

const PROGRAMS: [Program; 12] = [
    program(
        "tessellate",
        "tessellate builtin:cube --level 4 -o OUT/a.obj",
    ),
    program(
        "tessellate in batches",
        "tessellate builtin:ngons --level 4 --ring-bytes 8KiB -o OUT/a.csv",
    ),
    program(
        "render",
        "render builtin:cube --size 32x24 --level 4 -o OUT/a.png --stats OUT/a.json",
    ),
    program(
        "render in batches",
        "render builtin:ngons --size 32x24 --level 4 --ring-bytes 8KiB -o OUT/a.png",
    ),
    program(
        "render with lines",
        "render builtin:cube --size 32x24 --level 3 --method flat --wireframe --shading patch -o OUT/a.png",
    ),
    program(
        "render by patterns",
        "render builtin:cube --size 32x24 --level 4 --method pn --backend pattern -o OUT/a.png",
    ),
    program(
        "render by geometry shaders",
        "render builtin:cube --size 32x24 --level 4 --method pn --backend geometry -o OUT/a.png",
    ),
    program(
        "compare",
        "compare builtin:cube --size 32x24 --level 4 --methods flat,phong --costs 1 -o OUT/a.png",
    ),
    program(
        "compare by patterns",
        "compare builtin:cube --size 32x24 --level 4 --methods flat --backend pattern --costs 2 -o OUT/a.png",
    ),
    program(
        "bench",
        "bench builtin:cube --levels 2 --methods pn --frames 1 --csv OUT/a.csv",
    ),
    program(
        "bench by patterns",
        "bench builtin:cube --levels 2 --methods pn --backend pattern --frames 1 --csv OUT/a.csv",
    ),
    example("headless_png", ""),
];

#[test]
fn what_was_predicted_and_did_not_arrive_is_a_failure() {
    if !has_device() {
        return;
    }
    let bench = Bench::new();
    for program in PROGRAMS.into_iter().filter(|&program| is_there(program)) {
        let sound = bench.run(program, &Fault::Nothing);
        assert_eq!(
            sound.code(),
            Some(0),
            "{}: {}",
            program.name,
            sound.describe()
        );
        assert!(!sound.files.is_empty(), "{}", program.name);
        let draws = sound.reports[0].draws;
        assert!(draws > 0, "{}: something is drawn", program.name);
        let all: Vec<u32> = (1..=draws).collect();
        let some = match draws {
            ..=6 => all,
            _ => vec![1, draws.div_ceil(2), draws],
        };
        let losses = some
            .into_iter()
            .flat_map(|draw| [Lost::One(draw), Lost::Half(draw)]);
        for lost in losses.chain([Lost::All]) {
            let outcome = bench.run(program, &Fault::Lose(lost));
            let words = || {
                format!(
                    "{}, {lost:?} of {draws}: {}",
                    program.name,
                    outcome.describe()
                )
            };
            assert!(outcome.fired(), "{}", words());
            assert_eq!(outcome.code(), Some(1), "{}", words());
            assert!(outcome.words().contains("the device lost "), "{}", words());
            assert!(outcome.files.is_empty(), "{}", words());
            assert!(outcome.faults().is_empty(), "{}", words());
        }
    }
}

/// Nothing is missing of what has no surface.
#[test]
fn a_model_without_a_surface_is_no_loss() {
    if !has_device() {
        return;
    }
    let bench = Bench::new();
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("hole.obj");
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt hole 1/0/0 0\n";
    std::fs::write(&model, text).expect("a file");
    let model = model.to_str().expect("a plain path");
    let commands = [
        format!("tessellate {model} -o OUT/a.csv"),
        format!("render {model} --size 32x24 -o OUT/a.png"),
    ];
    for arguments in commands {
        let program = program("hole", arguments.leak());
        let outcome = bench.run(program, &Fault::Lose(Lost::All));
        assert_eq!(outcome.code(), Some(0), "{}", outcome.describe());
        assert_eq!(outcome.files.len(), 1, "{}", outcome.describe());
    }
}

/// Parts of the suite, one or more of each group. Without draws everything that is compared is missing, and seems to agree.
const PARTS: [&str; 14] = [
    "coordinates.quads-equal.*",
    "coordinates.triangles-fractional_even.*",
    "limit.valence.boundary-[1-3]",
    "witness.*.polygon_7",
    "witness.[pw]*.quad*",
    "edges.kind.b*-equal",
    "edges.picture-displaced.ball-equal",
    "backends.*.*-pn-loop-cube*",
    "scale.*.draw-1025_patches-*",
    "visibility.coherent.*",
    "determinism.*.ngons-equal",
    "statistics.*.cube-equal",
    "robustness.[dei]*",
    "robustness.corrupted.weights-ngons",
];

#[test]
fn no_case_of_the_suite_passes_that_saw_nothing() {
    if !has_device() {
        return;
    }
    let bench = Bench::new();
    for part in PARTS {
        let arguments = format!("verify --filter {part} --csv OUT/a.csv");
        let outcome = bench.run(program(part, arguments.leak()), &Fault::Lose(Lost::All));
        assert_eq!(outcome.code(), Some(1), "{part}: {}", outcome.describe());
        let [(_, results)] = &outcome.files[..] else {
            panic!("{part}: {}", outcome.describe());
        };
        let results = String::from_utf8_lossy(results);
        assert!(results.lines().count() > 0, "{part}");
        for line in results.lines() {
            let status = line.split(',').nth(1);
            let saw_nothing = ["Fail", "ExpectedFail", "Skip"].map(Some).contains(&status);
            assert!(saw_nothing, "{line}: {}", outcome.words());
        }
    }
}
