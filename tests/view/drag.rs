//! What is edited is seen soon: only what an edit has changed of the picture is drawn, and the picture is the one that is drawn from nothing.

use std::path::Path;
use std::time::{Duration, Instant};

use super::display;
use crate::steps::pick_an_edge;
use crate::window::Session;

/// A model to be dragged at for five seconds, with times told; `HULLFORM_VIEW_DRAG=ship.obj`.
const MODEL: &str = "HULLFORM_VIEW_DRAG";

#[test]
fn what_is_drawn_after_an_edit_is_a_part_and_the_picture_is_the_whole_ones() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let asked = std::env::var(MODEL).ok();
    let model = asked.as_deref().unwrap_or("builtin:ngons");
    let session = match asked {
        Some(_) => Session::open_with(
            &display,
            folder.path(),
            &["--size", "1100x700", model],
            |_| {},
        ),
        None => Session::open(&display, folder.path(), &[model]),
    };
    session.press('d');
    session.until("it is edited in place", |state| {
        state["selection"]["tool"] == "edges" && state["models"][0]["live"] == true
    });
    pick_an_edge(&session);
    session.sooner_or_later("no words", |state| state["notice"].is_null());
    let before = session.scene();
    drags(&session, if asked.is_some() { 5.0 } else { 0.5 });
    let state = session.until("all is seen", |state| {
        let model = &state["models"][0];
        state["edits"]["seen"].as_u64() > Some(0) && model["wanted"] == model["version"][1]
    });
    if asked.is_some() {
        tell(&session.folder.join("state.jsonl"));
    }
    let parts = state["edits"]["parts"].as_u64();
    assert!(parts > Some(0), "a part was drawn: {}", state["edits"]);
    let edited = session.scene();
    assert!(edited.difference(&before, false) > 0.0, "an edit is seen");
    session.control('z');
    session.until("undone", |state| state["models"][0]["steps"][0] == 0);
    assert!(session.scene() == before, "undone, it is as it was");
    session.control('y');
    session.until("made again", |state| state["models"][0]["steps"][0] == 1);
    for wires in [true, false] {
        session.press('w');
        session.until("drawn anew", |state| state["look"]["wireframe"] == wires);
    }
    let state = session.state();
    assert!(session.scene() == edited, "drawn anew, it is the same");
    assert_eq!(state["validation"], 0, "{state:#}");
    session.quit();
    let (code, words) = session.end();
    assert_eq!(code, Some(0), "{words}");
}

/// Drags the sharpness of what is picked up and down.
fn drags(session: &Session, seconds: f64) {
    let [x, y, width, height] = session.place("sharpness");
    let at = |share: f64| (x + 12.0 + share * 0.4 * width, y + 0.5 * height);
    let (left, middle) = at(0.0);
    session.hand.to(left, middle);
    session.hand.button(1, true);
    let (started, end) = (Instant::now(), Duration::from_secs_f64(seconds));
    while started.elapsed() < end {
        let turn = 0.5 - 0.5 * (3.0 * started.elapsed().as_secs_f64()).cos();
        let (x, y) = at(turn);
        session.hand.to(x, y);
    }
    session.hand.button(1, false);
}

/// Tells how long frames and edits took while it was dragged.
fn tell(log: &Path) {
    let text = std::fs::read_to_string(log).expect("there is a log");
    let states = text
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let states: Vec<_> = states.collect();
    let (mut frames, mut edits) = (Vec::new(), Vec::new());
    for pair in states.windows(2) {
        let seen = |at: usize| pair[at]["edits"]["seen"].as_u64().unwrap_or(0);
        let time = |at: usize| pair[at]["seconds"].as_f64().unwrap_or(0.0);
        let changing =
            pair[0]["models"][0]["wanted"] != pair[1]["models"][0]["wanted"] || seen(1) > seen(0);
        if changing {
            frames.push(time(1) - time(0));
        }
        if seen(1) > seen(0) {
            edits.push(pair[1]["edits"]["seconds"].as_f64().unwrap_or(0.0));
        }
    }
    for (name, mut all) in [("frames", frames), ("edits", edits)] {
        all.sort_by(f64::total_cmp);
        let at = |share: f64| {
            all.get((share * (all.len() as f64 - 1.0)) as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let [median, most, worst] = [0.5, 0.9, 1.0].map(|share| 1e3 * at(share));
        println!(
            "{} {name}: {median:.0} / {most:.0} / {worst:.0} ms (median, 90 %, worst)",
            all.len()
        );
    }
    let last = states.last().cloned().unwrap_or_default();
    println!("{} parts", last["edits"]["parts"]);
}
