//! Draws of many patches by every kind of draw, with shaders that note what came of each patch.

use std::collections::BTreeSet;

use crate::conformance::Context;
use crate::conformance::modes::module;
use crate::conformance::raw::{Program, Raw, Recorder};
use crate::error::Result;

/// The picture's side in pixels.
pub const SIDE: u32 = 512;

/// What the shaders note of a patch. Twin of `Note` in `glsl/conformance/scale.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Note {
    pub controls: u32,
    pub control_high: u32,
    pub control_low: u32,
    pub evaluations: u32,
    pub evaluation_high: u32,
    pub evaluation_low: u32,
    pub bad_points: u32,
}

/// Push constants. Twin of `Draw` in `glsl/conformance/scale.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Constants {
    pub per_instance: u32,
    pub patches: u32,
    pub first_vertex: u32,
    pub first_instance: u32,
    pub columns: u32,
    pub side: f32,
    pub level: f32,
}

// As `tests/layout.rs` holds the shaders to.
const _: () = assert!(size_of::<Note>() == 4 * 7 && size_of::<Constants>() == 4 * 7);

/// The kinds of draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Draw,
    Indexed,
    Instanced,
    IndexedInstanced,
    Indirect,
    IndexedIndirect,
}

impl Kind {
    pub const ALL: [Kind; 6] = [
        Kind::Draw,
        Kind::Indexed,
        Kind::Instanced,
        Kind::IndexedInstanced,
        Kind::Indirect,
        Kind::IndexedIndirect,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Kind::Draw => "draw",
            Kind::Indexed => "indexed",
            Kind::Instanced => "instanced",
            Kind::IndexedInstanced => "indexed_instanced",
            Kind::Indirect => "indirect",
            Kind::IndexedIndirect => "indexed_indirect",
        }
    }

    pub fn has_indices(self) -> bool {
        matches!(
            self,
            Kind::Indexed | Kind::IndexedInstanced | Kind::IndexedIndirect
        )
    }

    fn has_instances(self) -> bool {
        matches!(self, Kind::Instanced | Kind::IndexedInstanced)
    }
}

/// A draw.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    pub kind: Kind,
    pub patches: u32,
    pub level: u32,
    pub control_points: u32,
    /// Where vertices and instances begin.
    pub first: u32,
}

/// Where the notes, the indices and the arguments of indirect draws are.
const NOTES: usize = 0;
const INDICES: usize = 1;
const ARGUMENTS: usize = 2;

impl Load {
    /// Patches an instance: four instances, if there are any, the last of which may be short of patches.
    fn per_instance(&self) -> u32 {
        if self.kind.has_instances() {
            self.patches.div_ceil(4)
        } else {
            self.patches
        }
    }

    fn instances(&self) -> u32 {
        self.patches.div_ceil(self.per_instance())
    }

    /// Cells of the picture in a row.
    pub fn columns(&self) -> u32 {
        (1..).find(|n| n * n >= self.patches).unwrap_or(1)
    }

    pub fn cell(&self) -> u32 {
        SIDE / self.columns()
    }

    fn constants(&self, patches: u32) -> Constants {
        Constants {
            per_instance: self.per_instance(),
            patches,
            first_vertex: self.first,
            first_instance: match self.kind {
                Kind::Draw | Kind::Instanced => self.first,
                _ => 0,
            },
            columns: self.columns(),
            side: 2.0 * self.cell() as f32 / SIDE as f32,
            level: self.level as f32,
        }
    }

    /// The indices of an instance: patches backwards, so that a number counted by the driver is not the vertex's.
    fn indices(&self) -> Vec<u32> {
        let points = self.control_points;
        let patches = (0..self.per_instance()).rev();
        patches
            .flat_map(|patch| (0..points).map(move |i| patch * points + i))
            .collect()
    }

    /// What gl_PrimitiveID is for a patch: it counts from 0 in every instance.
    pub fn primitive(&self, patch: u32) -> u32 {
        let local = patch % self.per_instance();
        if self.kind.has_indices() {
            self.per_instance() - 1 - local
        } else {
            local
        }
    }

    fn record(&self, cmd: &Recorder<'_>) {
        let vertices = self.per_instance() * self.control_points;
        let (instances, first) = (self.instances(), self.first);
        match self.kind {
            Kind::Draw | Kind::Instanced => cmd.draw(vertices, instances, first, first),
            Kind::Indexed | Kind::IndexedInstanced => {
                cmd.draw_indexed(INDICES, vertices, instances, first as i32);
            }
            Kind::Indirect => cmd.draw_indirect(ARGUMENTS),
            Kind::IndexedIndirect => cmd.draw_indexed_indirect(INDICES, ARGUMENTS),
        }
    }

    /// The arguments of an indirect draw. The first instance stays 0: others need a feature (`drawIndirectFirstInstance`).
    fn arguments(&self) -> [u32; 5] {
        let vertices = self.per_instance() * self.control_points;
        if self.kind.has_indices() {
            [vertices, 1, 0, self.first, 0]
        } else {
            [vertices, 1, self.first, 0, 0]
        }
    }
}

/// What a draw left behind.
pub struct Traces {
    pub notes: Vec<Note>,
    pub pixels: Vec<u32>,
}

/// Draws a load with the shaders of the suite.
pub fn draw(context: &Context, load: Load) -> Result<Traces> {
    draw_with(context, load, Ok)
}

/// The same with a program that differs from the suite's.
pub fn draw_with(
    context: &Context,
    load: Load,
    differ: impl FnOnce(Program) -> Result<Program>,
) -> Result<Traces> {
    let indices = load.indices();
    let sizes = [
        u64::from(load.patches) * size_of::<Note>() as u64,
        4 * indices.len() as u64,
        size_of::<[u32; 5]>() as u64,
    ];
    let mut raw = Raw::new(context.device()?, &sizes, SIDE)?;
    raw.write(INDICES, &indices)?;
    raw.write(ARGUMENTS, &load.arguments())?;
    let program = Program {
        control_points: load.control_points,
        constants: vec![load.control_points],
        ..Program::new(module("scale.tesc")?, module("scale.tese")?)?
    };
    let pipeline = raw.pipeline(&differ(program)?)?;
    let constants = load.constants(load.patches - u32::from(context.is_wrong()));
    raw.submit(None, |cmd| {
        cmd.bind(pipeline, &constants);
        load.record(cmd);
    })?;
    let notes: Vec<Note> = bytemuck::cast_slice(raw.words(NOTES)).to_vec();
    context.saw(notes.iter().map(|note| u64::from(note.evaluations)).sum());
    Ok(Traces {
        notes,
        pixels: raw.pixels(),
    })
}

impl Traces {
    /// The colours of a patch's cell, black aside.
    pub fn colours(&self, load: Load, patch: u32) -> BTreeSet<u32> {
        let (cell, columns) = (load.cell(), load.columns());
        let (x, y) = (patch % columns * cell, patch / columns * cell);
        let rows = (y..y + cell).map(|y| (y * SIDE + x) as usize);
        let rows = rows.map(|start| &self.pixels[start..start + cell as usize]);
        rows.flatten()
            .copied()
            .filter(|&pixel| pixel != 0)
            .collect()
    }
}
