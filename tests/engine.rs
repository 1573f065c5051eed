//! The example that is an engine of its own: its picture, what it computes and holds, and the validation layer's silence.
#![cfg(feature = "cli")]

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;

use hullform::host::Instance;

const UPDATE: &str = "HULLFORM_UPDATE";

/// Where cargo puts examples; None, with a line that says so, where it is not built, as with `cargo test --test engine`, or there is nothing
/// to validate with.
fn engine() -> Option<PathBuf> {
    let test = std::env::current_exe().expect("a test is a file");
    let profile = test.parent()?.parent()?;
    let name = format!("engine{}", std::env::consts::EXE_SUFFIX);
    let path = profile.join("examples").join(name);
    if !path.is_file() {
        println!("skipped: {} is not built", path.display());
        return None;
    }
    if let Err(error) = Instance::new(true) {
        println!("skipped: {error}");
        return None;
    }
    Some(path)
}

/// What it prints, under core and synchronization validation, which print to the same place; the picture lies at `picture` then.
fn run(engine: &Path, picture: &Path, arguments: &[&Path]) -> String {
    let output = Command::new(engine)
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .env(
            "VK_LAYER_ENABLES",
            "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT",
        )
        .arg("-o")
        .arg(picture)
        .args(arguments)
        .output();
    let output = output.expect("it starts");
    let [out, errors] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success(), "{out}{errors}");
    for word in ["VUID", "SYNC-HAZARD", "Validation", "ERROR"] {
        assert!(
            !out.contains(word) && !errors.contains(word),
            "{out}{errors}"
        );
    }
    out.into_owned()
}

/// The number before some words in a line that has other words.
fn number(text: &str, line: &str, words: &str) -> f64 {
    let line = text.lines().find(|text| text.contains(line));
    let line = line.unwrap_or_else(|| panic!("no line has {words}: {text}"));
    let before = line.split(words).next().unwrap_or_default();
    let number = before.rsplit([' ', ',']).find(|word| !word.is_empty());
    let number = number.and_then(|number| number.parse().ok());
    number.unwrap_or_else(|| panic!("no number before {words}: {line}"))
}

fn read(path: &Path) -> (u32, Vec<u8>) {
    let file = std::fs::File::open(path).expect("the picture is there");
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().expect("a PNG file");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    (info.width, bytes)
}

/// Control points in the first frame, none in a second that shows the same moment, then those of the skinned model alone; and the README's picture.
#[test]
fn a_static_frame_computes_nothing_and_the_picture_is_the_readmes() {
    let Some(engine) = engine() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("engine.png");
    let out = run(&engine, &picture, &[]);
    let points = |frame: &str| number(&out, frame, " control points");
    let [first, second, third] = ["frame 0:", "frame 1:", "frame 2:"].map(points);
    assert!(first > 10.0 * third && third > 1000.0, "{first} {third}");
    assert_eq!(second, 0.0);
    // Thirty instances in three passes: four levels at most, and the batches of a driver that bounds what an instance has.
    let draws = number(&out, "frame 2:", " draws a model");
    assert!(draws <= 24.0, "{draws}");
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/engine.png");
    if std::env::var_os(UPDATE).is_some() {
        std::fs::copy(&picture, &reference).expect("the reference can be written");
    }
    let ((width, own), (right_width, right)) = (read(&picture), read(&reference));
    assert_eq!((width, own.len()), (right_width, right.len()));
    let off: f64 = own
        .iter()
        .zip(&right)
        .map(|(a, b)| f64::from(a.abs_diff(*b)))
        .sum();
    let mean = off / own.len() as f64;
    assert!(mean < 2.0, "{mean}: if the new one is right, set {UPDATE}");
}

/// Thirty instances of the three shared models, at two frames in flight.
#[test]
fn three_models_take_no_more_than_60_mb() {
    let Some(engine) = engine() else { return };
    let files = common::obj_files("models");
    let named = |name: &str| {
        let mut files = files.iter();
        files.find(|file| common::stem(file) == name)
    };
    let names = ["bigguy", "monsterfrog", "armorguy"];
    let Some(models) = names.into_iter().map(named).collect::<Option<Vec<_>>>() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let frames = [Path::new("--frames"), Path::new("2")];
    let arguments: Vec<&Path> = frames
        .into_iter()
        .chain(models.into_iter().map(PathBuf::as_path))
        .collect();
    let out = run(&engine, &folder.path().join("engine.png"), &arguments);
    let mega = number(&out, "by sum", " MB of device memory by sum");
    assert!(mega <= 60.0, "{mega}");
    assert_eq!(number(&out, "frame 1:", " control points"), 0.0);
}
