//! The state of the window in words and numbers: for panels, and for who drives it by script.

use hullform::gpu::Decides;
use hullform::method::Prepared;
use serde_json::{Value, json};

use super::Program;
use crate::view::command::SHADINGS;
use crate::view::panels::PACINGS;
use crate::view::part::Part;
use crate::view::readings::{Fact, bytes, grouped};
use crate::view::stage::Staged;
use crate::view::viewer::{Beside, ErrorKind};

impl Program {
    /// Measures what panels tell besides times.
    pub fn read_off(&mut self) {
        let parts = self.viewer.parts.iter();
        let staged = |part: &Part| {
            let all = &self.stage.parts;
            all.iter().find(|staged| staged.number == part.number())
        };
        let facts = parts.map(|part| (part.name(), facts(part, staged(part))));
        self.readings.models = facts.collect();
        self.readings.memory = self.memory();
        let messages = self.context.gpu.instance().validation_messages().len();
        let asked = self.context.global.validation;
        self.readings.validation = asked.then_some(messages);
        let info = self.context.device().info();
        let names: Vec<&str> = self
            .context
            .gpu
            .workarounds
            .iter()
            .map(|row| row.name)
            .collect();
        let workarounds = match names.is_empty() {
            true => "none".to_string(),
            false => names.join(", "),
        };
        let [width, height] = self.canvas.size();
        self.readings.device_facts = [
            ("name", info.name.clone()),
            (
                "driver",
                format!("{} {}", info.driver.name, info.driver.info),
            ),
            ("workarounds", workarounds),
            ("window", format!("{width} x {height}")),
            ("presents", self.presents()),
        ]
        .map(|(name, value)| (name.to_string(), value))
        .into();
    }

    /// How pictures follow one another, as Vulkan names it.
    fn presents(&self) -> String {
        format!("{:?}", self.canvas.mode())
    }

    /// Bytes on the device by what they are for, the greatest first.
    fn memory(&self) -> Vec<(String, u64)> {
        let report = self.context.device().allocator().generate_report();
        let mut all: std::collections::BTreeMap<String, u64> = Default::default();
        for allocation in &report.allocations {
            *all.entry(allocation.name.clone()).or_default() += allocation.size;
        }
        let mut all: Vec<(String, u64)> = all.into_iter().collect();
        all.sort_by_key(|(_, size)| std::cmp::Reverse(*size));
        all
    }

    /// Everything that a script may ask.
    pub fn state(&self) -> Value {
        let viewer = &self.viewer;
        let rect = |rect: &egui::Rect| [rect.left(), rect.top(), rect.width(), rect.height()];
        let places = viewer
            .places
            .iter()
            .map(|(name, place)| (name.to_string(), json!(rect(place))));
        let places: serde_json::Map<String, Value> = places.collect();
        let (orbit, area) = (viewer.orbit, viewer.area);
        let mut pacings = PACINGS.into_iter();
        let pacing = pacings.find(|(pacing, ..)| *pacing == viewer.pacing);
        let memory: u64 = self.readings.memory.iter().map(|(_, size)| size).sum();
        json!({
            "seconds": self.began.elapsed().as_secs_f64(),
            "frames": self.readings.frames[0],
            "scenes": self.readings.frames[1],
            "settled": self.is_settled(),
            "busy": self.busy(),
            "window": self.canvas.size(),
            "area": [area.x, area.y, area.width, area.height],
            "places": places,
            "camera": {
                "target": orbit.target.to_array(), "yaw": orbit.yaw, "pitch": orbit.pitch,
                "distance": orbit.distance, "orthographic": orbit.orthographic,
            },
            "frozen": viewer.frozen.is_some(),
            "look": self.look(),
            "cut": self.cut(),
            "compare": {
                "beside": match viewer.compare.beside {
                    Beside::Alone => "alone",
                    Beside::Split => "split",
                    Beside::SideBySide => "side-by-side",
                },
                "other": viewer.compare.other,
                "at": viewer.compare.at,
                "map": viewer.compare.map.map(|kind| match kind {
                    ErrorKind::Position => "position",
                    ErrorKind::Normal => "normal",
                }),
                "greatest": self.legend().map(|legend| legend.greatest),
            },
            "selection": {
                "tool": viewer.selection.tool.name(),
                "vertices": viewer.selection.vertices,
                "edges": viewer.selection.edges,
                "faces": viewer.selection.faces,
            },
            "models": self.models(),
            "edits": { "seen": self.readings.edited, "seconds": self.readings.edits.last(), "parts": self.readings.parts },
            "motion": {
                "kind": viewer.deform.kind.name(), "time": viewer.deform.time, "playing": viewer.deform.playing,
            },
            "recent": viewer.recent,
            "pacing": [pacing.map(|(_, name, _)| name), self.presents()],
            "sheet": viewer.sheet,
            "panels": viewer.panels,
            "notice": viewer.notices.last().map(|notice| notice.words.clone()),
            "warnings": viewer.notices.errors(),
            "validation": self.context.gpu.instance().validation_messages().len(),
            "copied": self.copied,
            "probe": self.found.as_ref().map(|found| json!({
                "face": found.face, "uv": found.uv, "position": found.position.to_array(),
                "normal": found.normal.to_array(), "error": found.error, "angle": found.angle,
                "facts": found.facts().into_iter().map(|(name, words)| (name.to_string(), json!(words)))
                    .collect::<serde_json::Map<String, Value>>(),
            })),
            "asked": viewer.intent.is_some(),
            "shaders": { "version": self.context.shaders().version, "error": self.live.error },
            "vertices": self.readings.cost.vertices,
            "outcome": self.readings.outcome.as_ref().map(crate::deciding::as_json),
            "memory": memory,
        })
    }

