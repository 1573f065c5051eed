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
    render_plainly(path, &[arguments, &["--size", SIZE]].concat())
}

/// The same in the size that the arguments name.
fn render_plainly(path: &Path, arguments: &[&str]) -> Option<()> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
    command.arg("render").args(arguments);
    command.arg("--output").arg(path);
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
    let arguments = [arguments, &["--size", SIZE]].concat();
    compare_with(&reference(name), name, &arguments);
}

fn compare_with(reference: &Path, name: &str, arguments: &[&str]) {
    let actual = actual(name);
    fs::create_dir_all(actual.parent().expect("a folder")).expect("a folder can be made");
    if render_plainly(&actual, arguments).is_none() {
        return;
    }
    let right = reference.display();
    if std::env::var_os("HULLFORM_UPDATE").is_some() {
        fs::create_dir_all(reference.parent().expect("a folder")).expect("a folder can be made");
        fs::copy(&actual, reference).expect("the reference can be written");
    }
    let shown = actual.display();
    assert!(
        reference.is_file(),
        "there is no {right}; look at {shown}, and if it is right make it the reference with {UPDATE}"
    );
    let (width, height, expected) = read(reference);
    let (w, h, pixels) = read(&actual);
    assert_eq!((w, h), (width, height), "{name}: another size; see {shown}");
    let (mean, off) = differences(&pixels, &expected);
    println!(
        "{name}: differences {mean:.3} on average, {:.2} % of pixels off",
        100.0 * off
    );
    assert!(
        mean <= MEAN && off <= SHARE_OFF,
        "{name}: {mean:.2} on average and {:.1} % of pixels off; compare {shown} with {right}, \
         and if the new one is right make it the reference with {UPDATE}",
        100.0 * off
    );
    fs::remove_file(&actual).expect("it was just made");
}

/// What somebody sees who tries hullform is what its README shows.
#[test]
fn the_first_picture_of_the_readme_is_the_default_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    compare_with(&root.join("examples/hull.png"), "hull", &[]);
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

#[test]
fn macro_faces_by_patch() {
    for kind in ["quartets", "rectangles"] {
        let arguments = ["builtin:sheet", "--macro", kind, "--shading", "patch"];
        let level = ["--level", "4", "--wireframe"];
        compare(
            &format!("macro-{kind}-patch"),
            &[&arguments[..], &level].concat(),
        );
    }
}

/// By the trees of their faces, from a cache, finer where it is nearer.
#[test]
fn rectangles_by_node() {
    let arguments = ["builtin:hull", "--macro", "rectangles", "--level", "4"];
    let how = [
        "--residence",
        "cache",
        "--adaptive",
        "distance",
        "--shading",
        "node",
    ];
    compare("macro-rectangles-node", &[&arguments[..], &how].concat());
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

/// A picture to be looked into.
struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// None without a device.
    fn of(model: &str, size: &str, arguments: &[&str]) -> Option<Picture> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.png");
        render_plainly(&path, &[&[model, "--size", size], arguments].concat())?;
        let (width, height, pixels) = read(&path);
        Some(Picture {
            width: width as usize,
            height: height as usize,
            pixels,
        })
    }

    fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[y * self.width + x]
    }

    /// Whether something is drawn in each pixel: it differs from what is there when the model is a speck in the middle.
    fn drawn(&self, empty: &Picture) -> Vec<bool> {
        let background = |i: usize| empty.at(0, i / self.width);
        let differs = |i: usize| (0..3).any(|c| self.pixels[i][c].abs_diff(background(i)[c]) > 2);
        (0..self.pixels.len()).map(differs).collect()
    }
}

/// A model of its own in a file, for as long as it lives.
fn model(name: &str, obj: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(format!("{name}.obj"));
    fs::write(&path, obj).expect("a file can be written");
    let path = path.to_str().expect("a plain path").to_owned();
    (folder, path)
}

/// A single quad, which bulges far beyond its corners and middle; the long way round a tent of four sides; both with a vertex far away that
/// no face uses.
const BULGES: [&str; 2] = [
    "v 0 0 0\nv 2 0 1\nv 2 3 0\nv 0 2 1\nv 90 90 90\nf 1 2 3 4\nt interpolateboundary 1/0/0 2\n",
    "v 0 3 0\nv 90 90 90\nv 1 1 0\nv 1.5 0 0\nv 0 1 1\nv 0 0 1.5\nv -1 1 0\nv -1.5 0 0\nv 0 1 -1\nv 0 0 -1.5\n\
     f 1 5 3\nf 3 5 6 4\nf 1 7 5\nf 5 7 8 6\nf 1 9 7\nf 7 9 10 8\nf 1 3 9\nf 9 3 4 10\n",
];

