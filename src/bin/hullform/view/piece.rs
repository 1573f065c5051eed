//! By which patch, plan and node a point is evaluated that is drawn.

use hullform::glam::Vec2;
use hullform::gpu::DrawList;
use hullform::method::{Cell, Prepared, from_ptex};
use hullform::tessellation::{Domain, Levels};

/// How far beyond its sides a patch still has a point, in (u, v): as far as rounding brings it there.
const ROUNDING: f32 = 1e-4;

/// By what a point is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The plan and its node; None where the patch has none, and at its edges and corners.
    pub cell: Option<Cell>,
    /// Whether patches of this method have plans, unless they are plain.
    pub planned: bool,
    /// The tess levels of the patch.
    pub levels: Option<Levels>,
}

impl Piece {
    /// That of (u, v) of a ptex face; None where no patch draws it.
    ///
    /// `decided` are the levels of a pass's patch where the device has decided about them.
    pub fn new(
        prepared: &Prepared,
        list: &DrawList,
        decided: impl Fn(usize, usize) -> Option<Levels>,
        face: u32,
        uv: [f32; 2],
    ) -> Option<Piece> {
        let passes = prepared.passes.iter().enumerate();
        let mut all = passes.flat_map(|(pass, own)| {
            let patches = own.patches.iter().enumerate();
            let of_face = patches.filter(|(_, patch)| patch.ptex == face);
            of_face.map(move |(number, patch)| (pass, number, from_ptex(patch, uv)))
        });
        let (pass, number, at) =
            all.find(|&(pass, _, at)| has(prepared.passes[pass].domain, at))?;
        let own = &prepared.passes[pass];
        Some(Piece {
            cell: own.cell(number, Vec2::from(at)),
            planned: prepared.plans.is_some(),
            levels: decided(pass, number).or_else(|| list.levels(prepared, pass, number as u32)),
        })
    }

    /// In rows.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = Vec::new();
        match self.cell {
            Some(Cell { plan, kind, depth }) => {
                facts.push(("plan", plan.to_string()));
                facts.push(("node", format!("{}, depth {depth}", kind.name())));
            }
            None if self.planned => facts.push(("plan", "none: a plain B-spline".into())),
            None => facts.push(("plan", "none".into())),
        }
        facts.extend(self.levels.map(|levels| ("level", words(&levels))));
        facts
    }
}

/// Whether a place lies in a patch's domain.
fn has(domain: Domain, [u, v]: [f32; 2]) -> bool {
    let within = -ROUNDING..=1.0 + ROUNDING;
    let beyond = domain == Domain::Triangles && u + v > 1.0 + ROUNDING;
    within.contains(&u) && within.contains(&v) && !beyond
}

/// One number where all are alike, else that of the inside and those of the edges.
fn words(levels: &Levels) -> String {
    let count = match levels.domain {
        Domain::Triangles => 3,
        Domain::Quads => 4,
    };
    let edges = &levels.edges[..count];
    let number = |level: &f32| {
        let text = format!("{level:.2}");
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    };
    let inside = number(&levels.inside);
    match edges.iter().all(|&edge| edge == levels.inside) {
        true => inside,
        false => {
            let edges: Vec<String> = edges.iter().map(number).collect();
            format!("{inside}, edges {}", edges.join(" "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hullform::gpu::{Cut, SurfaceOptions};
    use hullform::mesh::{Model, builtin};
    use hullform::method::{METHODS, MethodOptions};
    use hullform::tessellation::Spacing;

    #[test]
    fn every_place_that_is_drawn_has_a_piece_of_every_method() {
        let cut = Cut {
            level: 5.5,
            spacing: Spacing::FractionalEven,
        };
        let (mut cells, mut plain) = (0, 0);
        for name in ["ngons", "hull", "pole-5"] {
            let model = Model::new(builtin(name).expect(name));
            let able = METHODS
                .iter()
                .filter(|method| method.check_model(&model).is_ok());
            for method in able {
                let prepared = method
                    .prepare(&model, MethodOptions::default())
                    .expect(name);
                let options = SurfaceOptions::default();
                let list = DrawList::new(&prepared, &options, None, cut, None).expect(name);
                let patches = prepared.passes.iter().flat_map(|pass| &pass.patches);
                for face in patches.map(|patch| patch.ptex) {
                    let piece =
                        Piece::new(&prepared, &list, |_, _| None, face, [0.25, 0.125]).expect(name);
                    assert!(piece.levels.is_some_and(|levels| levels.inside >= 1.0));
                    assert!(prepared.plans.is_some() || piece.cell.is_none());
                    match piece.cell {
                        Some(_) => cells += 1,
                        None => plain += 1,
                    }
                }
            }
        }
        assert!(cells > 0 && plain > 0);
    }
}
