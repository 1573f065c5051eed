//! Pictures of the built-in shapes against references.
//!
//! `HULLFORM_UPDATE=1 cargo test --test pictures` makes the references anew. Look at them before you commit them.
#![cfg(feature = "cli")]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Command;

use hullform::mesh::{Model, Scheme, Triangulation, builtin, triangulated};
use hullform::method::{METHODS, Method};
use hullform::tessellation::Domain;

const SIZE: &str = "160x120";

/// The greatest mean of the differences, in 255ths.
const MEAN: f64 = 2.0;
/// A pixel is off when a channel differs by more than this.
const OFF: u8 = 32;
/// The greatest share of pixels that are off.
const SHARE_OFF: f64 = 0.01;

const UPDATE: &str = "HULLFORM_UPDATE=1 cargo test --test pictures";

fn reference(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/pictures")
        .join(format!("{name}.png"))
}

/// Where a picture goes that is not as it should be: `pictures` in the folder of build products.
fn actual(name: &str) -> PathBuf {
    // CARGO_TARGET_TMPDIR is the folder `tmp` in there.
    let products = Path::new(env!("CARGO_TARGET_TMPDIR")).parent();
    products
        .expect("a folder in a folder")
        .join("pictures")
        .join(format!("{name}.png"))
}

/// Draws a picture, or says why there is none to compare: no device.
fn render(path: &Path, arguments: &[&str]) -> Option<()> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
    command.arg("render").args(arguments);
    command.args(["--size", SIZE, "--output"]).arg(path);
    let output = command
        .env_remove("RUST_LOG")
        .output()
        .expect("the program starts");
    let words = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(3) {
        println!("skipped: {words}");
        return None;
    }
    assert!(output.status.success(), "{arguments:?}: {words}");
    Some(())
}

/// Width, height and three bytes a pixel; transparency does not matter here.
fn read(path: &Path) -> (u32, u32, Vec<[u8; 3]>) {
    let file = File::open(path).expect("the picture is there");
    let mut reader = png::Decoder::new(BufReader::new(file))
        .read_info()
        .expect("a PNG file");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    assert_eq!(info.bit_depth, png::BitDepth::Eight);
    let channels = info.color_type.samples();
    let pixels = bytes[..info.buffer_size()].chunks_exact(channels);
    let pixels = pixels.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    (info.width, info.height, pixels)
}

/// The mean of the differences over all channels, and the share of pixels that are off.
fn differences(a: &[[u8; 3]], b: &[[u8; 3]]) -> (f64, f64) {
    let differences: Vec<[u8; 3]> = a
        .iter()
        .zip(b)
        .map(|(a, b)| std::array::from_fn(|i| a[i].abs_diff(b[i])))
        .collect();
    let sum: f64 = differences.iter().flatten().map(|&d| f64::from(d)).sum();
    let off = differences.iter().filter(|d| d.iter().any(|&d| d > OFF));
    let (off, count) = (off.count() as f64, differences.len() as f64);
    (sum / (3.0 * count), off / count)
}

fn compare(name: &str, arguments: &[&str]) {
    let (reference, actual) = (reference(name), actual(name));
    fs::create_dir_all(actual.parent().expect("a folder")).expect("a folder can be made");
    if render(&actual, arguments).is_none() {
        return;
    }
    if std::env::var_os("HULLFORM_UPDATE").is_some() {
        fs::create_dir_all(reference.parent().expect("a folder")).expect("a folder can be made");
        fs::copy(&actual, &reference).expect("the reference can be written");
    }
    let shown = actual.display();
    assert!(
        reference.is_file(),
        "there is no tests/pictures/{name}.png; look at {shown}, and if it is right make it the reference with {UPDATE}"
    );
    let (width, height, right) = read(&reference);
    let (w, h, pixels) = read(&actual);
    assert_eq!((w, h), (width, height), "{name}: another size; see {shown}");
    let (mean, off) = differences(&pixels, &right);
    println!(
        "{name}: differences {mean:.3} on average, {:.2} % of pixels off",
        100.0 * off
    );
    assert!(
        mean <= MEAN && off <= SHARE_OFF,
        "{name}: {mean:.2} on average and {:.1} % of pixels off; compare {shown} with tests/pictures/{name}.png, \
         and if the new one is right make it the reference with {UPDATE}",
        100.0 * off
    );
    fs::remove_file(&actual).expect("it was just made");
}

#[test]
fn hull_lit() {
    compare("hull-lit", &["builtin:hull"]);
}

#[test]
fn hull_by_node() {
    compare("hull-node", &["builtin:hull", "--shading", "node"]);
}

#[test]
fn creased_torus_by_patch() {
    compare(
        "creased-torus-patch",
        &["builtin:creased-torus", "--shading", "patch"],
    );
}

#[test]
fn cube_as_wireframe() {
    compare(
        "cube-wireframe",
        &["builtin:cube", "--wireframe", "--level", "5"],
    );
}

#[test]
fn ngons_by_valence() {
    compare("ngons-valence", &["builtin:ngons", "--shading", "valence"]);
}

#[test]
fn sheet_by_normal() {
    compare("sheet-normal", &["builtin:sheet", "--shading", "normal"]);
}

/// A shape of a domain that a method draws: the first that it does not refuse, and the scheme.
fn shape(method: &Method, domain: Domain) -> (&'static str, Scheme) {
    let fits = |scheme: Scheme| match domain {
        Domain::Quads => scheme.is_whole(4) && !scheme.is_whole(3),
        Domain::Triangles => scheme.is_triangular(),
    };
    let schemes = method.schemes.iter().copied().find(|&scheme| fits(scheme));
    let scheme = schemes.expect("a method does a scheme of each of its domains");
    let draws = |name: &&str| {
        let mesh = builtin(name).expect("it is built in");
        let mesh = match domain {
            Domain::Quads => mesh,
            Domain::Triangles => {
                triangulated(&mesh, Triangulation::default()).expect("it is sound")
            }
        };
        let mesh = mesh.with_scheme(scheme);
        mesh.is_ok_and(|mesh| method.check_model(&Model::new(mesh)).is_ok())
    };
    let mut shapes = ["hull", "pole-7", "creased-torus", "cube"].into_iter();
    (
        shapes.find(draws).expect("every method draws a cube"),
        scheme,
    )
}

#[test]
fn every_method_has_a_picture_of_each_domain() {
    for method in METHODS {
        for &domain in method.domains {
            let (shape, scheme) = shape(method, domain);
            let word = format!("{domain:?}").to_lowercase();
            compare(
                &format!("method-{}-{word}", method.name),
                &[
                    &format!("builtin:{shape}"),
                    "--scheme",
                    scheme.name(),
                    "--method",
                    method.name,
                    "--level",
                    "8",
                ],
            );
        }
    }
}

/// Without this, that the others pass would prove nothing.
#[test]
fn another_picture_is_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = ["lit", "normal"].map(|shading| folder.path().join(format!("{shading}.png")));
    for (path, shading) in paths.iter().zip(["lit", "normal"]) {
        if render(path, &["builtin:cube", "--shading", shading]).is_none() {
            return;
        }
    }
    let [(_, _, a), (_, _, b)] = paths.map(|path| read(&path));
    let (mean, off) = differences(&a, &b);
    assert!(mean > MEAN && off > SHARE_OFF, "{mean} {off}");
}