#[test]
fn what_is_drawn_fills_the_picture_and_is_never_cut() {
    let files = BULGES.map(|obj| model("bulge", obj));
    let [quad, tent] = [0, 1].map(|i| files[i].1.as_str());
    for size in ["160x120", "90x160"] {
        let Some(empty) = Picture::of("builtin:cube", size, &["--camera", "0,0,0.01"]) else {
            return;
        };
        for (model, arguments) in [
            (quad, "--camera=40,22,1"),
            (tent, "--camera=40,22,1"),
            ("builtin:cube", "--camera=10,80,1"),
            ("builtin:cube", "--camera=-130,33,1 --level=1"),
            ("builtin:cube", "--camera=25,-50,1 --displace=0.15"),
            (tent, "--camera=100,10,1 --displace=-0.3 --level=16"),
            ("builtin:sheet", "--camera=200,-90,1 --displace=0.2"),
            (
                "builtin:pole-5",
                "--camera=0,5,1 --spacing=fractional-even --level=5",
            ),
            (
                "builtin:cube",
                "--camera=70,60,1 --method=pn --backend=pattern --displace=0.2",
            ),
            (
                "builtin:cube",
                "--camera=70,20,1 --displace=0.2 --adaptive=screen:4",
            ),
        ] {
            let arguments: Vec<&str> = arguments.split(' ').collect();
            let picture = Picture::of(model, size, &arguments).expect("there is a device");
            let (fill, margin) = fill(&picture, &empty);
            let place = format!("{model} {size} {arguments:?}: {fill}");
            assert!(margin > 0 && (0.85..=0.95).contains(&fill), "{place}");
        }
    }
}

/// Which share of the tighter side the drawn box has, and the pixels that are free on the narrowest of its sides.
fn fill(picture: &Picture, empty: &Picture) -> (f64, usize) {
    let (w, h) = (picture.width, picture.height);
    let drawn = picture.drawn(empty);
    let span = |length: usize, has: &dyn Fn(usize) -> bool| {
        let first = (0..length).find(|&i| has(i)).expect("something is drawn");
        let last = (0..length).rfind(|&i| has(i)).expect("something is drawn");
        let share = (last + 1 - first) as f64 / length as f64;
        (share, first.min(length - 1 - last))
    };
    let (x, left) = span(w, &|x| (0..h).any(|y| drawn[y * w + x]));
    let (y, above) = span(h, &|y| (0..w).any(|x| drawn[y * w + x]));
    (x.max(y), left.min(above))
}

/// Behind a hole in the front, that the near plane cuts, one would see the inside of the back, whose normals point away.
#[test]
fn no_plane_cuts_what_stands_out() {
    let arguments = [
        "--displace",
        "0.15",
        "--camera",
        "0,0,1",
        "--shading",
        "normal",
    ];
    let Some(picture) = Picture::of("builtin:cube", "120x120", &arguments) else {
        return;
    };
    for (x, y) in (42..78).flat_map(|x| (42..78).map(move |y| (x, y))) {
        let [_, _, z] = picture.at(x, y);
        assert!(z > 150, "{x}, {y}: {z}");
    }
}

/// Where triangles that are seen from the front have normals that point away, the side that is towards the light stays light.
#[test]
fn silhouettes_have_no_dashes() {
    let brightness = |[r, g, b]: [u8; 3]| u32::from(r) + u32::from(g) + u32::from(b);
    for level in ["2", "3"] {
        let arguments = ["--level", level, "--camera", "35,30,1"];
        let Some(picture) = Picture::of("builtin:cube", "240x240", &arguments) else {
            return;
        };
        let speck = ["--camera", "0,0,0.01"];
        let empty = Picture::of("builtin:cube", "240x240", &speck).expect("a device");
        let drawn = picture.drawn(&empty);
        // From the middle to the border at the upper left, where the light comes from.
        for degree in 100..170 {
            let direction = f64::from(degree).to_radians();
            let along = |r: usize| {
                let [x, y] = [direction.cos(), -direction.sin()];
                [x, y].map(|c| (120.0 + c * r as f64) as usize)
            };
            let border = (0..120).rfind(|&r| drawn[along(r)[1] * 240 + along(r)[0]]);
            let border = border.expect("the middle is drawn");
            let at = |r: usize| brightness(picture.at(along(r)[0], along(r)[1]));
            let (inside, rim) = (at(border - 16), (2..9).map(|r| at(border - r)).min());
            let rim = rim.expect("seven pixels");
            assert!(
                10 * rim > 9 * inside,
                "level {level}, {degree} degrees: {rim} beside {inside}"
            );
        }
    }
}

