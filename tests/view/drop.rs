//! Files that are dropped on a window by another program (XDND, version 5).

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::display::Display;

/// How long the other side may take.
const PATIENCE: Duration = Duration::from_secs(20);

/// A program that has files to give.
struct Source {
    connection: RustConnection,
    own: Window,
    files: Vec<PathBuf>,
}

/// Drops files on a window.
pub fn drop_files(display: &Display, window: Window, files: &[&Path]) {
    let (connection, screen) = x11rb::connect(Some(&display.name)).expect("the display runs");
    let root = connection.setup().roots[screen].root;
    let own = connection.generate_id().expect("there are numbers left");
    let aux = CreateWindowAux::new();
    let (class, depth) = (WindowClass::INPUT_ONLY, 0);
    connection
        .create_window(depth, own, root, 0, 0, 1, 1, 0, class, 0, &aux)
        .expect("it is asked")
        .check()
        .expect("a window is made");
    let source = Source {
        connection,
        own,
        files: files.iter().map(|file| file.to_path_buf()).collect(),
    };
    let [selection, list, copy] =
        ["XdndSelection", "text/uri-list", "XdndActionCopy"].map(|name| source.atom(name));
    let owned = source
        .connection
        .set_selection_owner(own, selection, x11rb::CURRENT_TIME);
    owned.expect("it is asked").check().expect("it is ours");
    source.say(window, "XdndEnter", [5 << 24, list, 0, 0]);
    source.say(
        window,
        "XdndPosition",
        [0, 400 << 16 | 300, x11rb::CURRENT_TIME, copy],
    );
    source.until("it asks what is dropped and takes it", |event| {
        matches!(event, Event::SelectionRequest(_))
    });
    source.say(window, "XdndDrop", [0, x11rb::CURRENT_TIME, 0, 0]);
    let finished = source.atom("XdndFinished");
    source.until(
        "it has them",
        |event| matches!(event, Event::ClientMessage(message) if message.type_ == finished),
    );
}

impl Source {
    fn atom(&self, name: &str) -> Atom {
        let asked = self.connection.intern_atom(false, name.as_bytes());
        let answer = asked.expect("it is asked").reply();
        answer.expect("it has a number").atom
    }

    /// Tells a window something, of which it may know the rest.
    fn say(&self, window: Window, what: &str, rest: [u32; 4]) {
        let [a, b, c, d] = rest;
        let message = ClientMessageEvent::new(32, window, self.atom(what), [self.own, a, b, c, d]);
        let sent = self
            .connection
            .send_event(false, window, EventMask::NO_EVENT, message);
        sent.expect("it is asked")
            .check()
            .expect("the window is there");
    }

    /// Answers until something comes.
    fn until(&self, what: &str, is_it: impl Fn(&Event) -> bool) {
        let started = Instant::now();
        loop {
            assert!(started.elapsed() < PATIENCE, "{what}: never");
            let Some(event) = self.connection.poll_for_event().expect("the display runs") else {
                std::thread::sleep(Duration::from_millis(2));
                continue;
            };
            if let Event::SelectionRequest(request) = &event {
                self.give(request);
            }
            if is_it(&event) {
                return;
            }
        }
    }

    /// Gives the names of the files (RFC 2483, text/uri-list).
    fn give(&self, request: &SelectionRequestEvent) {
        let lines = self
            .files
            .iter()
            .map(|file| format!("file://{}\r\n", file.display()));
        let text: String = lines.collect();
        let (to, property) = (request.requestor, request.property);
        let mode = PropMode::REPLACE;
        let given =
            self.connection
                .change_property8(mode, to, property, request.target, text.as_bytes());
        given
            .expect("it is asked")
            .check()
            .expect("the window takes it");
        let answer = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: to,
            selection: request.selection,
            target: request.target,
            property,
        };
        let sent = self
            .connection
            .send_event(false, to, EventMask::NO_EVENT, answer);
        sent.expect("it is asked")
            .check()
            .expect("the window is there");
    }
}
