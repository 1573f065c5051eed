//! Nothing turns faster at a corner than beside it.

use super::drawn::{Patch, degrees, each_patch, faces_of_ptex, normal, turned_at_corners};
use super::{Looked, Rule, Subject, every, of_all_schemes, usual};
use crate::abi::Captured;
use crate::conformance::meshes::sheet;
use crate::conformance::models::chosen;
use crate::conformance::{Case, Check, Context};
use crate::error::Result;
use crate::mesh::{INFINITE_SHARPNESS, Model};
use crate::method::{Pass, Prepared};

pub(super) const RULE: Rule = Rule {
    name: "corners",
    rule: "at every corner of a face the normal is within 5 degrees of the one beside it, or as near as that one is to the next",
    source: "README, Normals",
    concerns: every,
    options: usual,
    look,
};

/// Where pictures look for what stands out: one pixel of a face that is 64 across.
const LEVEL: f32 = 64.0;

/// The patches that are looked at, at most: each has 4,225 vertices.
const MOST_PATCHES: usize = 24;

/// The angle that always passes, in degrees.
const ALWAYS: f64 = 5.0;

/// How much farther the normal may turn in the last step than in the one before. Around a vertex the deviation from the limit's normal shrinks by
/// the ratio of the third to the second eigenvalue with each halving, so the last step is 1 / (1 / ratio - 1) of the one before. The ratio is at most 0.87 for
/// valences up to 8 (Stam 1998, appendix).
const FASTER: f64 = 8.0;

/// The greatest valence for which that holds.
const MOST_EDGES: u8 = 8;

fn look(context: &Context, subject: &Subject<'_>, check: &mut Check) -> Result<Looked> {
    let faces = faces_of_ptex(subject.model);
    let subject = Subject {
        prepared: interesting(subject, &faces),
        ..*subject
    };
    let mut looked = Looked::default();
    each_patch(context, &subject, LEVEL, turned_at_corners, |patch| {
        let valences = patch.pass.patches[patch.number].valences.to_le_bytes();
        for (corner, valence) in (0..patch.pass.domain.corners()).zip(valences) {
            if valence <= MOST_EDGES {
                looked.add(hold_corner(check, &subject, patch, corner));
            }
        }
        Ok(())
    })?;
    Ok(looked)
}

/// Some of the patches that have nothing semi-sharp about them, those with something infinitely sharp first.
fn interesting(subject: &Subject<'_>, faces: &[u32]) -> Prepared {
    let face = |pass: &Pass, number: usize| faces[pass.patches[number].ptex as usize];
    let rank = |pass: &Pass, number: usize| rank(subject.model, face(pass, number));
    let passes = subject.prepared.passes.iter();
    let all = passes.flat_map(|pass| (0..pass.patches.len()).map(move |i| rank(pass, i)));
    let all: Vec<u32> = all.flatten().collect();
    let sharp = all.iter().filter(|&&rank| rank > 0).count();
    let least = u32::from(sharp > 0);
    let among = all.iter().filter(|&&rank| rank >= least).count();
    let step = among.div_ceil(MOST_PATCHES).max(1);
    let seen = std::cell::Cell::new(0_usize);
    chosen(&subject.prepared, |pass, number| {
        let fits = rank(pass, number).is_some_and(|rank| rank >= least);
        if fits {
            seen.set(seen.get() + 1);
        }
        fits && (seen.get() - 1).is_multiple_of(step)
    })
}

/// How many corners of a face are infinitely sharp or have infinitely sharp edges; None where something is semi-sharp, which may turn as fast as it
/// likes.
fn rank(model: &Model, face: u32) -> Option<u32> {
    let topology = model.topology();
    let semi_sharp = |sharpness: f32| sharpness > 0.0 && sharpness < INFINITE_SHARPNESS;
    let mut sharp = 0;
    for &vertex in topology.face(face) {
        let edges = topology.vertex_edges(vertex).iter();
        let edges = edges.map(|&edge| topology.edge(edge).sharpness);
        let all: Vec<f32> = edges.chain([topology.vertex_sharpness(vertex)]).collect();
        if all.iter().any(|&sharpness| semi_sharp(sharpness)) {
            return None;
        }
        sharp += u32::from(all.iter().any(|&sharpness| sharpness > 0.0));
    }
    Some(sharp)
}

fn hold_corner(
    check: &mut Check,
    subject: &Subject<'_>,
    patch: &Patch<'_>,
    corner: usize,
) -> Looked {
    let mut looked = Looked::default();
    let sorted = patch.at_corner(corner);
    let inside = sorted.iter().copied();
    let inside: Vec<&Captured> = inside.filter(|vertex| patch.is_inside(vertex)).collect();
    let [Some(own), Some(beside)] = [sorted.first(), inside.first()] else {
        return looked;
    };
    // The next step inwards is as long as the last one.
    let away = |uv: [f32; 2]| {
        let [u, v] = [0, 1].map(|i| uv[i] - own.uv[i]);
        u.abs().max(v.abs())
    };
    let far = inside
        .iter()
        .find(|vertex| away(vertex.uv) >= 1.9 * away(beside.uv));
    let Some(next) = far else { return looked };
    let [own, beside, next] = [own, beside, next].map(|vertex| normal(vertex));
    let before = degrees(beside, next);
    if beside.length() < 0.5 || next.length() < 0.5 || before > 45.0 {
        // No surface to speak of, or one that turns by itself.
        return looked;
    }
    let turn = degrees(own, beside);
    let missing = own.length() < 0.5;
    check.hold(!missing && turn <= ALWAYS + FASTER * before, || {
        let (name, ptex) = (subject.method.name, patch.ptex());
        format!("{name}, corner {corner} of a patch of ptex face {ptex}: the normal {own:.4} turns by {turn:.1} degrees where it turns by {before:.2} beside it")
    });
    looked.at(turn);
    looked
}

/// Curved sheets with a sharp vertex inside, by itself or where creases end or meet.
pub(super) fn cusps() -> impl Iterator<Item = Case> {
    (0..8).map(|number| {
        let name = format!("witness.cusp.{number}");
        Case::new(name, RULE.rule, RULE.source, move |context| {
            of_all_schemes(context, &RULE, || {
                let mut random = context.random(&format!("witness.cusp.{number}"));
                let mut parts = sheet(4);
                for position in &mut parts.positions {
                    *position = position.map(|x| x + random.between(-0.15, 0.15));
                    position[2] *= 2.0;
                }
                // Vertex 12 is the middle, beside 11 and 13, 7 and 17.
                let ends = [11, 7, 13, 17];
                parts.tagged(|builder| {
                    let ends = ends.into_iter().take(number % 5);
                    let sharp = ends.fold(builder, |b, end| b.crease(12, end, 10.0));
                    sharp.corner(12, 10.0)
                })
            })
        })
    })
}
