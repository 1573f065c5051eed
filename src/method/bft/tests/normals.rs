//! Normals: by subdivision shading from each level, and the limit's own.

use super::*;

/// Points of a lattice with the normals that are there: pass, patch, where, and what the twin says.
type Found<'a> = (&'a Pass, usize, [f32; 2], Vec3);

/// Calls `look` with every `stride`th point of the lattice of every patch.
fn each_normal(model: &Model, options: TableOptions, stride: u32, mut look: impl FnMut(Found<'_>)) {
    let prepared = METHOD.prepare(model, options).expect("tables cover it");
    let controls = prepared.controls(model.positions());
    let n = 1u32 << options.level;
    for pass in &prepared.passes {
        for patch in 0..pass.patches.len() {
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let kept = (i * 7 + j * 13 + patch as u32).is_multiple_of(stride);
                if kept && (pass.domain == Domain::Quads || i + j <= n) {
                    let uv = [i, j].map(|x| x as f32 / n as f32);
                    let own = pass.evaluate(&controls, patch, Vec2::from(uv));
                    look((pass, patch, uv, own.normal));
                }
            }
        }
    }
}

/// Where (u, v) of a patch lies in its face of the refined mesh, which has the patch's corner 0 at `turn`.
fn in_face(corners: usize, turn: usize, [u, v]: [f32; 2]) -> [f32; 2] {
    match corners {
        3 => {
            let mut weights = [1.0 - u - v, u, v];
            weights.rotate_right(turn);
            [weights[1], weights[2]]
        }
        _ => (0..turn).fold([u, v], |[u, v], _| [1.0 - v, u]),
    }
}

/// The normal field of Alexa and Boubekeur 2008 in f64: the limit of the scheme with the unit normals of the mesh refined `from` times for vertices.
struct Shading {
    /// Over the mesh refined twice if shading begins there, else once.
    limit: LimitSurface,
    once: Topology,
    faces: std::collections::HashMap<Vec<u32>, u32>,
    twice: bool,
}

impl Shading {
    fn new(model: &Model, from: u32) -> Shading {
        let scheme = model.mesh().options().scheme;
        let blended = |masks: &[Mask], values: &[DVec3]| -> Vec<DVec3> {
            masks
                .iter()
                .map(|mask| DVec3::blend(mask, values))
                .collect()
        };
        let positions: Vec<DVec3> = model.mesh().positions().to_vec();
        let once = refine_all(model.topology(), scheme);
        let refined = blended(&once.masks, &positions);
        let (mesh, normals) = match from {
            0 => {
                let coarse = vertex_normals(model.topology(), &positions);
                let carried = blended(&once.masks, &coarse);
                let unit = carried.iter().map(|normal| normal.normalize_or_zero());
                (once.topology.clone(), unit.collect())
            }
            1 => {
                let normals = vertex_normals(&once.topology, &refined);
                (once.topology.clone(), normals)
            }
            _ => {
                let twice = refine_all(&once.topology, scheme);
                let positions = blended(&twice.masks, &refined);
                let normals = vertex_normals(&twice.topology, &positions);
                (twice.topology, normals)
            }
        };
        let faces = (0..once.topology.face_count() as u32).map(|face| {
            let mut vertices = once.topology.face(face).to_vec();
            vertices.sort_unstable();
            (vertices, face)
        });
        Shading {
            limit: LimitSurface::new(&with_values(model, &mesh, &normals)),
            faces: faces.collect(),
            once: once.topology,
            twice: from == 2,
        }
    }

    /// The unit normal at a point of a patch.
    fn normal(&self, pass: &Pass, patch: usize, uv: [f32; 2]) -> DVec3 {
        let n = pass.domain.corners();
        // The face's corners are the first of its points.
        let corners = &pass.controls[pass.patches[patch].controls as usize..][..n];
        let mut sorted = corners.to_vec();
        sorted.sort_unstable();
        let face = self.faces[&sorted];
        let turn = self.once.face(face).iter().position(|&v| v == corners[0]);
        let uv = in_face(n, turn.expect("its own corner"), uv);
        let (face, uv) = if self.twice {
            let (first, count) = match n {
                3 => (abi::CHILD_OF_TRIANGLE, 4),
                _ => (abi::CHILD_OF_QUAD, 4),
            };
            let children = (0..count).map(|child| {
                let flags = (first + child) << abi::PATCH_CHILD_SHIFT;
                let patch = abi::Patch {
                    flags,
                    ..Default::default()
                };
                (4 * face + child, from_ptex(&patch, uv))
            });
            let mut own = children.filter(|(_, uv)| pass.domain.contains(*uv));
            own.next().expect("some child has it")
        } else {
            (face, uv)
        };
        let [u, v] = uv.map(f64::from);
        let sample = self.limit.evaluate(face as usize, u, v);
        sample.expect("holes are not drawn").position.normalize()
    }
}

/// The sum of the areas of the faces at a vertex, of unit length.
fn vertex_normals(topology: &Topology, positions: &[DVec3]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for face in 0..topology.face_count() as u32 {
        let vertices = topology.face(face);
        let spoke = |i: usize| positions[vertices[i] as usize] - positions[vertices[0] as usize];
        let area: DVec3 = (1..vertices.len() - 1)
            .map(|i| spoke(i).cross(spoke(i + 1)))
            .sum();
        for &vertex in vertices {
            normals[vertex as usize] += area;
        }
    }
    normals
        .iter()
        .map(|normal| normal.normalize_or_zero())
        .collect()
}