    fn look(&self) -> Value {
        let look = self.viewer.look;
        let name = SHADINGS
            .iter()
            .find(|(shading, _)| *shading == look.shading);
        json!({
            "shading": name.map(|(_, name)| name),
            "wireframe": look.wireframe,
            "cage": look.cage,
            "numbers": look.numbers,
            "displace": look.displace,
        })
    }

    fn cut(&self) -> Value {
        let cutting = self.viewer.cutting;
        json!({
            "method": cutting.method,
            "scheme": cutting.scheme.map(|scheme| scheme.name()),
            "backend": cutting.backend.name(),
            "residence": cutting.residence.name(),
            "spacing": cutting.spacing.name(),
            "level": cutting.level,
            "adaptive": cutting.adaptive.map(|by| by.to_string()),
            "cull": cutting.culling.to_string(),
            "decides": match cutting.decides() {
                Decides::Device => "device",
                Decides::Host => "host",
            },
            "amplify": cutting.amplify,
        })
    }

    fn models(&self) -> Vec<Value> {
        let model = |part: &Part| {
            let staged = self
                .stage
                .parts
                .iter()
                .find(|staged| staged.number == part.number());
            let methods = staged.map(|staged| {
                let sides = staged.sides.iter();
                sides
                    .map(|drawn| drawn.surface.prepared().method)
                    .collect::<Vec<_>>()
            });
            let history = part.history();
            json!({
                "name": part.name(),
                "methods": methods,
                "live": staged.is_some_and(|staged| staged.live.is_some()),
                "version": staged.map(|staged| staged.wanted.version),
                "wanted": history.map(|history| history.topology()),
                "steps": history.map(|history| history.steps()),
                "changed": history.map(|history| history.is_changed()),
                "creases": history.map(|history| {
                    history.draft().creases.values().map(|&s| f64::from(s)).fold(0.0, |sum, s| sum + s)
                }),
                "holes": history.map(|history| history.draft().holes.len()),
                "error": part.error,
            })
        };
        self.viewer.parts.iter().map(model).collect()
    }
}

/// What is told of a model.
fn facts(part: &Part, staged: Option<&Staged>) -> Vec<Fact> {
    let mut facts: Vec<(&str, String)> = Vec::new();
    if let Some(model) = &part.model {
        let mesh = model.mesh();
        let counts = [mesh.vertex_count(), mesh.face_count()].map(|n| grouped(n as u64));
        facts.push(("vertices", counts[0].clone()));
        facts.push(("faces", counts[1].clone()));
        facts.push(("scheme", mesh.options().scheme.name().to_string()));
    }
    let sides = staged.map_or(&[][..], |staged| &staged.sides);
    for drawn in sides {
        let prepared = drawn.surface.prepared();
        facts.push(("method", prepared.method.to_string()));
        facts.push(("patches", patches(prepared)));
        if let Some(plans) = &prepared.plans {
            facts.push(("plans", grouped(plans.plans as u64)));
        }
        facts.push(("on the device", bytes(drawn.surface.bytes())));
        let [prepare, upload] = drawn.seconds.map(|seconds| 1e3 * seconds);
        facts.push(("prepare, upload", format!("{prepare:.0} + {upload:.0} ms")));
    }
    facts
        .into_iter()
        .map(|(name, value)| (name.to_string(), value))
        .collect()
}

fn patches(prepared: &Prepared) -> String {
    let counts = prepared
        .passes
        .iter()
        .map(|pass| grouped(pass.patches.len() as u64));
    counts.collect::<Vec<String>>().join(" + ")
}
