//! What is opened while the window is there, what moves, and how frames are paced.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::drop::drop_files;
use super::{BOX, display};
use crate::window::{Session, keys};

/// A triangle of a few faces.
const TENT: &str =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

#[test]
fn what_is_dropped_or_was_open_or_lies_beside_is_shown_and_what_moves_can_be_scrubbed() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["a.obj", "b.obj", "c.obj"].map(|name| folder.path().join(name));
    for (file, text) in files.iter().zip([BOX, TENT, BOX]) {
        std::fs::write(file, text).expect("it is written");
    }
    let session = Session::open(&display, folder.path(), &["a.obj"]);
    let [a, b, c] = &files;
    drop_files(&display, session.window, &[b]);
    shows(&session, &["b.obj"]);
    drop_files(&display, session.window, &[c, a]);
    shows(&session, &["c.obj", "a.obj"]);
    let missing = folder.path().join("none.txt");
    std::fs::write(&missing, "no model\n").expect("it is written");
    drop_files(&display, session.window, &[&missing]);
    let state = session.until("refused", |state| state["models"][0]["error"].is_string());
    let words = state["models"][0]["error"].as_str().unwrap_or_default();
    assert!(words.contains("none.txt"), "{words}");
    drop_files(&display, session.window, &[a]);
    shows(&session, &["a.obj"]);
    neighbours(&session);
    recent(&session, &files);
    moves(&session);
    paces(&session);
    sheet(&session);
    let state = session.state();
    assert_eq!(state["validation"], 0, "{state:#}");
    session.quit();
    let (code, words) = session.end();
    assert_eq!(code, Some(0), "{words}");
}

/// Waits until these models are drawn, and no other.
fn shows(session: &Session, names: &[&str]) {
    let state = session.until(names[0], |state| {
        let models = state["models"].as_array();
        let drawn = |model: &Value| model["methods"].is_array();
        models.is_some_and(|all| {
            all.len() == names.len()
                && all
                    .iter()
                    .zip(names)
                    .all(|(model, name)| model["name"] == *name && drawn(model))
        })
    });
    assert!(state["vertices"].as_u64() > Some(0), "{state:#}");
}

fn neighbours(session: &Session) {
    for (sign, name) in [
        ('.', "b.obj"),
        ('.', "c.obj"),
        ('.', "a.obj"),
        (',', "c.obj"),
    ] {
        session.press(sign);
        shows(session, &[name]);
    }
}

/// The list of files, of which the last but one is chosen.
fn recent(session: &Session, files: &[PathBuf; 3]) {
    click(session, "files");
    session.until("the list is there", |state| {
        state["places"]["recent"].is_array()
    });
    click(session, "recent");
    shows(session, &["a.obj"]);
    let recent = session.state()["recent"].clone();
    let path = recent[0].as_str().map(PathBuf::from);
    assert!(
        path.is_some_and(|path| files[0].ends_with(path)),
        "{recent}"
    );
}

fn moves(session: &Session) {
    let still = session.scene();
    let version = session.state()["models"][0]["version"].clone();
    session.press(' ');
    let playing = |state: &Value| state["motion"]["playing"] == true;
    session.sooner_or_later("it moves", |state| {
        playing(state) && state["motion"]["kind"] != "none"
    });
    session.press(' ');
    let state = session.until("it rests", |state| !playing(state));
    let time = state["motion"]["time"].as_f64();
    let [x, y, width, height] = session.place("time");
    let middle = y + 0.5 * height;
    let at = |share: f64| [x + 8.0 + share * 88.0_f64.min(width), middle];
    session.hand.drag(1, at(0.3), at(0.75));
    let state = session.until("scrubbed", |state| state["motion"]["time"].as_f64() != time);
    let seconds = state["motion"]["time"].as_f64().unwrap_or(0.0);
    assert!(
        (2.5..3.5).contains(&seconds),
        "three quarters of four seconds: {seconds}"
    );
    let scrubbed = session.scene();
    assert!(scrubbed.difference(&still, false) > 0.5, "it is elsewhere");
    session.hand.drag(1, at(0.75), at(-0.2));
    session.until("at its beginning", |state| state["motion"]["time"] == 0.0);
    assert!(session.scene() == still, "there it is as it was");
    let model = &session.state()["models"][0];
    assert_eq!(model["version"], version, "and nothing was prepared anew");
}

fn paces(session: &Session) {
    for (name, mode) in [
        ("latest", "MAILBOX"),
        ("immediate", "IMMEDIATE"),
        ("display", "FIFO"),
    ] {
        click(session, name);
        // Not every display has all of them: then it goes with the display.
        session.until(name, |state| {
            state["pacing"] == json!([name, mode]) || state["pacing"] == json!([name, "FIFO"])
        });
        session.press(if name == "latest" { '1' } else { '4' });
        assert!(session.scene().colours() > 100, "{name}: it is drawn");
    }
}

fn sheet(session: &Session) {
    let before = session.scene();
    session.press('?');
    session.until("the keys are told", |state| state["sheet"] == true);
    assert!(session.scene().difference(&before, false) > 1.0);
    session.hand.key(keys::ESCAPE, &[]);
    session.until("no more", |state| state["sheet"] == false);
    assert!(session.scene() == before, "it is as it was");
}

fn click(session: &Session, name: &str) {
    let [x, y, width, height] = session.place(name);
    session.hand.click([x + 0.5 * width, y + 0.5 * height]);
}
