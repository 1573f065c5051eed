//! `dfas`: dynamic feature-adaptive subdivision (Schäfer, Raab, Keinert, Meyer, Stamminger, Nießner 2015, "Dynamic feature-adaptive subdivision"; as Brainerd et
//! al. 2016, sections 2 and 9.3, tell it): `fas` with an own depth for each irregularity in each frame, as deep as the tess levels around it need. A frame
//! draws the patches of these depths alone, and only the points of these are computed.
//!
//! All depths are prepared once a topology: the B-splines of each, and end caps of each for frames that go no deeper there. Which are drawn is decided with
//! the draw list, on the host; where the device decides about levels all irregularities have the depth of the cut.
//!
//! The control mesh is refined once around everything irregular. What is irregular then and hangs together by edges is one irregularity (an extraordinary
//! vertex, a crease with all that meets it), so that all faces around a vertex end at one depth, and beside an end cap lie B-splines of its own depth, which
//! are the same curve on their edge: the corners of caps, and no more of them where levels are whole, are vertices. Beside an infinitely sharp edge a face is
//! refined along with the one beyond, though it is a B-spline without. So there are no gaps, though bits may differ.
//!
//! Patches, caps and shaders' arithmetic are those of `method/fas.rs`. The paper fills its patch buffer on the device; a draw list has the same patches.
//! Displaced surfaces with fractional levels may open at end caps: whether a cap lies beyond an edge is not known to shaders.

mod levels;

use glam::Vec2;

use crate::error::Result;
use crate::mesh::Model;
use crate::method::fas;
use crate::method::surface::{Controls, SurfacePoint};
use crate::method::{Method, MethodOptions, Pass, Prepared};
use crate::plan::Database;
use levels::Growth;

/// The row of the table: what `fas` is, but for when its depth is decided.
pub const METHOD: Method = Method {
    name: "dfas",
    summary: "feature-adaptive subdivision whose depth each irregularity has for itself in each frame",
    paper: "Schäfer, Raab, Keinert, Meyer, Stamminger, Nießner 2015",
    dynamic: true,
    prepare,
    ..fas::METHOD
};

fn prepare(model: &Model, options: MethodOptions, _database: &Database) -> Result<Prepared> {
    let isolation = options.isolation.check()?;
    let mut passes = fas::passes("dfas", isolation.caps);
    passes[0].twin = spline;
    Ok(Growth::new(model, passes, isolation.caps, isolation.level).grow())
}

/// A B-spline patch, as there.
fn spline(pass: &Pass, given: &Controls, patch: usize, uv: Vec2) -> SurfacePoint {
    fas::spline(pass, given, patch, uv)
}

#[cfg(test)]
mod tests;
