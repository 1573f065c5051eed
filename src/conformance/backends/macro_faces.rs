//! Several faces as one patch: the vertices of single faces, and no cracks, whatever the levels.

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

use super::{Drawn, hold_whole, mislead};
use crate::abi::Captured;
use crate::conformance::capture::cut;
use crate::conformance::meshes::Parts;
use crate::conformance::{Case, Check, Context, Finding, Random};
use crate::error::Result;
use crate::gpu::{Backend, Residence};
use crate::mesh::{ControlMesh, INFINITE_SHARPNESS, Model, builtin};
use crate::method::{DepthTags, METHODS, MacroFaces, Method, MethodOptions, Prepared, to_ptex};
use crate::tessellation::Spacing;

const SOURCE: &str = "Brainerd, Foley, Kraemer, Moreton, Niessner 2016, section 7.3";

const KINDS: [(&str, MacroFaces); 3] = [
    ("quartets", MacroFaces::Quartets),
    ("rectangles_16", MacroFaces::Rectangles { span: 16 }),
    ("rectangles_3", MacroFaces::Rectangles { span: 3 }),
];

const RESIDENCES: [(&str, Residence); 2] = [("ring", Residence::Ring), ("cache", Residence::Cache)];

/// Shapes in which each kind finds some.
const SHAPES: [&str; 3] = ["hull", "sheet", TORUS];

/// A closed one with a hexagon: macro faces lie beside single ones, n-gons, creases, and offset to one another.
const TORUS: &str = "torus";

fn model(shape: &str) -> Result<Model> {
    Ok(Model::new(match shape {
        TORUS => torus()?,
        built_in => builtin(built_in)?,
    }))
}

/// Quads around a torus, two of which are one hexagon.
fn torus() -> Result<ControlMesh> {
    const SIZE: [u32; 2] = [12, 10];
    let [columns, rows] = SIZE;
    let number = |x: u32, y: u32| x % columns + columns * (y % rows);
    let at = |i: u32| {
        let turn = |i: u32, n: u32| (TAU * f64::from(i) / f64::from(n)).sin_cos();
        let ((far, near), (up, out)) = (turn(i % columns, columns), turn(i / columns, rows));
        [(3.0 + out) * near, (3.0 + out) * far, up]
    };
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let quad = |(x, y)| [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| number(x, y));
    let quads = places.skip(2).map(|place| quad(place).to_vec());
    let hexagon = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)].map(|(x, y)| number(x, y));
    let parts = Parts {
        positions: (0..columns * rows).map(at).collect(),
        faces: std::iter::once(hexagon.to_vec()).chain(quads).collect(),
    };
    parts.tagged(|builder| {
        let along = (2..7).map(|x| (number(x, 4), number(x + 1, 4)));
        let sharp = along.fold(builder, |builder, (a, b)| builder.crease(a, b, 1.5));
        sharp.crease(number(6, 7), number(6, 8), INFINITE_SHARPNESS)
    })
}

pub fn cases() -> Vec<Case> {
    let drawn = KINDS
        .into_iter()
        .flat_map(|kind| RESIDENCES.map(|residence| (kind, residence)));
    let mut cases = Vec::new();
    for ((kind, faces), (residence, own)) in drawn {
        cases.extend(SHAPES.map(|shape| {
            let name = format!("backends.macro.bits-{kind}-{shape}-{residence}");
            let rule = "each vertex of a macro face is one of its faces', to the bit";
            Case::new(name, rule, SOURCE, move |context| {
                bits(context, shape, faces, own)
            })
        }));
        let name = format!("backends.macro.levels-{kind}-{residence}");
        let rule = "no edge is open, whatever the levels of sides of macro faces";
        cases.push(Case::new(name, rule, SOURCE, move |context| {
            levels(context, faces, own)
        }));
    }
    cases
}

/// The method that draws faces together.
fn method() -> &'static Method {
    let mut methods = METHODS.iter();
    let found = methods.find(|method| method.aggregates);
    found.expect("one of the methods draws macro faces")
}

