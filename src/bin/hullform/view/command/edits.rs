//! What is picked, and what is done with it.

use std::collections::BTreeMap;

use super::Command;
use crate::view::draft::Change;
use crate::view::selection::Tool;
use crate::view::viewer::Viewer;

impl Viewer {
    /// Changes what is picked, or what is done with it.
    pub(super) fn edit(&mut self, command: Command) {
        match command {
            Command::Pick(tool) => {
                self.selection.tool = tool;
                // What one picks one wants to see.
                self.look.cage |= tool != Tool::Look;
            }
            Command::Unpick => {
                self.selection.clear();
                self.notices.clear();
                self.sheet = false;
            }
            Command::Undo | Command::Redo => {
                let back = command == Command::Undo;
                if let Some(part) = self.edited() {
                    part.step(back);
                }
            }
            Command::Sharpen(by) => self.sharpen(|sharpness| sharpness + by, false),
            Command::Infinite => {
                let smooth = |sharpness: f32| if sharpness >= 10.0 { 0.0 } else { 10.0 };
                self.sharpen(smooth, false);
            }
            Command::Hole => self.turn_holes(),
            _ => {}
        }
    }

    /// The sharpness of what is picked: of all edges and vertices the first one's.
    pub fn picked_sharpness(&mut self) -> Option<f32> {
        let (edges, vertices) = (
            self.selection.edges.clone(),
            self.selection.vertices.clone(),
        );
        let draft = self.edited()?.history()?.draft();
        let edge = edges.first().map(|edge| draft.creases.get(edge));
        let vertex = vertices.first().map(|vertex| draft.corners.get(vertex));
        edge.or(vertex)
            .map(|sharpness| sharpness.copied().unwrap_or(0.0))
    }

    /// Changes the sharpness of all edges and vertices that are picked, as a part of a drag or by itself.
    pub fn sharpen(&mut self, to: impl Fn(f32) -> f32, dragging: bool) {
        let (edges, vertices) = (
            self.selection.edges.clone(),
            self.selection.vertices.clone(),
        );
        let Some(part) = self.edited() else { return };
        let Some(history) = part.history() else {
            return;
        };
        let draft = history.draft();
        let both = |was: Option<&f32>| {
            let was = was.copied().unwrap_or(0.0);
            [was, to(was).clamp(0.0, 10.0)]
        };
        let creases = edges
            .iter()
            .map(|edge| (*edge, both(draft.creases.get(edge))));
        let creases: BTreeMap<_, _> = creases.collect();
        let corners = vertices.iter().map(|v| (*v, both(draft.corners.get(v))));
        let corners: BTreeMap<_, _> = corners.collect();
        if !creases.is_empty() {
            part.change(Change::Creases(creases), dragging);
        }
        if !corners.is_empty() {
            part.change(Change::Corners(corners), dragging);
        }
    }

    fn turn_holes(&mut self) {
        let faces = self.selection.faces.clone();
        let Some(part) = self.edited() else { return };
        let Some(history) = part.history() else {
            return;
        };
        let holes = &history.draft().holes;
        let turned = faces
            .iter()
            .map(|face| (*face, [holes.contains(face), !holes.contains(face)]));
        let turned: BTreeMap<_, _> = turned.collect();
        if !turned.is_empty() {
            part.change(Change::Holes(turned), false);
        }
    }
}
