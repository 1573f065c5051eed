//! A window of the program, its state, and what is seen of it.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::display::{Display, Hand};

/// How long anything may take: software draws, and machines are busy.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long a picture that rests does not change.
const MOMENT: Duration = Duration::from_millis(250);

/// Keys by the numbers that X11 has for their symbols.
pub mod keys {
    pub const CONTROL: u32 = 0xffe3;
    pub const SHIFT: u32 = 0xffe1;
    pub const F5: u32 = 0xffc2;
    pub const F12: u32 = 0xffc9;
    pub const ESCAPE: u32 = 0xff1b;
    pub const TAB: u32 = 0xff09;
}

/// A program with a window.
pub struct Session {
    program: Child,
    pub hand: Hand,
    pub window: u32,
    /// Where it works, and writes.
    pub folder: PathBuf,
    log: PathBuf,
}

/// What is seen: its size, and four bytes a pixel.
#[derive(Clone, PartialEq)]
pub struct Picture {
    pub size: [u32; 2],
    pub pixels: Vec<u8>,
}

impl Picture {
    /// A part of it.
    pub fn part(&self, [x, y, width, height]: [u32; 4]) -> Picture {
        let row = |row: u32| {
            let start = 4 * ((y + row) * self.size[0] + x) as usize;
            &self.pixels[start..start + 4 * width as usize]
        };
        Picture {
            size: [width, height],
            pixels: (0..height).flat_map(row).copied().collect(),
        }
    }

    /// The mean difference of colours from another, in steps of 255. Blue and red may have changed places in that.
    pub fn difference(&self, other: &Picture, turned: bool) -> f64 {
        assert_eq!(self.size, other.size);
        let pairs = self.pixels.chunks(4).zip(other.pixels.chunks(4));
        let sum: u64 = pairs
            .map(|(a, b)| {
                let channel = |c: usize| if turned { b[2 - c] } else { b[c] };
                (0..3)
                    .map(|c| u64::from(a[c].abs_diff(channel(c))))
                    .sum::<u64>()
            })
            .sum();
        sum as f64 / (3 * self.size[0] * self.size[1]) as f64
    }

    /// How many colours it has.
    pub fn colours(&self) -> usize {
        let all: std::collections::BTreeSet<&[u8]> =
            self.pixels.chunks(4).map(|p| &p[..3]).collect();
        all.len()
    }
}

impl Session {
    /// Opens a window on models, in a folder, watched by the validation layer.
    pub fn open(display: &Display, folder: &Path, arguments: &[&str]) -> Session {
        let arguments = [&["--validation", "--size", "1100x700"], arguments].concat();
        Session::open_with(display, folder, &arguments, |_| {})
    }

    /// Opens a window, by a command that is changed before it starts.
    pub fn open_with(
        display: &Display,
        folder: &Path,
        arguments: &[&str],
        with: impl FnOnce(&mut Command),
    ) -> Session {
        let log = folder.join("state.jsonl");
        let home = folder.join("home");
        let mut command = Command::new(env!("CARGO_BIN_EXE_hullform"));
        command
            .args(["view", "--log"])
            .arg(&log)
            .args(arguments)
            .current_dir(folder)
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_CONFIG_HOME", home.join("config"))
            .env("XDG_CACHE_HOME", home.join("cache"))
            .stderr(Stdio::piped());
        with(&mut command);
        let program = command.spawn().expect("the program starts");
        let hand = Hand::new(display);
        let started = Instant::now();
        let window = loop {
            if let Some(window) = hand.window() {
                break window;
            }
            assert!(started.elapsed() < PATIENCE, "no window came");
            std::thread::sleep(Duration::from_millis(20));
        };
        let session = Session {
            program,
            hand,
            window,
            folder: folder.into(),
            log,
        };
        session.until("something is drawn", |state| {
            state["vertices"].as_u64() > Some(0)
        });
        session.hand.focus(window);
        session
    }

    /// The last state that was written whole.
    pub fn state(&self) -> Value {
        let text = std::fs::read_to_string(&self.log).unwrap_or_default();
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let last = whole.rsplit('\n').next().unwrap_or_default();
        serde_json::from_str(last).unwrap_or_default()
    }