/// A refined mesh of the model with other values at its vertices.
fn with_values(model: &Model, topology: &Topology, values: &[DVec3]) -> ControlMesh {
    let values: Vec<[f64; 3]> = values.iter().map(|value| value.to_array()).collect();
    let all = 0..topology.face_count() as u32;
    let sizes: Vec<u32> = all
        .clone()
        .map(|face| topology.face(face).len() as u32)
        .collect();
    let faces: Vec<u32> = all
        .clone()
        .flat_map(|face| topology.face(face).to_vec())
        .collect();
    let mut builder = ControlMesh::builder(&values, &sizes, &faces).options(model.mesh().options());
    for hole in all.filter(|&face| topology.is_hole(face)) {
        builder = builder.hole(hole);
    }
    builder.build().expect("it is sound")
}

#[test]
fn shading_begins_at_the_level_that_is_asked_for() {
    let mut models = vec![
        mixed(),
        model(fan(18, true), Scheme::Loop),
        model(fan(40, false), Scheme::Loop),
    ];
    for &scheme in METHOD.schemes {
        models.extend(["sheet", "ngons", "pole-5"].map(|name| model(smooth(name), scheme)));
    }
    for model in &models {
        let mut fields = Vec::new();
        for from in 0..=2 {
            let truth = Shading::new(model, from);
            let options = TableOptions {
                level: 3,
                normals: TableNormals::Shading(from),
            };
            let (mut worst, mut field) = (0.0f64, Vec::new());
            each_normal(model, options, 11, |(pass, patch, uv, own)| {
                let right = truth.normal(pass, patch, uv);
                worst = worst.max(own.as_dvec3().distance(right));
                field.push(own);
            });
            let scheme = model.mesh().options().scheme;
            println!(
                "{scheme} {} faces, level {from}: {worst:e}",
                model.mesh().face_count()
            );
            assert!(worst <= 3e-6, "{scheme}, level {from}: {worst}");
            assert!(
                !fields.contains(&field),
                "each level has normals of its own"
            );
            fields.push(field);
        }
    }
}

/// The butterfly's limit has no tangent plane at boundary vertices of other than three faces.
fn is_irregular_boundary(topology: &Topology, vertex: u32) -> bool {
    let faces = topology.vertex_faces(vertex).len();
    faces != topology.vertex_edges(vertex).len() && faces != 3
}

#[test]
fn geometric_normals_are_those_of_the_limit() {
    let mut models = vec![mixed()];
    for n in (3..=18).chain([40]) {
        models.extend([true, false].map(|closed| model(fan(n, closed), Scheme::Loop)));
    }
    for &scheme in METHOD.schemes {
        models.extend(["sheet", "ngons", "pole-5"].map(|name| model(smooth(name), scheme)));
    }
    for model in &models {
        let truth = LimitSurface::new(model.mesh());
        let options = TableOptions {
            level: 3,
            normals: TableNormals::Geometric,
        };
        let scheme = model.mesh().options().scheme;
        let refined = refine_all(model.topology(), scheme).topology;
        let mut worst = 0.0f64;
        each_normal(model, options, 11, |(pass, patch, uv, own)| {
            let record = &pass.patches[patch];
            if let Spot::Corner(corner) = spot(pass.domain, Vec2::from(uv)) {
                let vertex = pass.controls[(record.controls + corner) as usize];
                if scheme == Scheme::Butterfly && is_irregular_boundary(&refined, vertex) {
                    return;
                }
            }
            let [u, v] = to_ptex(record, uv).map(f64::from);
            let right = truth.evaluate(record.ptex as usize, u, v);
            let right = right.expect("holes are not drawn").normal();
            let own = own.as_dvec3();
            worst = worst.max(own.cross(right).length().atan2(own.dot(right)));
        });
        println!("{scheme} {} faces: {worst:e}", model.mesh().face_count());
        assert!(worst <= 1e-5, "{scheme}: {worst}");
    }
}

/// Where all vertices lie on a line, tangents differ by rounding alone: that is no normal.
#[test]
fn geometric_normals_are_never_rounding() {
    let options = TableOptions {
        level: 2,
        normals: TableNormals::Geometric,
    };
    let (from, along) = (DVec3::new(0.31, -0.77, 0.43), DVec3::new(0.3, 0.7, -0.21));
    for &scheme in METHOD.schemes {
        let mesh = model(smooth("sheet"), scheme);
        let place = |p: &DVec3| (from + (0.9 * p.x + 0.37 * p.z) * along).to_array();
        let positions: Vec<[f64; 3]> = mesh.mesh().positions().iter().map(place).collect();
        let sizes: Vec<u32> = mesh.mesh().faces().map(|face| face.len() as u32).collect();
        let faces: Vec<u32> = mesh.mesh().faces().flatten().copied().collect();
        let line = ControlMesh::builder(&positions, &sizes, &faces).scheme(scheme);
        let line = Model::new(line.build().expect("it is sound"));
        let mut seen = 0;
        each_normal(&line, options, 7, |(_, _, uv, own)| {
            assert_eq!(own, Vec3::ZERO, "{scheme} at {uv:?}");
            seen += 1;
        });
        assert!(seen > 100, "{seen}");
    }
}
