//! What is drawn of one preparation, held against another.

use glam::Vec2;
use hullform::mesh::Model;
use hullform::method::{Controls, Method, Pass, Prepared, SurfacePoint, from_ptex};
use hullform::plan::{Database, PlanOptions};

/// Where patches are evaluated: corners, edges and inside, as deep as [`shallow`] plans go.
const PLACES: [f32; 6] = [0.0, 1.0 / 16.0, 0.3, 0.5, 0.8125, 1.0];

/// Holds what was prepared of a mesh against the same mesh without the numbers of faces that were removed: these leave no trace.
pub fn hold_compacted(
    method: &Method,
    edited: &Prepared,
    model: &Model,
    options: PlanOptions,
    what: &str,
) {
    let compacted = Model::new(model.mesh().clone().compacted());
    let fresh = method.prepare_with(&compacted, options, &Database::default());
    let fresh = fresh.expect("it draws the model");
    let [own, right] = [edited, &fresh].map(all_places);
    let [from, to] = [model, &compacted].map(|model| model.mesh().ptex_offsets());
    let there = (0..model.mesh().face_count()).filter(|&face| !model.mesh().is_removed(face));
    let of_fresh = fresh.controls(compacted.positions());
    let of_edited = edited.controls(model.positions());
    let all = compacted.mesh().ptex_count() as u32;
    let mut drawn = 0;
    for (now, before) in there.enumerate() {
        for i in 0..to.get(now + 1).copied().unwrap_or(all) - to[now] {
            let patches = |all: &[Vec<(usize, usize)>], ptex: u32| {
                all.get(ptex as usize).cloned().unwrap_or_default()
            };
            let own = patches(&own, from[before] + i);
            let right = patches(&right, to[now] + i);
            assert_eq!(own.len(), right.len(), "{what}: face {before}");
            for (&(pass, patch), (other, at)) in own.iter().zip(right) {
                let own = seen(&edited.passes[pass], &of_edited, patch);
                let right = seen(&fresh.passes[other], &of_fresh, at);
                assert!(own == right, "{what}: face {before}");
                drawn += 1;
            }
        }
    }
    let all = own.iter().map(Vec::len).sum::<usize>();
    assert_eq!(drawn, all, "{what}: removed faces are not drawn");
}

/// Where each ptex face is drawn: its passes and patches, of which there are several where a method cuts faces.
pub fn all_places(prepared: &Prepared) -> Vec<Vec<(usize, usize)>> {
    let mut places: Vec<Vec<(usize, usize)>> = Vec::new();
    for (number, pass) in prepared.passes.iter().enumerate() {
        for patch in (0..pass.patches.len()).filter(|&patch| !pass.is_vacant(patch)) {
            let ptex = pass.patches[patch].ptex as usize;
            places.resize(places.len().max(ptex + 1), Vec::new());
            places[ptex].push((number, patch));
        }
    }
    places
}

/// The same of methods that do not.
fn places(prepared: &Prepared) -> Vec<Option<(usize, usize)>> {
    let once = |places: Vec<(usize, usize)>| {
        assert!(places.len() < 2, "it is drawn once");
        places.first().copied()
    };
    all_places(prepared).into_iter().map(once).collect()
}

fn bits(point: SurfacePoint) -> [u32; 6] {
    let [x, y, z] = point.position.to_array();
    let [nx, ny, nz] = point.normal.to_array();
    [x, y, z, nx, ny, nz].map(f32::to_bits)
}

/// All that can be seen of a patch at some places of its ptex face.
fn seen(pass: &Pass, controls: &Controls, patch: usize) -> Vec<[u32; 6]> {
    let record = &pass.patches[patch];
    let all = PLACES
        .iter()
        .flat_map(|&v| PLACES.iter().map(move |&u| [u, v]));
    let evaluate = |uv| {
        let uv = from_ptex(record, uv);
        bits(pass.evaluate(controls, patch, Vec2::from(uv)))
    };
    all.map(evaluate).collect()
}

/// Holds what was edited against a fresh preparation: of each ptex face that is asked for.
pub fn hold(
    edited: &Prepared,
    fresh: &Prepared,
    model: &Model,
    what: &str,
    asks: impl Fn(u32) -> bool,
) {
    let limits = |of: &Prepared| of.outline.limits(&model.positions()).expect(what);
    assert!(limits(edited) == limits(fresh), "{what}: limits");
    let [own, right] = [edited, fresh].map(places);
    let controls = fresh.controls(model.positions());
    for ptex in 0..own.len().max(right.len()) {
        let [own, right] = [&own, &right].map(|of| of.get(ptex).copied().flatten());
        assert_eq!(own.is_some(), right.is_some(), "{what}: ptex face {ptex}");
        let (Some((pass, patch)), Some((other, at))) = (own, right) else {
            continue;
        };
        let [own, right] = [&edited.passes[pass], &fresh.passes[other]];
        assert_eq!(own.shader, right.shader, "{what}: ptex face {ptex}");
        let [one, two] = [own.patches[patch], right.patches[at]];
        assert_eq!(
            (one.flags, one.valences),
            (two.flags, two.valences),
            "{what}: ptex face {ptex}"
        );
        assert_eq!(
            own.sides[patch], right.sides[at],
            "{what}: ptex face {ptex}"
        );
        assert_eq!(own.texture[patch], right.texture[at]);
        for level in 0..=10 {
            assert_eq!(
                own.points(patch, level),
                right.points(at, level),
                "{what}: ptex face {ptex}"
            );
        }
        if asks(ptex as u32) {
            let [own, right] =
                [(own, patch), (right, at)].map(|(pass, patch)| seen(pass, &controls, patch));
            let differing = own.iter().zip(&right).position(|(own, right)| own != right);
            if let Some(place) = differing {
                let [u, v] = [place % PLACES.len(), place / PLACES.len()].map(|i| PLACES[i]);
                panic!(
                    "{what}: ptex face {ptex} at {u} {v}: {:x?} {:x?}",
                    own[place], right[place]
                );
            }
        }
    }
}
