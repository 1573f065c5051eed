//! What is said when what is drawn is not the limit, and nobody asked for that.

use std::sync::Once;

use hullform::mesh::Model;
use hullform::method::{METHODS, Prepared, method};
use hullform::subdivision::LimitSurface;
use hullform::{Error, Result};

use crate::compare::errors::{Reference, Twin};

/// Ptex faces that are tried, at most.
const FACES: usize = 64;

/// Points that are tried in each: none of them a corner or the middle of an edge, which some methods have exactly. All lie in triangles too.
const POINTS: [[f32; 2]; 5] = [
    [0.25, 0.0],
    [0.0, 0.75],
    [0.25, 0.25],
    [0.625, 0.25],
    [0.375, 0.375],
];

/// What rounding leaves of the limit, over the diagonal.
const ROUNDING: f64 = 1e-6;

/// Says, once, that a method approximates, how far off it is, and why no other draws the limit; `refusals` are those of methods that could have drawn the
/// model.
pub fn tell(model: &Model, prepared: &Prepared, refusals: &[Error]) -> Result<()> {
    static ONCE: Once = Once::new();
    let method = method(prepared.method)?;
    ONCE.call_once(|| {
        let scheme = model.mesh().options().scheme;
        let off = if method.contract.reproduces.is_limit(scheme) {
            0.0
        } else {
            farthest(model, prepared)
        };
        if off > ROUNDING {
            tracing::warn!(
                "the method {} approximates the limit of the scheme {}: where it was tried it is off by up to {:.2} % of the model's diagonal; {}",
                method.name,
                scheme,
                100.0 * off,
                why(model, refusals)
            );
        }
    });
    Ok(())
}

/// Why no method draws the limit.
fn why(model: &Model, refusals: &[Error]) -> String {
    let scheme = model.mesh().options().scheme;
    let exact = METHODS.iter().filter(|method| {
        method.contract.reproduces.is_limit(scheme) && method.check(scheme).is_ok()
    });
    let mut later = refusals.iter();
    let refusals: Vec<String> = exact
        .filter_map(|method| {
            let name = method.name;
            let refusal = match method.check_model(model) {
                Err(refusal) => refusal.to_string(),
                Ok(()) => later.next()?.to_string(),
            };
            Some(format!("{name} would draw the limit, but: {refusal}"))
        })
        .collect();
    match refusals.as_slice() {
        [] => "no method draws the limit of that scheme".into(),
        refusals => refusals.join("; "),
    }
}

/// The greatest distance from the limit at some points, over the diagonal of the control mesh's bounding box.
fn farthest(model: &Model, prepared: &Prepared) -> f64 {
    let limit = LimitSurface::new(model.mesh());
    let faces = limit.ptex_count();
    let truth = Reference::Truth(Box::new(limit), model.placement());
    let drawn = Reference::Method(Box::new(Twin::new(model, prepared.clone())));
    let diagonal = model.diagonal().max(f64::MIN_POSITIVE);
    let tried = (0..faces).step_by(faces.div_ceil(FACES).max(1));
    let distances = tried.flat_map(|face| {
        let (truth, drawn) = (&truth, &drawn);
        POINTS.iter().filter_map(move |&uv| {
            let (own, _) = drawn.evaluate(face as u32, uv)?;
            let (limit, _) = truth.evaluate(face as u32, uv)?;
            Some(own.distance(limit))
        })
    });
    distances.fold(0.0, f64::max) / diagonal
}
