//! Whatever comes in: the window neither breaks down nor stands still, and the validation layer has nothing to say.

use std::time::{Duration, Instant};

use super::{BOX, display};
use crate::window::Session;

/// So long without being told otherwise; an hour is `HULLFORM_VIEW_SECONDS=3600`.
const SECONDS: u64 = 10;

/// MiB that the program takes at most, however long it runs. The validation layer is in it, and what a software driver compiles.
const GREATEST_MEMORY: u64 = 1200;

/// A row of numbers that looks random (Knuth, MMIX).
struct Random(u64);

impl Random {
    fn below(&mut self, most: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) as u32) % most
    }
}

/// Keys that do something; those that save, close or leave the folder aside.
const SIGNS: &str = "f1234ocwgn+-mMbrlazkksSexqvdpihyc[].?";

#[test]
fn random_input_breaks_nothing() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("box.obj"), BOX).expect("it is written");
    let mut session = Session::open(&display, folder.path(), &["box.obj", "builtin:cube"]);
    let asked = std::env::var("HULLFORM_VIEW_SECONDS")
        .ok()
        .and_then(|text| text.parse().ok());
    let started = Instant::now();
    let end = started + Duration::from_secs(asked.unwrap_or(SECONDS));
    let mut random = Random(7);
    let mut minutes = 0;
    while Instant::now() < end {
        one(&mut session, &mut random);
        if started.elapsed().as_secs() / 60 > minutes {
            minutes += 1;
            println!("after {minutes} min: {} MiB", session.memory());
        }
        if !session.runs() {
            let (code, words) = session.end();
            panic!("it has ended: {code:?} {words}");
        }
    }
    session.hand.resize(session.window, [1100, 700]);
    session.hand.show(session.window, true);
    session.hand.focus(session.window);
    let frames = session.state()["frames"].as_u64();
    session.press('f');
    session.press('1');
    // Something may play by now: then there is always something left to do.
    let state = session.sooner_or_later("it answers", |state| state["frames"].as_u64() > frames);
    assert_eq!(state["validation"], 0, "{state:#}");
    let memory = session.memory();
    assert!(memory < GREATEST_MEMORY, "{memory} MiB");
    session.quit();
    let (code, words) = session.end();
    assert!(
        code == Some(0) && !words.contains("panicked"),
        "{code:?} {words}"
    );
}

fn one(session: &mut Session, random: &mut Random) {
    let hand = &session.hand;
    let at = |random: &mut Random| [f64::from(random.below(1100)), f64::from(random.below(700))];
    match random.below(20) {
        0..7 => {
            let sign = random.below(SIGNS.len() as u32) as usize;
            session.press(SIGNS.as_bytes()[sign].into());
        }
        7..11 => hand.click(at(random)),
        11..16 => {
            let button = 1 + random.below(3) as u8;
            hand.drag(button, at(random), at(random));
        }
        16 => {
            let button = 4 + random.below(2) as u8;
            hand.button(button, true);
            hand.button(button, false);
        }
        17 => session.control(if random.below(2) == 0 { 'z' } else { 'y' }),
        18 => {
            let size = [200 + random.below(1000), 150 + random.below(700)];
            hand.resize(session.window, size);
        }
        _ => {
            hand.show(session.window, false);
            std::thread::sleep(Duration::from_millis(30));
            hand.show(session.window, true);
            hand.focus(session.window);
        }
    }
}
