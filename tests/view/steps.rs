//! A session from the first picture to the last, step by step.

use std::process::Command;

use serde_json::Value;

use super::{BOX, display};
use crate::window::{Picture, Session, keys, read_png};

/// At least so much differs where another thing is seen, in steps of 255.
const OTHER: f64 = 0.05;

#[test]
fn a_session_of_looking_cutting_comparing_and_changing() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("box.obj"), BOX).expect("it is written");
    let session = Session::open(&display, folder.path(), &["box.obj"]);
    let first = session.scene();
    assert!(first.colours() > 200, "a lit surface has many colours");
    turns(&session);
    cuts(&session);
    refuses_and_keeps_the_picture(&session);
    freezes(&session);
    compares(&session);
    changes(&session);
    saves_the_same_picture(&session);
    reads_again(&session);
    goes_along_with_the_window(&session);
    let state = session.state();
    assert_eq!(state["validation"], 0, "{state:#}");
    session.hand.close(session.window);
    let (code, words) = session.end();
    assert_eq!(code, Some(0), "{words}");
    let settings = folder.path().join("home/config/hullform/view.json");
    let settings: Value =
        serde_json::from_slice(&std::fs::read(settings).expect("settings")).expect("they are JSON");
    assert!(
        settings["recent"][0]
            .as_str()
            .is_some_and(|file| file.ends_with("box.obj"))
    );
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// What is seen of the scene, which must be another thing than before.
fn other(session: &Session, before: &Picture, what: &str) -> Picture {
    let now = session.scene();
    assert!(
        now.difference(before, false) > OTHER,
        "{what}: the picture is the same"
    );
    now
}

fn turns(session: &Session) {
    let before = session.scene();
    let yaw = number(&session.state()["camera"]["yaw"]);
    session.hand.drag(1, [500.0, 300.0], [560.0, 320.0]);
    session.until("turned", |state| {
        number(&state["camera"]["yaw"]) < yaw - 10.0
    });
    let turned = other(session, &before, "turned");
    let target = session.state()["camera"]["target"].clone();
    session.hand.drag(3, [500.0, 300.0], [540.0, 340.0]);
    session.until("moved", |state| state["camera"]["target"] != target);
    other(session, &turned, "moved");
    let distance = number(&session.state()["camera"]["distance"]);
    session.hand.button(4, true);
    session.hand.button(4, false);
    session.until("nearer", |state| {
        number(&state["camera"]["distance"]) < distance
    });
    session.press('o');
    session.until("parallel", |state| state["camera"]["orthographic"] == true);
    session.press('o');
    session.press('4');
    session.until("as at first", |state| {
        number(&state["camera"]["yaw"]) == 40.0 && state["camera"]["orthographic"] == false
    });
}

fn cuts(session: &Session) {
    let vertices = number(&session.state()["vertices"]);
    session.press('+');
    session.until("finer", |state| {
        state["cut"]["level"] == 9.0 && number(&state["vertices"]) > vertices
    });
    let [x, y, width, height] = session.place("level");
    let middle = y + 0.5 * height;
    session
        .hand
        .drag(1, [x + 0.45 * width, middle], [x + 0.2 * width, middle]);
    let state = session.until("coarser, by the slider", |state| {
        number(&state["cut"]["level"]) < 6.0 && number(&state["vertices"]) < vertices
    });
    let level = number(&state["cut"]["level"]);
    assert!(
        level.fract() != 0.0,
        "sliders have levels between whole ones: {level}"
    );
    let before = session.scene();
    session.press('w');
    session.until("wires", |state| state["look"]["wireframe"] == true);
    other(session, &before, "wires");
    session.press('w');
    session.until("no wires", |state| state["look"]["wireframe"] == false);
    assert!(session.scene() == before, "without wires it is as it was");
    for expected in [
        "normals",
        "patches",
        "node kinds",
        "valences",
        "levels",
        "checker",
        "tree depth",
        "bumps",
    ] {
        session.press('c');
        session.until(expected, |state| state["look"]["shading"] == expected);
        other(session, &before, expected);
    }
    while session.state()["look"]["shading"] != "lit" {
        let shading = session.state()["look"]["shading"].clone();
        session.press('c');
        session.until("other colours", |state| state["look"]["shading"] != shading);
    }
}