type Bits = [u32; 3];

/// The bits of position and normal at each place of a ptex face.
fn places(prepared: &Prepared, drawn: &Drawn) -> HashMap<(u32, [u32; 2]), [Bits; 2]> {
    let passes = prepared.passes.iter().zip(&drawn.passes);
    let all = passes.flat_map(|(pass, all)| all.iter().map(move |vertex| (pass, vertex)));
    let place = |vertex: &Captured, face: u32, uv: [f32; 2]| {
        let bits = [vertex.position, vertex.normal].map(|vector| vector.map(f32::to_bits));
        ((face, uv.map(f32::to_bits)), bits)
    };
    let all = all.map(|(pass, vertex)| {
        let (slot, uv) = pass.face_at(vertex.patch_number as usize, vertex.uv);
        let face = &pass.patches[slot];
        place(vertex, face.ptex, to_ptex(face, uv))
    });
    all.collect()
}

/// At powers of two, where the vertices of both stand at the same places.
fn bits(
    context: &Context,
    shape: &str,
    faces: MacroFaces,
    residence: Residence,
) -> Result<Finding> {
    let model = model(shape)?;
    let (mut check, mut compared) = (Check::default(), 0);
    for level in [1.0, 2.0, 4.0] {
        let draw = |faces: MacroFaces| {
            let prepared = method().prepare(&model, MethodOptions::from(faces))?;
            let (way, at) = (
                (Backend::Tessellator, residence),
                cut(level, Spacing::Equal),
            );
            let drawn = Drawn::from(context, &model, prepared.clone(), way, None, at)?;
            Ok((prepared, drawn))
        };
        let (prepared, mut drawn) = draw(faces)?;
        if context.is_wrong() {
            drawn.passes[0][0].position[0] += 1.0;
        }
        let together = places(&prepared, &drawn);
        let (prepared, drawn) = draw(MacroFaces::None)?;
        let apart = places(&prepared, &drawn);
        // Of one row there are two segments across at least, and beside an n-gon a single face has a vertex in its middle.
        let is_coarsest = level == 1.0;
        for (place, bits) in &together {
            match apart.get(place) {
                Some(own) => {
                    compared += 1;
                    check.hold(bits == own, || {
                        format!("level {level}: {place:?} has others")
                    });
                }
                None => check.hold(is_coarsest, || {
                    format!("level {level}: {place:?} is no single face's")
                }),
            }
        }
        let known: HashSet<Bits> = together.values().map(|[position, _]| *position).collect();
        let mut all = apart.values();
        let is_there = |[position, _]: &[Bits; 2]| known.contains(position);
        check.hold(is_coarsest || all.all(is_there), || {
            format!("level {level}: a vertex is missing")
        });
    }
    Ok(check.finish(format!("{compared} vertices with the same bits")))
}

/// With random depths, at levels that are no powers of two as well.
fn levels(context: &Context, faces: MacroFaces, residence: Residence) -> Result<Finding> {
    let model = model(TORUS)?;
    let (mut check, mut triangles) = (Check::default(), 0);
    let mut random = Random::new(context.settings.seed, "backends.macro");
    let level = faces.greatest_level().min(13) as f32;
    for _ in 0..3 {
        let mut prepared = method().prepare(&model, MethodOptions::from(faces))?;
        mislead(context, &mut prepared);
        let deepest = f64::from(level.log2()) + 0.5;
        let count = model.mesh().vertex_count();
        let depths = (0..count).map(|_| random.between(-0.5, deepest) as f32);
        let tags = DepthTags::new(depths.collect::<Vec<f32>>());
        let way = (Backend::Tessellator, residence);
        let at = cut(level, Spacing::Equal);
        let drawn = Drawn::from(context, &model, prepared, way, Some(tags), at)?;
        triangles += hold_whole(&drawn, &mut check);
    }
    Ok(check.finish(format!("{triangles} triangles")))
}
