//! Surfaces and devices that are lost, by a driver that fails on purpose: the window goes on with what it showed, or ends with what was changed saved.

use failing_driver::{FailingDriver, Fault};
use hullform::ash::vk;

use super::{BOX, display};
use crate::display::Display;
use crate::steps::pick_an_edge;
use crate::window::{Session, keys};

/// The frame whose call fails: by then an edge is picked and changed.
const LATER: u32 = 250;

struct Place {
    display: Display,
    folder: tempfile::TempDir,
    driver: FailingDriver,
}

impl Place {
    fn new() -> Option<Place> {
        let display = display()?;
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("box.obj"), BOX).expect("it is written");
        let driver = FailingDriver::install(folder.path());
        Some(Place {
            display,
            folder,
            driver,
        })
    }

    fn open(&self, fault: &Fault) -> Session {
        let options = ["--fresh", "box.obj"];
        Session::open_with(&self.display, self.folder.path(), &options, |command| {
            self.driver.apply(command, fault);
        })
    }

    /// Closes a window that has come through, and sees that nothing was left over.
    fn close(&self, session: Session) {
        session.quit();
        let (code, words) = session.end();
        assert_eq!(code, Some(0), "{words}");
        for report in self.driver.reports() {
            assert!(report.fired && report.left.is_empty(), "{:?}", report.left);
        }
    }
}

/// Makes the top edge infinitely sharp, or another.
fn change(session: &Session) {
    session.press('d');
    session.until("edges are picked", |state| {
        state["selection"]["tool"] == "edges"
    });
    pick_an_edge(session);
    session.press('i');
    session.until("changed", |state| state["models"][0]["steps"][0] == 1);
}

/// Moves the mouse until something is so: each step is a frame.
fn stir(session: &Session, what: &str, is_so: impl Fn(&serde_json::Value) -> bool) {
    for step in 0..4000 {
        session.hand.to(400.0 + f64::from(step % 50), 300.0);
        session.press(if step % 2 == 0 { '1' } else { '4' });
        if is_so(&session.state()) {
            return;
        }
    }
    panic!("{what}: never, but {:#}", session.state());
}

fn told(words: &'static str) -> impl Fn(&serde_json::Value) -> bool {
    move |state| {
        state["notice"]
            .as_str()
            .is_some_and(|notice| notice.contains(words))
    }
}

/// On a display of which all formats encode what shaders write, too.
#[test]
fn a_lost_surface_is_made_anew_and_the_picture_comes_back() {
    let Some(place) = Place::new() else { return };
    let lost = vk::Result::ERROR_SURFACE_LOST_KHR;
    let usual = place.open(&Fault::Nothing);
    usual.press('1');
    let seen = usual.scene();
    usual.quit();
    usual.end();
    place.driver.reports();
    let encoding = place.open(&Fault::Encode);
    encoding.press('1');
    assert!(encoding.scene() == seen, "encoded by the display's images");
    place.close(encoding);
    for call in ["vkAcquireNextImageKHR", "vkQueuePresentKHR"] {
        let session = place.open(&Fault::once(call, 25, lost));
        stir(&session, call, told("made anew"));
        session.press('1');
        session.sooner_or_later("words have gone", |state| state["notice"].is_null());
        assert!(session.scene() == seen, "{call}: it is the same picture");
        place.close(session);
    }
}

#[test]
fn a_lost_device_is_opened_anew_with_all_that_was_changed() {
    for call in ["vkQueuePresentKHR", "vkQueueSubmit"] {
        loses_the_device(call);
    }
}

fn loses_the_device(call: &str) {
    let Some(place) = Place::new() else { return };
    let lost = vk::Result::ERROR_DEVICE_LOST;
    let session = place.open(&Fault::once(call, LATER, lost));
    change(&session);
    stir(&session, call, told("opened anew"));
    let state = session.until("drawn again", |state| {
        state["vertices"].as_u64() > Some(0) && state["models"][0]["methods"].is_array()
    });
    assert_eq!(
        state["models"][0]["steps"],
        serde_json::json!([1, 0]),
        "{state:#}"
    );
    assert_eq!(state["models"][0]["changed"], true);
    assert!(session.scene().colours() > 100, "it is drawn");
    session.control('z');
    session.until("undone", |state| state["models"][0]["changed"] == false);
    place.close(session);
}

#[test]
fn a_device_that_stays_lost_is_the_end_with_what_was_changed_saved() {
    let Some(place) = Place::new() else { return };
    let fault = Fault::Fail {
        calls: vec!["vkQueuePresentKHR".into()],
        occurrence: LATER,
        code: vk::Result::ERROR_DEVICE_LOST,
        lasting: true,
    };
    let mut session = place.open(&fault);
    change(&session);
    for step in 0..4000 {
        if !session.runs() {
            break;
        }
        session.hand.to(400.0 + f64::from(step % 50), 300.0);
        session.hand.key(keys::ESCAPE, &[]);
    }
    let file = session.file("box-edited-1.obj");
    let (code, words) = session.end();
    assert_eq!(code, Some(1), "{words}");
    assert!(
        words.contains("box-edited-1.obj") && words.contains("DEVICE_LOST"),
        "{words}"
    );
    assert!(!words.contains("panicked"), "{words}");
    let text = std::fs::read_to_string(file).expect("it is text");
    assert!(
        text.contains(" 10\n"),
        "an edge is infinitely sharp: {text}"
    );
}