fn refuses_and_keeps_the_picture(session: &Session) {
    let before = session.scene();
    session.press('m');
    session.until("quadtree", |state| {
        state["models"][0]["methods"][0] == "quadtree"
    });
    session.press('m');
    let state = session.until("qas is for triangles", |state| {
        state["cut"]["method"] == "qas" && state["models"][0]["error"].is_string()
    });
    assert_eq!(
        state["models"][0]["methods"][0], "quadtree",
        "the last picture stays"
    );
    let [x, y, width, height] = session.area();
    let part = [0, 0, width, height / 2];
    let now = session.picture().part([x, y, width, height]);
    assert!(
        now.part(part) == before.part(part),
        "the last picture stays"
    );
    // Of the methods between all but three refuse creases.
    (0..8).for_each(|_| session.press('m'));
    session.until("curved faces", |state| {
        state["models"][0]["methods"][0] == "pn"
    });
    for _ in 0..3 {
        session.press('m');
    }
    session.until("the model's own", |state| {
        state["cut"]["method"].is_null() && state["models"][0]["methods"][0] == "quadtree"
    });
}

fn freezes(session: &Session) {
    for _ in 0..20 {
        session.press('+');
    }
    session.until("fine", |state| number(&state["cut"]["level"]) > 20.0);
    session.press('a');
    session.until("by pixels", |state| state["cut"]["adaptive"] == "screen:8");
    session.press('z');
    let state = session.until("frozen", |state| state["frozen"] == true);
    let vertices = state["vertices"].clone();
    let distance = number(&state["camera"]["distance"]);
    session.hand.to(540.0, 340.0);
    for _ in 0..6 {
        session.hand.button(5, true);
        session.hand.button(5, false);
    }
    let state = session.until("farther", |s| {
        number(&s["camera"]["distance"]) > 1.8 * distance
    });
    let scenes = number(&state["scenes"]);
    session.picture();
    assert_eq!(
        session.state()["vertices"],
        vertices,
        "levels are by the frozen camera"
    );
    session.press('z');
    session.until("free again", |state| {
        state["frozen"] == false
            && number(&state["scenes"]) > scenes
            && number(&state["vertices"]) < number(&vertices)
    });
    (0..3).for_each(|_| session.press('a'));
    session.press('4');
    session.until("one level again", |state| {
        state["cut"]["adaptive"].is_null()
    });
}

fn compares(session: &Session) {
    let before = session.scene();
    session.press('s');
    session.until("split", |state| {
        state["compare"]["beside"] == "split" && state["models"][0]["methods"][1] == "flat"
    });
    let split = other(session, &before, "split");
    let [x, y, width, height] = session.place("split");
    let from = [x + 0.5 * width, y + 0.3 * height];
    session.hand.drag(1, from, [from[0] - 60.0, from[1]]);
    session.until("dragged", |state| number(&state["compare"]["at"]) < 0.45);
    other(session, &split, "dragged");
    session.press('e');
    let state = session.until("errors are known", |state| {
        state["compare"]["greatest"]
            .as_array()
            .is_some_and(|all| all.len() == 2)
    });
    let greatest = &state["compare"]["greatest"];
    assert!(
        number(&greatest[0]) < 1e-6 && number(&greatest[1]) > 1e-3,
        "{greatest}"
    );
    other(session, &split, "a map");
    session.press('e');
    session.press('e');
    session.press('s');
    session.until("alone", |state| {
        state["compare"]["beside"] == "alone" && state["compare"]["map"].is_null()
    });
    let middle = session.area();
    let middle = [0, 1].map(|i| f64::from(middle[i]) + 0.5 * f64::from(middle[i + 2]));
    session.hand.to(middle[0], middle[1]);
    session.hand.to(middle[0] + 2.0, middle[1]);
    let state = session.until("numbers under the cursor", |state| {
        state["probe"].is_object()
    });
    assert!(
        number(&state["probe"]["error"]) < 0.01,
        "{}",
        state["probe"]
    );
}

