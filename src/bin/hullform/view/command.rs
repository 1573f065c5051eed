//! What keys and buttons do, and which keys.

mod edits;

use std::mem::discriminant;

use egui::{Key, Modifiers};
use hullform::gpu::{Backend, Residence};
use hullform::mesh::Scheme;
use hullform::method::METHODS;
use hullform::tessellation::Spacing;

use super::orbit::Preset;
use super::selection::Tool;
use super::viewer::{Beside, ErrorKind, Intent, Viewer, Wish};
use crate::adaptive::Adaptive;
use crate::render::Shading;

/// Something to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Shows everything.
    Fit,
    /// Looks from a direction.
    Look(Preset),
    /// Turns by degrees, to the left and up.
    Turn(f64, f64),
    /// Comes nearer by a factor.
    Nearer(f64),
    /// Parallel lines of sight, or not.
    Orthographic,
    /// Other colours.
    Shading,
    /// The triangles' edges.
    Wireframe,
    /// The control cage.
    Cage,
    /// Numbers of vertices and faces.
    Numbers,
    /// A level more or less.
    Level(f32),
    /// The next method.
    Method,
    /// The next scheme.
    Scheme,
    /// The next back-end.
    Backend,
    /// The other residence.
    Residence,
    /// The other spacing.
    Spacing,
    /// Levels by the picture, or not.
    Adaptive,
    /// What is left out.
    Cull,
    /// Stops the camera that cuts, or lets it go.
    Freeze,
    /// Two methods, parted by a line.
    Split,
    /// Two methods, side by side.
    SideBySide,
    /// The next map of errors.
    ErrorMap,
    /// Moves odd vertices.
    Amplify,
    /// What clicks pick.
    Pick(Tool),
    /// Sharper or smoother.
    Sharpen(f32),
    /// As sharp as can be, or smooth.
    Infinite,
    /// Holes, or not.
    Hole,
    /// Picks nothing.
    Unpick,
    /// A step back.
    Undo,
    /// A step ahead.
    Redo,
    /// Saves the model.
    Save,
    /// Lets the deformation run, or stops it.
    Play,
    /// Saves what is seen.
    Screenshot,
    /// Saves what `render` makes of it.
    Render,
    /// Copies the command line.
    CopyLine,
    /// The next file of the folder, or the one before.
    Neighbour(bool),
    /// Reads files again.
    Reload,
    /// Shows or hides panels.
    Panels,
    /// Shows or hides the keys.
    Sheet,
    /// Ends.
    Quit,
}

/// A key with what it does.
pub struct Binding {
    /// Held down with it.
    pub modifiers: Modifiers,
    /// The key.
    pub key: Key,
    /// What it does.
    pub command: Command,
    /// The same in words.
    pub words: &'static str,
}

const fn held(modifiers: Modifiers, key: Key, command: Command, words: &'static str) -> Binding {
    Binding {
        modifiers,
        key,
        command,
        words,
    }
}

const fn plain(key: Key, command: Command, words: &'static str) -> Binding {
    held(Modifiers::NONE, key, command, words)
}

