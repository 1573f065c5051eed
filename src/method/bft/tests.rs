mod normals;

use glam::{DVec3, Vec2};

use super::*;
use crate::error::Error;
use crate::mesh::{ControlMesh, INFINITE_SHARPNESS, Triangulation, builtin, triangulated};
use crate::method::{Table, from_ptex, to_ptex};
use crate::subdivision::{Blend, LimitSurface, Mask};

fn model(mesh: ControlMesh, scheme: Scheme) -> Model {
    let mesh = if scheme.is_triangular() {
        triangulated(&mesh, Triangulation::ShortestDiagonal).expect("it is sound")
    } else {
        mesh
    };
    Model::new(
        mesh.with_scheme(scheme)
            .expect("it has what the scheme takes"),
    )
}

/// A built-in shape with its holes, but without creases and corners.
fn smooth(name: &str) -> ControlMesh {
    let mesh = builtin(name).expect("a built-in shape");
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let sizes: Vec<u32> = mesh.faces().map(|face| face.len() as u32).collect();
    let faces: Vec<u32> = mesh.faces().flatten().copied().collect();
    let builder = ControlMesh::builder(&positions, &sizes, &faces).options(mesh.options());
    let builder = mesh
        .holes()
        .iter()
        .fold(builder, |builder, &hole| builder.hole(hole));
    builder.build().expect("it was sound before")
}

/// A fan of `n` triangles, closed or open, with another ring of faces around it, over a bumpy height.
fn fan(n: usize, closed: bool) -> ControlMesh {
    let count = if closed { n } else { n + 1 };
    let angle =
        |i: usize| if closed { 1.0 } else { 0.5 } * std::f64::consts::TAU * i as f64 / n as f64;
    let mut positions = vec![[0.0, 0.0, 0.3]];
    for ring in 1..=3 {
        positions.extend((0..count).map(|i| {
            let (r, a) = (f64::from(ring), angle(i));
            [r * a.cos(), r * a.sin(), 0.2 * (3.0 * a + r).sin()]
        }));
    }
    let at = |ring: usize, i: usize| (1 + ring * count + i % count) as u32;
    let (mut sizes, mut faces) = (Vec::new(), Vec::new());
    for i in 0..n {
        sizes.push(3);
        faces.extend([0, at(0, i), at(0, i + 1)]);
        for ring in 0..2 {
            sizes.extend([3, 3]);
            faces.extend([at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)]);
            faces.extend([at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)]);
        }
    }
    let mesh = ControlMesh::builder(&positions, &sizes, &faces);
    mesh.build().expect("it is sound")
}

/// The greatest distance over the diagonal between the twin and the truth, at every `stride`th point of the lattice of every patch.
fn worst(model: &Model, level: u32, stride: u32) -> f64 {
    let options = TableOptions {
        level,
        ..Default::default()
    };
    let prepared = METHOD.prepare(model, options).expect("tables cover it");
    let truth = LimitSurface::new(model.mesh());
    let controls = prepared.controls(model.positions());
    let diagonal = model.diagonal();
    let n = 1u32 << level;
    let mut samples = Vec::new();
    for pass in &prepared.passes {
        for patch in 0..pass.patches.len() {
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let kept = (i * 7 + j * 13 + patch as u32).is_multiple_of(stride);
                if kept && (pass.domain == Domain::Quads || i + j <= n) {
                    samples.push((pass, patch, [i, j].map(|x| x as f32 / n as f32)));
                }
            }
        }
    }
    let off = samples.into_par_iter().map(|(pass, patch, uv)| {
        assert!(pass.is_on_lattice(uv));
        let record = &pass.patches[patch];
        let [u, v] = to_ptex(record, uv).map(f64::from);
        let right = truth.evaluate(record.ptex as usize, u, v);
        let right = right.expect("holes are not drawn").position;
        let own = pass.evaluate(&controls, patch, Vec2::from(uv));
        let right = model.placement().local(right);
        own.position.as_dvec3().distance(right) / diagonal
    });
    off.reduce(
        || 0.0,
        |a, b| {
            if a.is_nan() || b.is_nan() {
                f64::NAN
            } else {
                a.max(b)
            }
        },
    )
}

#[test]
fn the_lattice_lies_on_the_limit_of_every_scheme() {
    for &scheme in METHOD.schemes {
        for name in ["cube", "sheet", "ngons", "pole-5"] {
            let off = worst(&model(smooth(name), scheme), 3, 17);
            assert!(off <= 1e-6, "{scheme} {name}: {off}");
        }
    }
}