fn changes(session: &Session) {
    session.press('d');
    session.until("edges are picked", |state| {
        let is_live = state["models"][0]["live"] == true;
        state["selection"]["tool"] == "edges" && state["look"]["cage"] == true && is_live
    });
    pick_an_edge(session);
    let state = session.state();
    let (creases, version) = (
        number(&state["models"][0]["creases"]),
        state["models"][0]["version"].clone(),
    );
    session.sooner_or_later("words about what came before have gone", |state| {
        state["notice"].is_null()
    });
    let before = session.scene();
    let [x, y, width, height] = session.place("sharpness");
    let middle = y + 0.5 * height;
    session
        .hand
        .drag(1, [x + 12.0, middle], [x + 0.5 * width, middle]);
    let state = session.until("sharper", |state| {
        number(&state["models"][0]["creases"]) != creases
            && state["models"][0]["version"] != version
    });
    assert_eq!(state["models"][0]["live"], true, "it was edited in place");
    assert_eq!(state["models"][0]["steps"][0], 1, "a drag is one step");
    other(session, &before, "sharper");
    session.control('z');
    session.until("undone", |state| {
        let model = &state["models"][0];
        number(&model["creases"]) == creases && model["steps"][1] == 1
    });
    let after = session.scene();
    assert!(after == before, "undone, the picture is as it was");
    session.control('y');
    session.until("made again", |state| state["models"][0]["steps"][0] == 1);
    session.control('s');
    let saved = session.file("box-edited-1.obj");
    let text = std::fs::read_to_string(saved).expect("it is text");
    assert!(text.matches("t crease").count() >= 4, "{text}");
    session.until("saved", |state| state["models"][0]["changed"] == false);
    session.control('z');
    session.until("undone again", |state| state["models"][0]["steps"][0] == 0);
    session.press('g');
    session.press('q');
    session.hand.key(keys::ESCAPE, &[]);
    session.until("nothing is picked", |state| {
        state["selection"]["edges"]
            .as_array()
            .is_some_and(Vec::is_empty)
            && state["selection"]["tool"] == "look"
            && state["look"]["cage"] == false
    });
}

/// Clicks from the middle outwards until an edge is picked.
pub fn pick_an_edge(session: &Session) {
    let [x, y, width, height] = session.area().map(f64::from);
    for step in 0..40 {
        let frames = session.state()["frames"].as_u64();
        let at = [x + 0.5 * width, y + (0.5 - 0.01 * f64::from(step)) * height];
        session.hand.click(at);
        let is_seen = |state: &Value| state["frames"].as_u64() > frames;
        let state = session.until("the click is seen", is_seen);
        let edges = state["selection"]["edges"].as_array();
        if edges.is_some_and(|edges| edges.len() == 1) {
            return;
        }
    }
    panic!("no edge was met: {:#}", session.state());
}