/// All keys, in the order in which they are told.
pub const KEYS: &[Binding] = &[
    plain(Key::F, Command::Fit, "show all"),
    plain(Key::Num1, Command::Look(Preset::Front), "from the front"),
    plain(Key::Num2, Command::Look(Preset::Side), "from the side"),
    plain(Key::Num3, Command::Look(Preset::Top), "from the top"),
    plain(
        Key::Num4,
        Command::Look(Preset::ThreeQuarter),
        "three-quarter view",
    ),
    plain(Key::ArrowLeft, Command::Turn(-10.0, 0.0), "turn left"),
    plain(Key::ArrowRight, Command::Turn(10.0, 0.0), "turn right"),
    plain(Key::ArrowUp, Command::Turn(0.0, 10.0), "turn up"),
    plain(Key::ArrowDown, Command::Turn(0.0, -10.0), "turn down"),
    plain(Key::PageUp, Command::Nearer(1.2), "nearer"),
    plain(Key::PageDown, Command::Nearer(1.0 / 1.2), "farther"),
    plain(Key::O, Command::Orthographic, "orthographic or perspective"),
    plain(Key::C, Command::Shading, "next colours"),
    plain(Key::W, Command::Wireframe, "wireframe"),
    plain(Key::G, Command::Cage, "control cage"),
    plain(Key::N, Command::Numbers, "numbers of the cage"),
    plain(Key::Plus, Command::Level(1.0), "finer"),
    plain(Key::Equals, Command::Level(1.0), "finer"),
    plain(Key::Minus, Command::Level(-1.0), "coarser"),
    plain(Key::M, Command::Method, "next method"),
    held(Modifiers::SHIFT, Key::M, Command::Scheme, "next scheme"),
    plain(Key::B, Command::Backend, "next back-end"),
    plain(Key::R, Command::Residence, "ring or cache"),
    plain(Key::L, Command::Spacing, "spacing"),
    plain(
        Key::A,
        Command::Adaptive,
        "levels by pixels, distance, curvature",
    ),
    plain(Key::K, Command::Cull, "culling"),
    plain(Key::Z, Command::Freeze, "freeze the camera that cuts"),
    plain(Key::S, Command::Split, "split with another method"),
    held(
        Modifiers::SHIFT,
        Key::S,
        Command::SideBySide,
        "side by side",
    ),
    plain(Key::E, Command::ErrorMap, "map of errors"),
    plain(Key::X, Command::Amplify, "amplify cracks"),
    plain(Key::Q, Command::Pick(Tool::Look), "pick nothing"),
    plain(Key::V, Command::Pick(Tool::Vertices), "pick vertices"),
    plain(Key::D, Command::Pick(Tool::Edges), "pick edges"),
    plain(Key::P, Command::Pick(Tool::Faces), "pick faces"),
    plain(Key::CloseBracket, Command::Sharpen(0.5), "sharper"),
    plain(Key::OpenBracket, Command::Sharpen(-0.5), "smoother"),
    plain(Key::I, Command::Infinite, "infinitely sharp, or smooth"),
    plain(Key::H, Command::Hole, "hole, or not"),
    plain(Key::Escape, Command::Unpick, "pick nothing"),
    held(Modifiers::COMMAND, Key::Z, Command::Undo, "undo"),
    held(Modifiers::COMMAND, Key::Y, Command::Redo, "redo"),
    held(
        Modifiers::COMMAND,
        Key::S,
        Command::Save,
        "save as OBJ with tags",
    ),
    plain(Key::Space, Command::Play, "play or pause"),
    plain(Key::F12, Command::Screenshot, "save what is seen"),
    held(
        Modifiers::SHIFT,
        Key::F12,
        Command::Render,
        "save what render makes of it",
    ),
    held(
        Modifiers::COMMAND,
        Key::C,
        Command::CopyLine,
        "copy the command line",
    ),
    plain(
        Key::Period,
        Command::Neighbour(true),
        "next file of the folder",
    ),
    plain(Key::Comma, Command::Neighbour(false), "the file before"),
    plain(Key::F5, Command::Reload, "read the files again"),
    // Taken before egui sees it.
    plain(Key::Tab, Command::Panels, "panels"),
    plain(Key::F1, Command::Sheet, "these keys (also ?)"),
    held(Modifiers::COMMAND, Key::Q, Command::Quit, "quit"),
];

/// The words for a key, as they stand on it.
pub fn key_words(binding: &Binding) -> String {
    let key = match binding.key {
        Key::ArrowLeft => "←",
        Key::ArrowRight => "→",
        Key::ArrowUp => "↑",
        Key::ArrowDown => "↓",
        Key::Equals => "=",
        other => other.symbol_or_name(),
    };
    let held = match binding.modifiers {
        Modifiers::SHIFT => "Shift+",
        Modifiers::COMMAND => "Ctrl+",
        _ => "",
    };
    format!("{held}{key}")
}

