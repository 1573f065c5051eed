//! Nothing depends on vertices that no face uses, on where a mesh is, or on how large it is.

use glam::DVec3;

use super::{Looked, Rule, Subject, every, usual};
use crate::abi::Captured;
use crate::conformance::capture::{Frame, bits, captured, cut};
use crate::conformance::meshes::with_positions;
use crate::conformance::{Check, Context};
use crate::error::Result;
use crate::gpu::Fill;
use crate::mesh::{Model, Placement};
use crate::tessellation::Spacing;

pub(super) const UNUSED: Rule = Rule {
    name: "unused",
    rule: "a vertex that no face uses changes no bit, wherever it is",
    source: "README, Coordinates; IEEE 754",
    concerns: every,
    options: usual,
    look: unused,
};

pub(super) const MOVED: Rule = Rule {
    name: "moved",
    rule: "a mesh that is moved, or scaled by a power of two, without rounding, has the same bits in local units",
    source: "IEEE 754: sums and products of what is scaled by a power of two are so scaled",
    concerns: every,
    options: usual,
    look: moved,
};

/// Odd: not every vertex lies on a lattice.
const LEVEL: f32 = 3.0;

/// The mesh made to be compared: about as large as 1, each coordinate a multiple of 2^-20, so that it can be moved and scaled without rounding. What
/// no face uses is in its middle.
fn exact(model: &Model) -> Vec<DVec3> {
    let mut used = vec![false; model.mesh().vertex_count()];
    for &vertex in model.mesh().faces().flatten() {
        used[vertex as usize] = true;
    }
    let places = model.mesh().positions().iter().zip(used);
    places
        .map(|(&position, used)| match used {
            true => (model.placement().local(position) * GRID).round() / GRID,
            false => DVec3::ZERO,
        })
        .collect()
}

const GRID: f64 = (1 << 20) as f64;

/// The subject with other positions.
struct Other {
    model: Model,
    frame: Frame,
}

fn draw(context: &Context, subject: &Subject<'_>, positions: &[DVec3]) -> Result<Other> {
    let positions: Vec<[f64; 3]> = positions.iter().map(|p| p.to_array()).collect();
    let model = Model::new(with_positions(subject.model.mesh(), &positions)?);
    // What is prepared depends on topology alone; a vertex more is another.
    let prepared = match model.mesh().vertex_count() == subject.model.mesh().vertex_count() {
        true => subject.prepared.clone(),
        false => subject.method.prepare(&model, (usual)(subject.method))?,
    };
    let cut = cut(LEVEL, Spacing::Equal);
    let mut frame = captured(context, &model, prepared, cut, Fill::Discard)?;
    if context.is_wrong() {
        let all = model.mesh().positions().iter();
        let farthest = all.map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let far = (farthest / model.placement().scale) as f32;
        let vertices = frame.passes.iter_mut().flatten();
        vertices.for_each(|vertex| lose_places(vertex, far));
    }
    Ok(Other { model, frame })
}

/// A position that was computed where `far` has its last place: as with a middle that goes by all vertices, or without any.
fn lose_places(vertex: &mut Captured, far: f32) {
    vertex.position = vertex.position.map(|x| (x + far) - far);
}

/// Holds two frames to the same vertices: positions are in local units.
fn hold_same(check: &mut Check, subject: &Subject<'_>, what: &str, frames: [&Frame; 2]) -> u64 {
    let counts = frames.map(|frame| frame.passes.iter().map(Vec::len).collect::<Vec<_>>());
    let name = subject.method.name;
    check.hold(counts[0] == counts[1], || {
        format!(
            "{name}, {what}: {:?} vertices instead of {:?}",
            counts[1], counts[0]
        )
    });
    let [first, second] = frames.map(|frame| frame.passes.iter().flatten());
    let mut count = 0;
    for (own, other) in first.zip(second) {
        check.hold(bits(own) == bits(other), || {
            format!("{name}, {what}: {other:?} instead of {own:?}")
        });
        count += 1;
    }
    count
}

fn hold_placement(check: &mut Check, what: &str, other: &Other, wanted: Placement) {
    let found = other.model.placement();
    check.hold(found == wanted, || {
        format!("{what}: {found:?} instead of {wanted:?}")
    });
}

fn unused(context: &Context, subject: &Subject<'_>, check: &mut Check) -> Result<Looked> {
    let own = exact(subject.model);
    let mut looked = Looked::default();
    // What is spoiled in all frames must differ in one of them.
    let still = draw(context, subject, &own)?;
    let far = DVec3::new(3e6, -7e9, 1e3);
    let more = [own.as_slice(), &[far]].concat();
    let other = draw(context, subject, &more)?;
    let what = format!("with a vertex at {far}");
    hold_placement(check, &what, &other, still.model.placement());
    let frames = [&still.frame, &other.frame];
    looked.count += hold_same(check, subject, &what, frames);
    Ok(looked)
}

fn moved(context: &Context, subject: &Subject<'_>, check: &mut Check) -> Result<Looked> {
    let own = exact(subject.model);
    let still = draw(context, subject, &own)?;
    let mut looked = Looked::default();
    let offset = DVec3::new(-1e6, 3e6, 2e6);
    let away: Vec<DVec3> = own.iter().map(|&p| p + offset).collect();
    let other = draw(context, subject, &away)?;
    let what = format!("moved by {offset}");
    let placement = still.model.placement();
    let wanted = Placement {
        centre: placement.centre + offset,
        ..placement
    };
    hold_placement(check, &what, &other, wanted);
    let frames = [&still.frame, &other.frame];
    looked.count += hold_same(check, subject, &what, frames);
    for exponent in [-900, 60] {
        let scale = 2f64.powi(exponent);
        let scaled: Vec<DVec3> = own.iter().map(|&p| scale * p).collect();
        let other = draw(context, subject, &scaled)?;
        let what = format!("2^{exponent} times as large");
        let Placement {
            centre,
            scale: unit,
        } = still.model.placement();
        let wanted = Placement {
            centre: scale * centre,
            scale: scale * unit,
        };
        hold_placement(check, &what, &other, wanted);
        let frames = [&still.frame, &other.frame];
        looked.count += hold_same(check, subject, &what, frames);
    }
    Ok(looked)
}