#[test]
fn the_lattice_lies_on_the_limit_at_every_valence() {
    for n in (3..=18).chain([40]) {
        for closed in [true, false] {
            let off = worst(&model(fan(n, closed), Scheme::Loop), 5, 1009);
            assert!(off <= 1e-6, "{n} triangles, closed: {closed}: {off}");
        }
    }
}

#[test]
fn every_table_level_is_on_the_limit() {
    for level in 1..=TableOptions::GREATEST_LEVEL {
        let off = worst(&model(fan(7, false), Scheme::Loop), level, 101);
        assert!(off <= 1e-6, "level {level}: {off}");
    }
}

#[test]
fn weights_sum_to_one() {
    for &scheme in METHOD.schemes {
        let model = model(smooth("ngons"), scheme);
        let refined = refine_all(model.topology(), scheme).topology;
        let options = TableOptions {
            level: 3,
            ..Default::default()
        };
        let tables = Tables::new(refined, None, scheme, options);
        for (face, found) in (0..).zip(&tables.configurations) {
            let found = found.as_ref().expect("no face is a hole");
            let weights = &tables.weights[tables.kinds[face] as usize];
            for row in weights.chunks(found.vertices.len()) {
                let sum: f32 = row.iter().sum();
                assert!((sum - 1.0).abs() < 2e-6, "{scheme}: {sum}");
            }
        }
    }
}

#[test]
fn tables_that_no_device_has_to_bind_are_refused() {
    let pass = |bytes: u64| {
        let mut pass = Pass::new("bft", Domain::Triangles, 1, twin);
        pass.tables = vec![Table::of(&vec![0u32; bytes as usize / 4])];
        pass
    };
    assert!(check_size(&pass(MOST_BYTES)).is_ok());
    let refused = check_size(&pass(MOST_BYTES + 4)).expect_err("it is too large");
    assert!(
        refused
            .to_string()
            .starts_with("--table-level: the tables take 134217732 bytes")
    );
}

/// The configurations that fans of up to 18 edges have, each once, with the mesh that it is in.
fn up_to_valence_18() -> Vec<(Topology, Configuration)> {
    let mut found = std::collections::BTreeMap::new();
    // A boundary vertex of 18 edges has 17 faces.
    let closed = (3..=18).map(|n| fan(n, true));
    for mesh in closed.chain((1..=17).map(|n| fan(n, false))) {
        let model = model(mesh, Scheme::Loop);
        let refined = refine_all(model.topology(), Scheme::Loop).topology;
        for face in 0..refined.face_count() as u32 {
            let configuration = configuration(&refined, face, 1);
            let key = configuration.key.clone();
            found
                .entry(key)
                .or_insert_with(|| (refined.clone(), configuration));
        }
    }
    found.into_values().collect()
}

/// Section III: "about 9 MB for tables of level 5 for interior and boundary cases up to valence 18".
#[test]
fn tables_up_to_valence_18_take_no_more_memory_than_the_papers() {
    let configurations = up_to_valence_18();
    let lattice = Lattice::new(Domain::Triangles, 5);
    let start = std::time::Instant::now();
    let tables: Vec<Vec<f32>> = configurations
        .par_iter()
        .map(|(topology, found)| table::weights(topology, Scheme::Loop, found, lattice))
        .collect();
    let (count, elapsed) = (tables.len(), start.elapsed());
    let bytes: usize = tables.iter().map(|table| 4 * table.len()).sum();
    println!("{count} tables, {bytes} bytes, {elapsed:?}");
    assert!(bytes <= 9_000_000, "{bytes} bytes");
}

/// Both patches of every edge, at points of the lattice and between, whichever shapes meet there.
#[test]
fn both_sides_of_an_edge_have_the_same_bits() {
    for &scheme in METHOD.schemes {
        for name in ["ngons", "sheet", "pole-5"] {
            hold_edges(&model(smooth(name), scheme), TableOptions::default());
        }
    }
    hold_edges(&mixed(), TableOptions::default());
}

#[test]
fn whatever_normals_have_the_same_bits_on_both_sides_of_an_edge() {
    for normals in NORMALS {
        let options = TableOptions { level: 3, normals };
        for &scheme in METHOD.schemes {
            hold_edges(&model(smooth("sheet"), scheme), options);
        }
        hold_edges(&mixed(), options);
    }
}

const NORMALS: [TableNormals; 4] = [
    TableNormals::Shading(0),
    TableNormals::Shading(1),
    TableNormals::Shading(2),
    TableNormals::Geometric,
];