/// What an event means: the command of its key.
pub fn of_event(event: &egui::Event) -> Option<Command> {
    match event {
        egui::Event::Text(text) if text == "?" => Some(Command::Sheet),
        // egui takes these keys for its own.
        egui::Event::Copy => Some(Command::CopyLine),
        egui::Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } => {
            let fits = |binding: &&Binding| {
                binding.key == *key && modifiers.matches_exact(binding.modifiers)
            };
            // Plus stands above other keys on many keyboards.
            let any = |binding: &&Binding| *key == Key::Plus && binding.key == Key::Plus;
            let found = KEYS.iter().find(fits).or_else(|| KEYS.iter().find(any));
            found.map(|binding| binding.command)
        }
        _ => None,
    }
}

/// The element after another, around.
pub fn next<T: PartialEq + Copy>(all: &[T], one: T) -> T {
    let at = all.iter().position(|other| *other == one);
    all[at.map_or(0, |at| (at + 1) % all.len())]
}

/// All colours.
pub const SHADINGS: &[(Shading, &str)] = &[
    (Shading::Lit, "lit"),
    (Shading::Normal, "normals"),
    (Shading::Patch, "patches"),
    (Shading::Node, "node kinds"),
    (Shading::Valence, "valences"),
    (Shading::Level, "levels"),
    (Shading::Checker, "checker"),
    (Shading::Depth, "tree depth"),
    (Shading::Height, "bumps"),
];

/// All back-ends.
pub const BACKENDS: [Backend; 3] = [Backend::Tessellator, Backend::Pattern, Backend::Geometry];

/// What can be left out, one after the other, by the names of `--cull`.
const CULLINGS: [&str; 6] = ["none", "frustum", "back", "small", "all", "front"];

/// All schemes that can be chosen, and the model's own.
pub const SCHEMES: [Option<Scheme>; 6] = [
    None,
    Some(Scheme::CatmullClark),
    Some(Scheme::Loop),
    Some(Scheme::Butterfly),
    Some(Scheme::LoopStam),
    Some(Scheme::Bilinear),
];

/// All methods, and the model's own.
pub fn methods() -> Vec<Option<&'static str>> {
    let names = METHODS.iter().map(|method| Some(method.name));
    std::iter::once(None).chain(names).collect()
}

impl Viewer {
    /// Does what it is told.
    pub fn obey(&mut self, command: Command) {
        let (look, cutting) = (&mut self.look, &mut self.cutting);
        match command {
            Command::Wireframe => look.wireframe ^= true,
            Command::Cage => look.cage ^= true,
            Command::Numbers => look.numbers ^= true,
            Command::Shading => {
                let all: Vec<Shading> = SHADINGS.iter().map(|&(shading, _)| shading).collect();
                look.shading = next(&all, look.shading);
            }
            Command::Level(by) => {
                let most = cutting.backend.greatest_level();
                cutting.level = (cutting.level + by).round().clamp(1.0, most);
            }
            Command::Method => cutting.method = next(&methods(), cutting.method),
            Command::Scheme => cutting.scheme = next(&SCHEMES, cutting.scheme),
            Command::Backend => cutting.backend = next(&BACKENDS, cutting.backend),
            Command::Residence => {
                cutting.residence = next(&[Residence::Ring, Residence::Cache], cutting.residence);
            }
            Command::Spacing => {
                cutting.spacing = next(&[Spacing::Equal, Spacing::FractionalEven], cutting.spacing);
            }
            Command::Adaptive => {
                let same = |a: &Adaptive, b: &Adaptive| discriminant(a) == discriminant(b);
                let all = Adaptive::ALL;
                let at = cutting
                    .adaptive
                    .and_then(|by| all.iter().position(|a| same(a, &by)));
                cutting.adaptive = all.get(at.map_or(0, |at| at + 1)).copied();
            }
            Command::Cull => {
                let all = CULLINGS.map(|name| name.parse().unwrap_or_default());
                cutting.culling = next(&all, cutting.culling);
            }
            Command::Amplify => cutting.amplify ^= true,
            other => self.obey_more(other),
        }
    }

