//! A display that nobody sees, and a hand on its mouse and keys.

use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    self, ClientMessageEvent, ConfigureWindowAux, ConnectionExt as _, ImageFormat, InputFocus,
    Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Size of the screen: that of two monitors side by side, which are one screen in X.
const SCREEN: &str = "2800x1000x24";

/// A server of X11 without a screen.
pub struct Display {
    server: Child,
    /// As the variable DISPLAY names it.
    pub name: String,
}

impl Display {
    /// Starts one; None where it is not installed.
    pub fn start() -> Option<Display> {
        let mut command = Command::new("Xvfb");
        command.args([
            "-displayfd",
            "1",
            "-screen",
            "0",
            SCREEN,
            "-noreset",
            "-nolisten",
            "tcp",
        ]);
        let server = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut server = server.ok()?;
        let mut output = server.stdout.take().expect("its output is a pipe");
        let (mut name, mut byte) = (String::from(":"), [0]);
        while output.read(&mut byte).expect("it tells its number") == 1 && byte[0] != b'\n' {
            name.push(byte[0].into());
        }
        // It would die of a pipe that nobody reads.
        std::mem::forget(output);
        assert!(name.len() > 1, "Xvfb found no number for its display");
        Some(Display { server, name })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A hand on mouse and keys.
pub struct Hand {
    connection: RustConnection,
    root: Window,
    /// By key code: what stands on the keys, without and with shift.
    keys: Vec<[u32; 2]>,
    first: u8,
}

impl Hand {
    pub fn new(display: &Display) -> Hand {
        let (connection, screen) = x11rb::connect(Some(&display.name)).expect("the display runs");
        let setup = connection.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        let root = setup.roots[screen].root;
        let asked = connection.get_keyboard_mapping(first, last - first + 1);
        let mapping = asked.expect("it is asked").reply().expect("it answers");
        let each = usize::from(mapping.keysyms_per_keycode);
        let keys = mapping
            .keysyms
            .chunks(each)
            .map(|all| [all[0], *all.get(1).unwrap_or(&0)]);
        Hand {
            keys: keys.collect(),
            first,
            root,
            connection,
        }
    }

    /// The window that a program has opened: the only one there is.
    pub fn window(&self) -> Option<Window> {
        let tree = self.connection.query_tree(self.root).ok()?.reply().ok()?;
        let shown = |&window: &Window| {
            let asked = self
                .connection
                .get_window_attributes(window)
                .ok()?
                .reply()
                .ok()?;
            let size = self.connection.get_geometry(window).ok()?.reply().ok()?;
            (asked.map_state == xproto::MapState::VIEWABLE && size.width > 100).then_some(window)
        };
        tree.children.iter().find_map(shown)
    }

    /// Gives keys to a window. One that was away is there again a moment after it was asked to be.
    pub fn focus(&self, window: Window) {
        let asked = || {
            let time = x11rb::CURRENT_TIME;
            let asked = self
                .connection
                .set_input_focus(InputFocus::PARENT, window, time);
            asked.expect("it is asked").check()
        };
        let tries = (0..1000).map(|_| {
            std::thread::sleep(Duration::from_millis(20));
            asked()
        });
        let done = tries.into_iter().find(Result::is_ok);
        assert!(done.is_some(), "the window takes no keys");
    }

    fn fake(&self, kind: u8, detail: u8, x: i16, y: i16) {
        let done = self
            .connection
            .xtest_fake_input(kind, detail, 0, self.root, x, y, 0);
        done.expect("it is asked")
            .check()
            .expect("the display takes input");
    }

    /// Moves the mouse.
    pub fn to(&self, x: f64, y: f64) {
        self.fake(
            xproto::MOTION_NOTIFY_EVENT,
            0,
            x.round() as i16,
            y.round() as i16,
        );
        std::thread::sleep(Duration::from_millis(12));
    }

    /// Presses or releases a button of the mouse.
    pub fn button(&self, number: u8, down: bool) {
        let kind = if down {
            xproto::BUTTON_PRESS_EVENT
        } else {
            xproto::BUTTON_RELEASE_EVENT
        };
        self.fake(kind, number, 0, 0);
        std::thread::sleep(Duration::from_millis(25));
    }

    /// Drags from one place to another, in steps.
    pub fn drag(&self, number: u8, from: [f64; 2], to: [f64; 2]) {
        self.to(from[0], from[1]);
        self.button(number, true);
        for step in 1..=8 {
            let share = f64::from(step) / 8.0;
            let at = |i: usize| from[i] + share * (to[i] - from[i]);
            self.to(at(0), at(1));
            std::thread::sleep(Duration::from_millis(20));
        }
        self.button(number, false);
    }

    pub fn click(&self, at: [f64; 2]) {
        self.to(at[0], at[1]);
        self.button(1, true);
        self.button(1, false);
    }

    /// Presses a key by its symbol (X11's number), with shift where it stands above another, and what else is held.
    pub fn key(&self, symbol: u32, held: &[u32]) {
        let Some((code, shifted)) = self.code(symbol) else {
            panic!("no key has the symbol {symbol:#x}");
        };
        let shift = [0xffe1u32];
        let also = if shifted { &shift[..] } else { &[] };
        let codes = held
            .iter()
            .chain(also)
            .filter_map(|&s| Some(self.code(s)?.0));
        let codes: Vec<u8> = codes.chain([code]).collect();
        for &code in &codes {
            self.fake(xproto::KEY_PRESS_EVENT, code, 0, 0);
        }
        for &code in codes.iter().rev() {
            self.fake(xproto::KEY_RELEASE_EVENT, code, 0, 0);
        }
        std::thread::sleep(Duration::from_millis(15));
    }

    fn code(&self, symbol: u32) -> Option<(u8, bool)> {
        let of = |place: usize| self.keys.iter().position(|both| both[place] == symbol);
        let plain = of(0).map(|at| (at, false));
        let (at, shifted) = plain.or_else(|| of(1).map(|at| (at, true)))?;
        Some((self.first + at as u8, shifted))
    }

    /// What is seen of a window: its size, and pixels of blue, green, red and nothing.
    pub fn picture(&self, window: Window) -> ([u32; 2], Vec<u8>) {
        let size = self.connection.get_geometry(window).expect("it is asked");
        let size = size.reply().expect("the window is there");
        let (width, height) = (size.width, size.height);
        let format = ImageFormat::Z_PIXMAP;
        let image = self
            .connection
            .get_image(format, window, 0, 0, width, height, !0);
        let image = image
            .expect("it is asked")
            .reply()
            .expect("the window is seen");
        ([u32::from(width), u32::from(height)], image.data)
    }

    pub fn resize(&self, window: Window, [width, height]: [u32; 2]) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        let done = self.connection.configure_window(window, &size);
        done.expect("it is asked")
            .check()
            .expect("the window is there");
    }

    /// Moves a window.
    pub fn place(&self, window: Window, [x, y]: [i32; 2]) {
        let place = ConfigureWindowAux::new().x(x).y(y);
        let done = self.connection.configure_window(window, &place);
        done.expect("it is asked")
            .check()
            .expect("the window is there");
    }

    /// Takes a window from the screen, as window managers do when they minimise it, or brings it back.
    pub fn show(&self, window: Window, shown: bool) {
        let done = match shown {
            true => self.connection.map_window(window),
            false => self.connection.unmap_window(window),
        };
        done.expect("it is asked")
            .check()
            .expect("the window is there");
    }

    /// Asks a window to close, as window managers do (ICCCM, "Window Deletion").
    pub fn close(&self, window: Window) {
        let atom = |name: &str| {
            let asked = self.connection.intern_atom(false, name.as_bytes());
            asked
                .expect("it is asked")
                .reply()
                .expect("it has a number")
                .atom
        };
        let data = [atom("WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
        let message = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
        let mask = xproto::EventMask::NO_EVENT;
        let done = self.connection.send_event(false, window, mask, message);
        done.expect("it is asked")
            .check()
            .expect("the window is there");
    }
}
