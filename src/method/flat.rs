//! `flat`: bilinear patches. The speed of light that other methods are compared with, and the plainest row of the table.
//!
//! Each of a patch's four control points is the mean of some control vertices: of one at a corner of the mesh, of two in the middle of an
//! n-gon's edge, of all in its centre.

use glam::{Vec2, Vec3};

use crate::error::Result;
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::patches::{self, Part};
use crate::method::{Contract, Domain, Method, Pass, Prepared, Surface};
use crate::plan::PlanOptions;

/// The row of the table.
pub const METHOD: Method = Method {
    name: "flat",
    summary: "bilinear patches over the control mesh",
    paper: "none: the baseline",
    domain: Domain::Quads,
    contract: Contract {
        limit: None,
        normals: None,
        interpolates: true,
        watertight: false,
    },
    prepare,
};

fn prepare(model: &Model, _options: PlanOptions) -> Result<Prepared> {
    let topology = model.topology();
    let mut pass = Pass {
        shader: "flat",
        control_points: 4,
        patches: Vec::new(),
        controls: Vec::new(),
        texture: Vec::new(),
        tables: Vec::new(),
        scratch_points: Vec::new(),
        max_level: crate::abi::HIGHEST_LEVEL,
        twin,
    };
    for part in patches::parts(model) {
        let mut patch = patches::patch(topology, part, 0);
        patch.controls = pass.controls.len() as u32;
        pass.controls.extend(controls(topology, part));
        pass.texture.push(patches::texture(model, part, 0));
        pass.patches.push(patch);
    }
    Ok(Prepared {
        passes: vec![pass],
        plans: None,
    })
}

/// Where the vertices of each of the four points end, counted from the list's begin, then the vertices.
fn controls(topology: &Topology, part: Part) -> Vec<u32> {
    let vertices = topology.face(part.face);
    let (n, i) = (vertices.len(), part.corner as usize);
    let points: [Vec<u32>; 4] = if n == 4 {
        std::array::from_fn(|corner| vec![vertices[corner]])
    } else {
        [
            vec![vertices[i]],
            vec![vertices[i], vertices[(i + 1) % n]],
            vertices.to_vec(),
            vec![vertices[i], vertices[(i + n - 1) % n]],
        ]
    };
    let mut end = 4;
    let ends = points.iter().map(|point| {
        end += point.len() as u32;
        end
    });
    ends.collect::<Vec<u32>>()
        .into_iter()
        .chain(points.concat())
        .collect()
}

fn twin(pass: &Pass, positions: &[Vec3], patch: usize, uv: Vec2) -> Surface {
    let controls = &pass.controls[pass.patches[patch].controls as usize..];
    let point = |corner: usize| {
        let start = if corner == 0 { 4 } else { controls[corner - 1] } as usize;
        let vertices = &controls[start..controls[corner] as usize];
        vertices
            .iter()
            .map(|&vertex| positions[vertex as usize])
            .sum::<Vec3>()
            / vertices.len() as f32
    };
    let [a, b, c, d] = std::array::from_fn(point);
    let (bottom, top) = (a * (1.0 - uv.x) + b * uv.x, d * (1.0 - uv.x) + c * uv.x);
    Surface {
        position: bottom * (1.0 - uv.y) + top * uv.y,
        du: (b - a) * (1.0 - uv.y) + (c - d) * uv.y,
        dv: top - bottom,
    }
}