/// A triangle on a quad, with a pentagon beside it.
fn mixed() -> Model {
    let positions: Vec<[f64; 3]> = (0..9)
        .map(|i| {
            [
                f64::from(i % 3),
                f64::from(i / 3),
                f64::from(i * i % 5) * 0.1,
            ]
        })
        .collect();
    let faces = [0, 1, 4, 3, 1, 2, 4, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7];
    let mesh = ControlMesh::builder(&positions, &[4, 3, 3, 4, 4], &faces);
    model(mesh.build().expect("it is sound"), Scheme::LoopStam)
}

#[test]
fn triangles_beside_quads_lie_on_the_limit() {
    let off = worst(&mixed(), 3, 5);
    assert!(off <= 1e-6, "{off}");
}

fn hold_edges(model: &Model, options: TableOptions) {
    let prepared = METHOD.prepare(model, options).expect("tables cover it");
    let controls = prepared.controls(model.positions());
    let refined = refine_all(model.topology(), model.mesh().options().scheme).topology;
    let mut seen = std::collections::HashMap::new();
    let mut twice = 0;
    for pass in &prepared.passes {
        let n = pass.domain.corners();
        for patch in 0..pass.patches.len() {
            // The face's corners are the first of its points.
            let first = pass.patches[patch].controls as usize;
            for side in 0..n {
                let ends = [side, (side + 1) % n].map(|i| pass.controls[first + i]);
                for step in 0..=96u32 {
                    let t = ((step * 65536 + 48) / 96) as f32 / 65536.0;
                    let point = pass.evaluate(&controls, patch, on_edge(pass.domain, side, t));
                    let bits =
                        [point.position, point.normal].map(|v| v.to_array().map(f32::to_bits));
                    let key = if ends[0] < ends[1] {
                        (ends, t)
                    } else {
                        ([ends[1], ends[0]], 1.0 - t)
                    };
                    let key = (key.0, key.1.to_bits());
                    if let Some(known) = seen.insert(key, bits) {
                        assert_eq!(known, bits, "edge {ends:?} at {t}");
                        twice += 1;
                    }
                }
            }
        }
    }
    assert!(twice > refined.edge_count());
}

fn on_edge(domain: Domain, side: usize, t: f32) -> Vec2 {
    match (domain, side) {
        (_, 0) => Vec2::new(t, 0.0),
        (Domain::Triangles, 1) => Vec2::new(1.0 - t, t),
        (Domain::Triangles, _) => Vec2::new(0.0, 1.0 - t),
        (_, 1) => Vec2::new(1.0, t),
        (_, 2) => Vec2::new(1.0 - t, 1.0),
        _ => Vec2::new(0.0, 1.0 - t),
    }
}

#[test]
fn what_tables_do_not_cover_is_refused_by_name() {
    let refusal = |mesh: ControlMesh| {
        let model = Model::new(mesh);
        match METHOD.prepare(&model, MethodOptions::default()) {
            Err(error @ Error::Input { .. }) => error.to_string(),
            other => format!("{other:?}"),
        }
    };
    let grid = |sizes: &[u32], faces: &[u32]| {
        let positions: Vec<[f64; 3]> = (0..9)
            .map(|i| [f64::from(i % 3), f64::from(i / 3), 0.0])
            .collect();
        ControlMesh::builder(&positions, sizes, faces)
    };
    let whole = [0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7];
    let build = |builder: crate::mesh::ControlMeshBuilder| builder.build().expect("it is sound");
    let crease = build(grid(&[4; 4], &whole).crease(1, 4, 2.0));
    assert_eq!(
        refusal(crease),
        "edge 1-4: it is a crease, and the method bft has no table for that; remove the crease, or use --method quadtree"
    );
    let sharp = build(grid(&[4; 4], &whole).corner(4, INFINITE_SHARPNESS));
    assert!(refusal(sharp).starts_with("vertex 4: it is sharp"));
    let corner = build(grid(&[4; 4], &whole).corner(0, INFINITE_SHARPNESS));
    assert!(worst(&model(corner, Scheme::CatmullClark), 3, 3) <= 1e-6);
    let bow = build(grid(&[4; 2], &[0, 1, 4, 3, 4, 5, 8, 7]));
    assert!(refusal(bow).starts_with("vertex 4: it joins faces"));
    let fin = build(grid(&[3; 3], &[0, 1, 4, 1, 0, 3, 0, 1, 2]));
    assert!(refusal(fin).starts_with("edge 0-1: it has 3 faces"));
    let turned = build(grid(&[3; 2], &[0, 1, 4, 0, 1, 3]));
    assert!(refusal(turned).contains("in the same direction"));
}