    /// Waits for a state with nothing left to do.
    pub fn until(&self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        self.sooner_or_later(what, |state| state["settled"] == true && is_so(state))
    }

    /// Waits for a state.
    pub fn sooner_or_later(&self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let started = Instant::now();
        loop {
            let state = self.state();
            if is_so(&state) {
                return state;
            }
            assert!(started.elapsed() < PATIENCE, "{what}: never, but {state:#}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses a key that has a letter or sign on it.
    pub fn press(&self, sign: char) {
        self.hand.key(sign.into(), &[]);
    }

    /// The same with control held.
    pub fn control(&self, sign: char) {
        self.hand.key(sign.into(), &[keys::CONTROL]);
    }

    /// What is seen once it does not change any more.
    pub fn picture(&self) -> Picture {
        let started = Instant::now();
        let mut last = None;
        loop {
            let frames = self.state()["frames"].clone();
            let (size, pixels) = self.hand.picture(self.window);
            let now = Picture { size, pixels };
            let settled = self.state()["settled"] == true;
            if settled && last.as_ref() == Some(&(frames.clone(), now.clone())) {
                return now;
            }
            last = Some((frames, now));
            assert!(started.elapsed() < PATIENCE, "the picture never rests");
            std::thread::sleep(MOMENT);
        }
    }

    /// What is seen of the scene alone, without what is written in its lower part.
    pub fn scene(&self) -> Picture {
        let [x, y, width, height] = self.area();
        self.picture().part([x, y, width, height])
    }

    /// The scene's area, in pixels.
    pub fn area(&self) -> [u32; 4] {
        let area = self.state()["area"].clone();
        [0, 1, 2, 3].map(|i| area[i].as_u64().expect("a number") as u32)
    }

    /// The middle of something that the state names a place of.
    pub fn place(&self, name: &str) -> [f64; 4] {
        let place = self.state()["places"][name].clone();
        [0, 1, 2, 3].map(|i| {
            place[i]
                .as_f64()
                .unwrap_or_else(|| panic!("{name} has a place"))
        })
    }

    /// Waits for a file, whole, in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        let path = self.folder.join(name);
        let started = Instant::now();
        while !path.exists() {
            assert!(
                started.elapsed() < PATIENCE,
                "{name} was not written: {:#}",
                self.state()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        path
    }

    /// Asks the window to close.
    pub fn quit(&self) {
        self.hand.close(self.window);
    }

    /// Waits for the end: the exit code, and what it said. Where there is a question before it, what was changed is lost.
    pub fn end(mut self) -> (Option<i32>, String) {
        let started = Instant::now();
        while self.runs() {
            if started.elapsed() > PATIENCE {
                let _ = self.program.kill();
                panic!("the program does not end: {:#}", self.state());
            }
            let state = self.state();
            if state["asked"] == true && state["places"]["lose"].is_array() {
                let [x, y, width, height] = self.place("lose");
                self.hand.click([x + 0.5 * width, y + 0.5 * height]);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let output = self.program.wait_with_output().expect("it has ended");
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), words)
    }

    /// MiB that it has in memory.
    pub fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.program.id()));
        let status = status.expect("it runs");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kib = line.and_then(|rest| rest.trim().split(' ').next()?.parse::<u64>().ok());
        kib.expect("the system tells") / 1024
    }

    /// Whether it still runs.
    pub fn runs(&mut self) -> bool {
        self.program
            .try_wait()
            .expect("it can be waited for")
            .is_none()
    }
}

/// A picture from a file, four bytes a pixel, red first.
pub fn read_png(path: &Path) -> Picture {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("there is a picture"));
    let mut reader = png::Decoder::new(file)
        .read_info()
        .expect("it is a picture");
    let mut bytes = vec![0; reader.output_buffer_size().expect("it fits")];
    let info = reader.next_frame(&mut bytes).expect("it has pixels");
    let each = info.color_type.samples();
    let pixels = bytes
        .chunks(each)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255]);
    Picture {
        size: [info.width, info.height],
        pixels: pixels.collect(),
    }
}