fn saves_the_same_picture(session: &Session) {
    session.press('4');
    let seen = session.picture();
    session.hand.key(keys::F12, &[]);
    let shot = read_png(&session.file("hullform-1.png"));
    let [x, y, width, height] = session.area();
    let upper = [x, y, width, height / 2];
    assert!(
        seen.part(upper).difference(&shot.part(upper), true) == 0.0,
        "a screenshot is what is seen"
    );
    session.until("saved", |_| true);
    session.hand.key(keys::F12, &[keys::SHIFT]);
    let rendered = session.file("hullform-2.png");
    session.control('c');
    let state = session.until("copied", |state| state["copied"].is_string());
    let line = state["copied"]
        .as_str()
        .expect("a command line")
        .to_string();
    let program = env!("CARGO_BIN_EXE_hullform");
    let line = line.replacen("hullform ", &format!("{program} "), 1);
    let done = Command::new("sh")
        .args(["-c", &line])
        .current_dir(&session.folder)
        .status();
    assert!(done.expect("a shell").success(), "{line}");
    let again = read_png(&session.folder.join("hullform.png"));
    let rendered = read_png(&rendered);
    assert!(
        rendered == again,
        "the copied command line makes the same picture"
    );
    // Below stand words about what was saved.
    let scene = seen.part(upper);
    let apart = scene.difference(&rendered.part([0, 0, width, height / 2]), true);
    assert!(
        apart < 0.6,
        "and it is what is seen, but for finer edges: {apart}"
    );
}

fn reads_again(session: &Session) {
    let before = session.scene();
    let file = session.folder.join("box.obj");
    let version = session.state()["models"][0]["version"][0].clone();
    std::fs::write(&file, BOX.replace("v 1 1 1", "v 2 2 2")).expect("it is written");
    let state = session.until("what was undone is not lost", |state| {
        let words = state["notice"].as_str();
        words.is_some_and(|words| words.contains("box.obj has changed"))
    });
    assert_eq!(state["models"][0]["version"][0], version);
    session.hand.key(keys::F5, &[]);
    session.until("a word is asked for", |state| state["asked"] == true);
    session.hand.key(keys::ESCAPE, &[]);
    session.until("not now", |state| state["asked"] == false);
    session.hand.key(keys::F5, &[]);
    session.until("a word is asked for", |state| {
        state["asked"] == true && state["places"]["lose"].is_array()
    });
    let [x, y, width, height] = session.place("lose");
    session.hand.click([x + 0.5 * width, y + 0.5 * height]);
    session.until("read again", |state| {
        state["models"][0]["version"][0] != version
    });
    let changed = other(session, &before, "read again");
    std::fs::write(&file, BOX.replace("f 8 7 6 5", "f 8 7 6 99")).expect("it is written");
    let state = session.until("refused", |state| state["models"][0]["error"].is_string());
    let words = state["models"][0]["error"].as_str().unwrap_or_default();
    assert!(words.contains("box.obj:10"), "{words}");
    let [.., width, height] = session.area();
    let upper = [0, 0, width, height / 2];
    assert!(
        session.scene().part(upper) == changed.part(upper),
        "the last good picture stays"
    );
    std::fs::write(&file, BOX).expect("it is written");
    session.until("read again", |state| state["models"][0]["error"].is_null());
}

fn goes_along_with_the_window(session: &Session) {
    // Below stand words about what was read, for a while.
    let [.., width, height] = session.area();
    let upper = [0, 0, width, height / 2];
    let seen = session.scene().part(upper);
    assert!(seen.colours() > 100, "the surface is there as well");
    for (x, what) in [
        (900, "on both monitors"),
        (1420, "on the second one"),
        (0, "back"),
    ] {
        session.hand.place(session.window, [x, 0]);
        session.press('g');
        session.until("a cage", |state| state["look"]["cage"] == true);
        session.press('g');
        session.until("no cage", |state| state["look"]["cage"] == false);
        let now = session.scene().part(upper);
        assert!(now == seen, "{what} it is the same picture");
    }
    session.hand.resize(session.window, [900, 640]);
    session.until("smaller", |state| {
        state["window"] == serde_json::json!([900, 640])
    });
    assert_eq!(session.picture().size, [900, 640]);
    session.hand.show(session.window, false);
    session.press('f');
    std::thread::sleep(std::time::Duration::from_millis(200));
    session.hand.show(session.window, true);
    session.hand.focus(session.window);
    let frames = number(&session.state()["frames"]);
    session.press('1');
    session.until("back again", |state| {
        number(&state["camera"]["yaw"]) == 0.0 && number(&state["frames"]) > frames
    });
    assert!(session.scene().colours() > 100);
}
