//! A screenshot is what `hullform render` draws by the command line that can be copied: over methods, back-ends, colours and cameras.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use hullform::method::METHODS;
use serde_json::Value;

use super::display;
use crate::display::Display;
use crate::window::{Picture, Session, keys, read_png};

/// At most so much differs on average, in steps of 255: `render` has finer edges, and draws the lines of patches half as wide.
const FINER: f64 = 0.9;
const FINER_LINES: f64 = 4.5;

/// What has lines whose width goes by pixels, or squares with sharp sides.
const LINED: [&str; 4] = ["node kinds", "levels", "tree depth", "checker"];

/// Rows at the bottom in which stands what colours mean.
const LEGEND: u32 = 60;

/// What is pressed from one picture to the next, so that in the end each choice has met many others; one for what the device decides, and one for each kind of faces.
const WALKS: [(&str, &str); 4] = [
    ("builtin:hull", "a k ka kac ka"),
    ("builtin:ngons", "c mb c o bc brc lc zc ac w"),
    (
        "builtin:cube",
        "w wmmmc bc rc lc mb c kc mb oc mb c mzc mc mc mc mc mc",
    ),
    ("builtin:hull", "MM mmc bc bc oc rc c"),
];

#[test]
fn every_method_back_end_colour_and_camera_is_as_render_draws_it() {
    let Some(display) = display() else { return };
    let mut seen = Seen::default();
    for (model, walk) in WALKS {
        let place = Place::open(&display, model);
        press(&place.session, 'f');
        for step in walk.split(' ') {
            let session = &place.session;
            step.chars().for_each(|sign| press(session, sign));
            place.compares(step, &mut seen);
        }
        place.close();
    }
    println!("{} pictures", seen.pictures);
    let [methods, rest @ ..] = seen.facts.each_ref().map(BTreeSet::len);
    assert!(
        methods == METHODS.len() && rest == [3, COLOURS, 2, 2],
        "{:?}",
        seen.facts
    );
}

/// Every method in every colour takes minutes: with `HULLFORM_VIEW_SWEEP=1`.
#[test]
fn every_method_is_in_every_colour_as_render_draws_it() {
    if std::env::var_os("HULLFORM_VIEW_SWEEP").is_none() {
        return;
    }
    let Some(display) = display() else { return };
    let mut seen = Seen::default();
    // Under a scheme of triangles those that the first one refuses.
    for schemes in ["", "MM"] {
        let place = Place::open(&display, "builtin:cube");
        let session = &place.session;
        press(session, 'f');
        schemes.chars().for_each(|sign| press(session, sign));
        for _ in METHODS {
            press(session, 'm');
            let state = session.until("refused or drawn", |state| {
                let model = &state["models"][0];
                model["error"].is_string() || state["cut"]["method"] == model["methods"][0]
            });
            let method = state["models"][0]["methods"][0].to_string();
            let known = seen.facts[0].contains(&method);
            if known || state["models"][0]["error"].is_string() {
                continue;
            }
            for _ in 0..COLOURS {
                press(session, 'c');
                place.compares(&method, &mut seen);
            }
        }
        place.close();
    }
    println!("{} pictures", seen.pictures);
    assert_eq!(seen.facts[0].len(), METHODS.len(), "{:?}", seen.facts[0]);
    assert_eq!(seen.pictures, METHODS.len() * COLOURS);
}

/// The picture of the README, `HULLFORM_VIEW_PICTURE=examples/view.png`: it is taken anew where the window looks otherwise.
#[test]
fn a_picture_for_the_readme() {
    let Some(file) = std::env::var_os("HULLFORM_VIEW_PICTURE") else {
        return;
    };
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let options = ["--size", "1280x800", "builtin:hull"];
    let session = Session::open_with(&display, folder.path(), &options, |_| {});
    session.press('s');
    session.until("split", |state| state["compare"]["beside"] == "split");
    (0..3).for_each(|_| press(&session, 'c'));
    session.hand.to(480.0, 400.0);
    session.hand.to(482.0, 400.0);
    session.until("numbers under the cursor", |state| {
        state["probe"].is_object()
    });
    session.picture();
    session.hand.key(keys::F12, &[]);
    std::fs::copy(session.file("hullform-1.png"), &file).expect("it is written");
    session.quit();
    session.end();
}