    fn obey_more(&mut self, command: Command) {
        match command {
            Command::Fit => self.fit(),
            Command::Look(preset) => {
                self.orbit.look(preset);
                self.fit();
            }
            Command::Turn(right, up) => {
                self.orbit.yaw += right;
                self.orbit.pitch += up;
                self.orbit.turn(glam::DVec2::ZERO);
            }
            Command::Nearer(factor) => {
                let (aspect, radius) = (self.area.aspect(), self.sphere().radius);
                self.orbit.dolly(factor, glam::DVec2::ZERO, aspect, radius);
            }
            Command::Orthographic => self.orbit.orthographic ^= true,
            Command::Freeze => {
                self.frozen = match self.frozen {
                    None => Some(self.orbit),
                    Some(_) => None,
                };
            }
            Command::Split => self.beside(Beside::Split),
            Command::SideBySide => self.beside(Beside::SideBySide),
            Command::ErrorMap => {
                let all = [None, Some(ErrorKind::Position), Some(ErrorKind::Normal)];
                self.compare.map = next(&all, self.compare.map);
            }
            Command::Play => self.deform.play(),
            Command::Panels => self.panels ^= true,
            Command::Sheet => self.sheet ^= true,
            Command::Screenshot => self.wishes.push(Wish::Screenshot),
            Command::Render => self.wishes.push(Wish::Render),
            Command::CopyLine => self.wishes.push(Wish::CopyCommand),
            Command::Save => self.wishes.push(Wish::Save),
            Command::Quit => self.intend(Intent::Quit),
            Command::Reload => self.intend(Intent::Reload),
            Command::Neighbour(ahead) => self.neighbour(ahead),
            other => self.edit(other),
        }
    }

    fn beside(&mut self, how: Beside) {
        let own = self.compare.beside;
        self.compare.beside = if own == how { Beside::Alone } else { how };
    }

    /// Opens the file that comes after or before the first one in its folder.
    fn neighbour(&mut self, ahead: bool) {
        let file = self.parts.first().and_then(|part| part.file());
        let Some(file) = file.map(std::path::Path::to_path_buf) else {
            self.notices.tell("what is built in has no folder");
            return;
        };
        match super::folder::neighbour(&file, ahead) {
            Some(other) => self.intend(Intent::Open(vec![Some(other)])),
            None => self
                .notices
                .tell("there is no other OBJ file in the folder"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_does_two_things() {
        for (number, one) in KEYS.iter().enumerate() {
            let clash = KEYS[..number]
                .iter()
                .any(|other| (one.key, one.modifiers) == (other.key, other.modifiers));
            assert!(!clash, "{}", key_words(one));
        }
    }

    #[test]
    fn a_key_with_others_held_is_another_key() {
        let event = |key, modifiers| egui::Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        };
        let of = |key, modifiers| of_event(&event(key, modifiers));
        assert_eq!(of(Key::Z, Modifiers::NONE), Some(Command::Freeze));
        let control = Modifiers {
            ctrl: true,
            command: true,
            ..Modifiers::NONE
        };
        assert_eq!(of(Key::Z, control), Some(Command::Undo));
        assert_eq!(of(Key::Plus, Modifiers::SHIFT), Some(Command::Level(1.0)));
        assert_eq!(of(Key::F, Modifiers::ALT), None);
    }

    #[test]
    fn levels_stay_within_what_the_back_end_draws() {
        let mut viewer = Viewer::default();
        for _ in 0..100 {
            viewer.obey(Command::Level(1.0));
        }
        assert_eq!(viewer.cutting.level, 64.0);
        viewer.cutting.backend = Backend::Geometry;
        assert_eq!(viewer.cutting.cut().level, 32.0);
        for _ in 0..100 {
            viewer.obey(Command::Level(-1.0));
        }
        assert_eq!(viewer.cutting.level, 1.0);
    }
}
