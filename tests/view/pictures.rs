//! What is seen is what `hullform render` draws by the command line that can be copied: over methods, back-ends, colours and cameras.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use hullform::method::METHODS;
use serde_json::Value;

use super::display;
use crate::window::{Session, read_png};

/// At most so much differs on average, in steps of 255: `render` has finer edges.
const FINER: f64 = 0.9;

/// What is pressed from one picture to the next, so that in the end each has met many others; a model for each shape of faces.
const WALKS: [(&str, &str); 2] = [
    ("builtin:ngons", "c mc bc oc rc lc 2mc bc kc mc oc zc ac ac mbc rc lc mc w w ++mc bc kkc o3mc"),
    ("builtin:hull", "c mc oc bmc lc rc mc bc amc ac kc mc"),
];

#[test]
fn every_method_back_end_colour_and_camera_is_as_render_draws_it() {
    let Some(display) = display() else { return };
    let mut seen: [BTreeSet<String>; 5] = Default::default();
    let mut pictures = 0;
    for (model, walk) in WALKS {
        let folder = tempfile::tempdir().expect("a folder");
        let options = ["--size", "560x420", model];
        let session = Session::open_with(&display, folder.path(), &options, |command| {
            command.arg("--validation");
        });
        session.hand.key(crate::window::keys::TAB, &[]);
        session.until("panels have gone", |state| state["panels"] == false);
        session.press('f');
        for step in walk.split(' ') {
            step.chars().for_each(|sign| session.press(sign));
            if let Some(words) = compared(&session, &mut seen) {
                assert!(words.is_empty(), "{model}, after {step}: {words}");
                pictures += 1;
            }
        }
        let state = session.state();
        assert_eq!(state["validation"], 0, "{state:#}");
        session.quit();
        let (code, words) = session.end();
        assert_eq!(code, Some(0), "{words}");
    }
    println!("{pictures} pictures");
    let counts = seen.each_ref().map(BTreeSet::len);
    let [methods, ..] = counts;
    assert!(methods >= METHODS.len() - 1 && counts[1..] == [3, 9, 2, 2], "{seen:?}");
}

/// Waits for the picture, and compares it with what its command line draws: what is wrong, in words. None where the model is refused.
fn compared(session: &Session, seen: &mut [BTreeSet<String>; 5]) -> Option<String> {
    // Keys come one by one.
    session.picture();
    let state = session.until("all is there", |_| true);
    if state["models"][0]["error"].is_string() {
        return None;
    }
    let cut = &state["cut"];
    let facts = [
        &state["models"][0]["methods"][0],
        &cut["backend"],
        &state["look"]["shading"],
        &cut["residence"],
        &state["camera"]["orthographic"],
    ];
    for (seen, fact) in seen.iter_mut().zip(facts) {
        seen.insert(fact.to_string());
    }
    session.sooner_or_later("words have gone", |state| state["notice"].is_null());
    let picture = session.scene();
    let before = state["copied"].clone();
    session.control('c');
    let state = session.until("copied", |state| state["copied"] != before || repeats(state));
    let line = state["copied"].as_str().expect("a command line").to_string();
    let drawn = draw(session, &line);
    let apart = picture.difference(&drawn, true);
    (apart > FINER).then(|| format!("{apart} by {line}")).or(Some(String::new()))
}

/// Whether the line that was copied is told.
fn repeats(state: &Value) -> bool {
    state["notice"].as_str().is_some_and(|words| words.contains("hullform render"))
}

fn draw(session: &Session, line: &str) -> crate::window::Picture {
    let program = env!("CARGO_BIN_EXE_hullform");
    let line = line.replacen("hullform ", &format!("{program} "), 1);
    let done = Command::new("sh")
        .args(["-c", &line])
        .current_dir(&session.folder)
        .env("XDG_CACHE_HOME", session.folder.join("home/cache"))
        .output();
    let done = done.expect("a shell");
    assert!(done.status.success(), "{line}: {}", String::from_utf8_lossy(&done.stderr));
    read_png(&session.folder.join(Path::new("hullform.png")))
}