/// What has been compared: pictures, and the methods, back-ends, colours, residences and cameras in them.
#[derive(Default)]
struct Seen {
    facts: [BTreeSet<String>; 5],
    pictures: usize,
}

/// How many colourings there are.
const COLOURS: usize = 9;

/// A window on a model, without panels.
struct Place {
    session: Session,
    model: &'static str,
    _folder: tempfile::TempDir,
}

impl Place {
    fn open(display: &Display, model: &'static str) -> Place {
        let folder = tempfile::tempdir().expect("a folder");
        let options = ["--size", "560x420", model];
        let session = Session::open_with(display, folder.path(), &options, |command| {
            command.arg("--validation");
        });
        session.hand.key(keys::TAB, &[]);
        session.until("panels have gone", |state| state["panels"] == false);
        Place {
            session,
            model,
            _folder: folder,
        }
    }

    /// Compares what is seen, unless the model is refused.
    fn compares(&self, step: &str, seen: &mut Seen) {
        if let Some(words) = compared(&self.session, &mut seen.facts) {
            assert!(words.is_empty(), "{}, after {step}: {words}", self.model);
            seen.pictures += 1;
        }
    }

    fn close(self) {
        let state = self.session.state();
        assert_eq!(state["validation"], 0, "{state:#}");
        self.session.quit();
        let (code, words) = self.session.end();
        assert_eq!(code, Some(0), "{words}");
    }
}

/// Presses a key, and waits until it has done what it does.
fn press(session: &Session, sign: char) {
    let shown = |state: &Value| ["look", "cut", "camera", "frozen"].map(|of| state[of].clone());
    let before = shown(&session.state());
    session.press(sign);
    session.until("something changes", |state| shown(state) != before);
}

/// Waits for the picture, and compares it with what its command line draws: what is wrong, in words. None where the model is refused.
fn compared(session: &Session, seen: &mut [BTreeSet<String>; 5]) -> Option<String> {
    // Words would stand over it.
    session.hand.key(keys::ESCAPE, &[]);
    session.until("no words", |state| state["notice"].is_null());
    session.hand.key(keys::F12, &[]);
    let file = session.file("hullform-1.png");
    let picture = read_png(&file);
    std::fs::remove_file(file).expect("it is removed");
    // Each step changes what is copied.
    let last = session.state()["copied"].clone();
    session.control('c');
    let state = session.until("copied", |state| state["copied"] != last);
    if state["models"][0]["error"].is_string() {
        return None;
    }
    let (cut, look) = (&state["cut"], &state["look"]);
    let facts = [
        &state["models"][0]["methods"][0],
        &cut["backend"],
        &look["shading"],
        &cut["residence"],
        &state["camera"]["orthographic"],
    ];
    for (seen, fact) in seen.iter_mut().zip(facts) {
        seen.insert(fact.to_string());
    }
    let line = state["copied"].as_str().expect("a command line");
    let drawn = draw(session, line);
    let [width, height] = picture.size;
    let upper = [0, 0, width, height - LEGEND];
    let apart = picture.part(upper).difference(&drawn.part(upper), false);
    let wires = look["wireframe"] == true;
    let is_lined = wires || LINED.iter().any(|lined| look["shading"] == *lined);
    let most = if is_lined { FINER_LINES } else { FINER };
    println!("{apart:.2} {line}");
    Some(match apart <= most {
        true => String::new(),
        false => format!("{apart} by {line}"),
    })
}

fn draw(session: &Session, line: &str) -> Picture {
    let program = env!("CARGO_BIN_EXE_hullform");
    let line = line.replacen("hullform ", &format!("{program} "), 1);
    let done = Command::new("sh")
        .args(["-c", &line])
        .current_dir(&session.folder)
        .env("XDG_CACHE_HOME", session.folder.join("home/cache"))
        .output();
    let done = done.expect("a shell");
    assert!(
        done.status.success(),
        "{line}: {}",
        String::from_utf8_lossy(&done.stderr)
    );
    read_png(&session.folder.join(Path::new("hullform.png")))
}