/// Whoever cuts patches into triangles, their fronts are the same: light comes from the same side.
#[test]
fn back_ends_draw_the_same_picture() {
    for (shape, method) in [("hull", "flat"), ("cube", "pn")] {
        let drawn = ["tessellator", "pattern", "geometry"].map(|backend| {
            let arguments = ["--method", method, "--backend", backend];
            Picture::of(&format!("builtin:{shape}"), "240x180", &arguments)
        });
        let [Some(first), others @ ..] = drawn else {
            return;
        };
        for other in others.into_iter().flatten() {
            let (mean, off) = differences(&first.pixels, &other.pixels);
            assert!(mean <= MEAN && off <= SHARE_OFF, "{shape}: {mean} {off}");
        }
    }
}

/// Seen from above, the light is that of the view and turns around no point: neighbours are alike all over a round top.
#[test]
fn from_above_light_has_no_pinch() {
    for pitch in ["80", "90", "-90"] {
        let camera = format!("10,{pitch},1");
        let arguments = ["--camera", &camera, "--level", "16"];
        let Some(picture) = Picture::of("builtin:cube", "160x160", &arguments) else {
            return;
        };
        for (x, y) in (40..120).flat_map(|x| (40..120).map(move |y| (x, y))) {
            for (to_x, to_y) in [(x + 2, y), (x, y + 2)] {
                let (a, b) = (picture.at(x, y), picture.at(to_x, to_y));
                let steps = (0..3).map(|channel| a[channel].abs_diff(b[channel]));
                let step = steps.max().expect("three channels");
                assert!(step < 10, "{camera}: {step} at {x}, {y}");
            }
        }
    }
}

/// Of a size there is nothing in a picture: a power of two changes no bit, anything else hardly any.
#[test]
fn models_of_any_size_have_the_same_picture() {
    let tent = |scale: f64| {
        let scaled = |line: &str| match line.strip_prefix("v ") {
            None => line.to_owned(),
            Some(numbers) => {
                let numbers = numbers
                    .split(' ')
                    .map(|n| n.parse::<f64>().expect("a number"));
                let numbers = numbers.map(|number| format!("{:e}", number * scale));
                format!("v {}", numbers.collect::<Vec<String>>().join(" "))
            }
        };
        let lines: Vec<String> = BULGES[1].lines().map(scaled).collect();
        let (_folder, path) = model("scaled", &(lines.join("\n") + "\n"));
        Picture::of(&path, SIZE, &["--displace", "0.02"])
    };
    let Some(right) = tent(1.0) else {
        return;
    };
    for (scale, bound) in [
        (2f64.powi(-40), 0.0),
        (2f64.powi(30), 0.0),
        (1e-6, 0.1),
        (1e12, 0.1),
    ] {
        let scaled = tent(scale).expect("there is a device");
        let (mean, _) = differences(&scaled.pixels, &right.pixels);
        assert!(mean <= bound, "{scale}: {mean}");
    }
}

/// Two sides that lie in one another, and a face whose corners are in one place: whatever has no normal is lit all the same, and nothing is black.
#[test]
fn what_has_no_normal_is_lit() {
    let (_folder, path) = model(
        "flat",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3 4\nf 4 3 2 1\nf 5 6 7 8\n",
    );
    for method in ["quadtree", "flat"] {
        let Some(picture) = Picture::of(&path, SIZE, &["--method", method]) else {
            return;
        };
        let dark = picture
            .pixels
            .iter()
            .filter(|pixel| pixel.iter().all(|&c| c < 30));
        assert_eq!(dark.count(), 0, "{method}");
    }
}
