//! Meshes of the user's: which of them a case can say something about.

use std::time::Duration;

use crate::conformance::Finding;
use crate::gpu::Cut;
use crate::mesh::Model;
use crate::method::{Method, MethodOptions, Pass, Prepared, method, prepare_by_default};

/// A model that a method prepared; a finding to skip with where the method refuses it, or where there is nothing to draw. A sound mesh fails
/// no case because of that.
pub(super) fn prepared(
    model: &Model,
    method: &Method,
    options: impl Into<MethodOptions>,
) -> Result<Prepared, Finding> {
    match method.prepare(model, options) {
        Err(error) => Err(Finding::skip(format!(
            "{} refuses this mesh: {error}",
            method.name
        ))),
        Ok(prepared) if prepared.passes.is_empty() => Err(nothing()),
        Ok(prepared) => Ok(prepared),
    }
}

/// The same by the method that draws it when nobody names one, with that.
pub(super) fn by_default(model: &Model) -> Result<(&'static Method, Prepared), Finding> {
    let drawn = prepare_by_default(model, MethodOptions::default());
    let drawn = drawn.and_then(|(prepared, _)| Ok((method(prepared.method)?, prepared)));
    match drawn {
        Err(error) => Err(Finding::skip(format!("no method takes this mesh: {error}"))),
        Ok((_, prepared)) if prepared.passes.is_empty() => Err(nothing()),
        Ok(drawn) => Ok(drawn),
    }
}

fn nothing() -> Finding {
    Finding::skip("there is nothing to draw: no face has a surface")
}

/// What is prepared, without the patches that `keep` does not choose, by pass and number.
pub(super) fn chosen(prepared: &Prepared, keep: impl Fn(&Pass, usize) -> bool) -> Prepared {
    let mut chosen = prepared.clone();
    for pass in &mut chosen.passes {
        let kept: Vec<usize> = (0..pass.patches.len()).filter(|&i| keep(pass, i)).collect();
        pass.patches = kept.iter().map(|&i| pass.patches[i]).collect();
        pass.sides = kept.iter().map(|&i| pass.sides[i]).collect();
        pass.texture = kept.iter().map(|&i| pass.texture[i]).collect();
        pass.keep_stages(&kept);
    }
    chosen.passes.retain(|pass| !pass.patches.is_empty());
    chosen
}

/// What a case may take: plans of vertices where a thousand edges meet take their time before anything is drawn.
pub(super) const LIMIT: Duration = Duration::from_secs(240);

/// The most that a case draws of a mesh of the user's: sums of so many terms, a few seconds' work for a software device.
const MOST_TERMS: u64 = 1 << 25;

/// As many of the first faces as can be drawn at a cut in a case's time: where a thousand edges meet, or bound a face, each point is a sum over
/// thousands of vertices. Neighbours in the file stay together, so that they still share something.
pub(super) fn bounded(prepared: Prepared, cut: Cut) -> Prepared {
    let terms = |pass: &Pass, patch: usize| {
        let list = (pass.controls.len() / pass.patches.len()).max(1) as u64;
        list * u64::from(cut.vertices(pass, patch) + cut.points(pass, patch))
    };
    let passes = prepared.passes.iter();
    let all = passes.flat_map(|pass| {
        let patches = pass.patches.iter().enumerate();
        patches.map(move |(number, patch)| (patch.ptex, terms(pass, number)))
    });
    let mut all: Vec<(u32, u64)> = all.collect();
    all.sort_unstable();
    let mut sum = 0;
    let beyond = all.iter().find(|&&(_, terms)| {
        sum += terms;
        sum > MOST_TERMS
    });
    match beyond {
        None => prepared,
        Some(&(end, _)) => chosen(&prepared, |pass, number| {
            let ptex = pass.patches[number].ptex;
            ptex < end || ptex == all[0].0
        }),
    }
}

/// Whether faces of a model share anything: an edge, a vertex, or, where they are drawn in parts, a spoke.
pub(super) fn shares_something(model: &Model) -> bool {
    let (topology, scheme) = (model.topology(), model.mesh().options().scheme);
    let drawn = |face: &u32| !topology.is_hole(*face);
    let mut faces = 0..topology.face_count() as u32;
    let mut vertices = 0..topology.vertex_count() as u32;
    faces.any(|face| drawn(&face) && !scheme.is_whole(topology.face(face).len()))
        || vertices.any(|vertex| {
            let around = topology.vertex_faces(vertex).iter();
            around.filter(|corner| drawn(&corner.face)).count() > 1
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::Status;
    use crate::conformance::meshes::{framed_polygon, sheet};
    use crate::mesh::{BoundaryInterpolation, ControlMesh, Scheme, SchemeOptions};
    use crate::method::METHODS;

    fn model(mesh: crate::error::Result<ControlMesh>) -> Model {
        Model::new(mesh.expect("it is sound"))
    }

    #[test]
    fn what_cannot_be_drawn_is_skipped() {
        let quadtree = method("quadtree").expect("it is there");
        let found = |mesh| prepared(&model(mesh), quadtree, MethodOptions::default());
        assert!(found(sheet(3).build()).is_ok());
        let refused = found(sheet(3).tagged(|mesh| mesh.scheme(Scheme::Bilinear)));
        let refused = refused.expect_err("quadtrees are of Catmull-Clark");
        assert_eq!(refused.status, Status::Skip);
        assert!(refused.measured.contains("bilinear"), "{refused:?}");
        let boundary = BoundaryInterpolation::None;
        let options = SchemeOptions {
            boundary,
            ..Default::default()
        };
        let bare = model(sheet(1).tagged(|mesh| mesh.options(options)));
        for method in METHODS
            .iter()
            .filter(|method| method.check_model(&bare).is_ok())
        {
            let empty = prepared(&bare, method, MethodOptions::default());
            let empty = empty.expect_err("all of its faces touch the boundary");
            assert_eq!(empty.status, Status::Skip, "{}: {empty:?}", method.name);
        }
    }

    #[test]
    fn what_would_take_too_long_is_drawn_in_part() {
        let cut = crate::conformance::capture::cut(8.0, crate::tessellation::Spacing::Equal);
        let quadtree = method("quadtree").expect("it is there");
        let patches = |corners: u32| {
            let model = model(framed_polygon(corners).build());
            let whole = quadtree.prepare(&model, MethodOptions::default());
            let count = |prepared: &Prepared| {
                let passes = prepared.passes.iter();
                passes.map(|pass| pass.patches.len()).sum::<usize>()
            };
            let whole = whole.expect("quadtree draws everything");
            (count(&whole), count(&bounded(whole, cut)))
        };
        let (whole, drawn) = patches(20);
        assert_eq!(whole, drawn);
        let (whole, drawn) = patches(4000);
        assert!(drawn > 10 && drawn < whole / 2, "{drawn} of {whole}");
    }

    #[test]
    fn what_shares_nothing_is_known_beforehand() {
        let shares = |mesh| shares_something(&model(mesh));
        assert!(!shares(sheet(1).build()));
        assert!(shares(sheet(2).build()));
        assert!(shares(framed_polygon(5).build()));
        let all_but_one =
            |builder| (1..4).fold(builder, |b: crate::mesh::ControlMeshBuilder, f| b.hole(f));
        assert!(!shares(sheet(2).tagged(all_but_one)));
    }
}
