//! Shaders whose text changes while they are looked at.

use std::path::Path;

use hullform::gpu::shaders::{SOURCES, source};

use super::{BOX, display};
use crate::window::Session;

fn write(folder: &Path, file: &str, text: &str) {
    let path = folder.join(file);
    std::fs::create_dir_all(path.parent().expect("it lies in a folder")).expect("it is made");
    std::fs::write(path, text).expect("it is written");
}

#[test]
fn shaders_are_compiled_anew_and_what_is_wrong_leaves_the_last_good_picture() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("box.obj"), BOX).expect("it is written");
    let shaders = folder.path().join("glsl");
    for (file, text) in SOURCES {
        write(&shaders, file, text);
    }
    let session = Session::open(&display, folder.path(), &["--glsl", "glsl", "box.obj"]);
    session.sooner_or_later("words have gone", |state| state["notice"].is_null());
    let first = session.scene();
    let version = || session.state()["shaders"]["version"].as_u64();

    let unit = source("lib/unit.glsl").expect("it is one of ours");
    write(&shaders, "lib/unit.glsl", &format!("{unit}\nno shader;\n"));
    let line = unit.lines().count() + 2;
    let state = session.until("refused", |state| state["shaders"]["error"].is_string());
    let words = state["shaders"]["error"].as_str().expect("it is");
    assert!(
        words.starts_with(&format!("glsl/lib/unit.glsl:{line}: ")),
        "{words}"
    );
    let [.., width, height] = session.area();
    let upper = [0, 0, width, height / 2];
    assert!(
        session.scene().part(upper) == first.part(upper),
        "the last good picture stays"
    );

    write(&shaders, "lib/unit.glsl", unit);
    session.until("mended", |state| state["shaders"]["error"].is_null());
    session.sooner_or_later("words have gone", |state| state["notice"].is_null());
    assert!(session.scene() == first, "mended, all is as it was");

    let before = version();
    let fragment = source("surface.frag").expect("it is one of ours");
    let end = fragment.rfind('}').expect("it has a function");
    let dark = format!("{}    out_colour.rgb *= 0.25;\n}}\n", &fragment[..end]);
    write(&shaders, "surface.frag", &dark);
    session.until("darker", |state| {
        state["shaders"]["version"].as_u64() > before
    });
    let apart = session.scene().difference(&first, false);
    assert!(apart > 5.0, "the picture follows: {apart}");

    // What fills the cache is no part of any pipeline that draws.
    let before = version();
    write(&shaders, "surface.frag", fragment);
    let filling = source("surface.comp").expect("it is one of ours");
    write(
        &shaders,
        "surface.comp",
        &format!("{filling}\n// other text, the same meaning\n"),
    );
    session.until("as it was", |state| {
        state["shaders"]["version"].as_u64() > before
    });
    session.sooner_or_later("words have gone", |state| state["notice"].is_null());
    assert!(session.scene() == first, "the picture is as it was");
    assert_eq!(session.state()["validation"], 0);
    session.quit();
    let (code, words) = session.end();
    assert_eq!(code, Some(0), "{words}");
}
