//! What is drawn of macro faces looks as if they were single ones.

use std::collections::{BTreeSet, HashMap};

use hullform::frame::{
    Backend, Cut, DrawList, Residence, SurfaceOptions, Tessellated, TessellatedPoint,
};
use hullform::mesh::topology::Topology;
use hullform::mesh::{Model, builtin};
use hullform::method::{DepthTags, METHODS, MacroFaces, Method, Prepared, to_ptex};
use hullform::plan::Database;
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};
use proptest::prelude::*;

use crate::common::meshes::{cases, wild};
use crate::{cube, grid};

/// The method that draws faces together.
fn method() -> &'static Method {
    let mut methods = METHODS.iter();
    methods
        .find(|method| method.aggregates)
        .expect("there is one")
}

fn cut(level: u32) -> Cut {
    Cut {
        level: level as f32,
        spacing: Spacing::Equal,
    }
}

/// Options for whatever ring it takes.
fn options(level: u32) -> SurfaceOptions {
    SurfaceOptions {
        ring_bytes: u64::MAX,
        greatest_level: level as f32,
        ..Default::default()
    }
}

/// What is drawn of a model; None where that has more around a vertex than will be planned.
fn drawn(model: &Model, faces: MacroFaces, level: u32) -> Option<(Prepared, Tessellated)> {
    let prepared = method().prepare(model, faces).ok()?;
    let list = DrawList::new(&prepared, &options(level), None, cut(level), None);
    let list = list.expect("all is sound");
    let tessellated = list.tessellate(&prepared, &prepared.controls(model.positions()));
    let tessellated = tessellated.expect("it belongs to it");
    Some((prepared, tessellated))
}

type Bits = [u32; 3];

/// The bits of position and normal at each place of a ptex face.
fn places((prepared, all): &(Prepared, Tessellated)) -> HashMap<(u32, [u32; 2]), [Bits; 2]> {
    let points = all.points.iter().map(|point| {
        let pass = &prepared.passes[point.pass as usize];
        let (slot, uv) = pass.face_at(point.patch as usize, point.uv);
        let face = &pass.patches[slot];
        let surface = [point.surface.position, point.surface.normal];
        let bits = surface.map(|vector| vector.to_array().map(f32::to_bits));
        ((face.ptex, to_ptex(face, uv).map(f32::to_bits)), bits)
    });
    points.collect()
}

/// How many edges of triangles have no other beside them, by the bits of their ends.
fn open_edges(all: &Tessellated) -> u32 {
    let mut edges: HashMap<[Bits; 2], i32> = HashMap::new();
    let at = |point: u32| {
        let position = all.points[point as usize].surface.position;
        position.to_array().map(f32::to_bits)
    };
    for triangle in &all.triangles {
        let [a, b, c] = triangle.map(at);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            match from < to {
                true => *edges.entry([from, to]).or_default() += 1,
                false => *edges.entry([to, from]).or_default() -= 1,
            }
        }
    }
    edges.values().map(|times| times.unsigned_abs()).sum()
}

/// Each vertex of a macro face is one of its faces', to the bit; no vertex of a face is missing; and there are no cracks.
fn check_drawn(model: &Model, faces: MacroFaces) {
    // At others places of vertices are rounded, and devices round them alike on both sides of an edge.
    let levels = [1, 2, 4, 8].into_iter();
    for level in levels.filter(|&level| level <= faces.greatest_level()) {
        let Some(together) = drawn(model, faces, level) else {
            return;
        };
        let apart = drawn(model, MacroFaces::None, level).expect("as before");
        assert_eq!(
            open_edges(&together.1),
            open_edges(&apart.1),
            "{faces:?} {level}"
        );
        let [together, apart] = [&together, &apart].map(places);
        for (place, bits) in &together {
            match apart.get(place) {
                Some(own) => assert_eq!(bits, own, "{faces:?} {level} {place:?}"),
                // With one row of cells the tessellator still makes two of segments.
                None => assert_eq!(level, 1, "{faces:?} {place:?} is no face's"),
            }
        }
        let positions: BTreeSet<Bits> = together.values().map(|bits| bits[0]).collect();
        for (place, [position, _]) in &apart {
            // Beside an n-gon a single face at level 1 has a vertex in its middle.
            if level == 1 && place.1 == [0.5f32.to_bits(); 2] {
                continue;
            }
            assert!(
                positions.contains(position),
                "{faces:?} {level}: {place:?} is missing"
            );
        }
    }
}

/// Which faces are drawn alone of what single patches draw: the pass and the slot, by ptex face.
fn singles(prepared: &Prepared) -> HashMap<u32, (usize, usize)> {
    let passes = prepared.passes.iter().enumerate();
    let patches = passes.flat_map(|(number, pass)| {
        let patches = pass.patches.iter().enumerate();
        patches.map(move |(slot, patch)| (patch.ptex, (number, slot)))
    });
    patches.collect()
}

/// Of each edge of the mesh, how many of its faces are drawn.
fn drawn_faces(topology: &Topology, known: &HashMap<u32, (usize, usize)>) -> Vec<u32> {
    let mut drawn = vec![0; topology.edge_count()];
    let mut ptex = 0;
    for face in 0..topology.face_count() as u32 {
        let edges = topology.face_edges(face);
        if known.contains_key(&ptex) {
            edges.iter().for_each(|&edge| drawn[edge as usize] += 1);
        }
        ptex += if edges.len() == 4 {
            1
        } else {
            edges.len() as u32
        };
    }
    drawn
}

/// With a depth for each vertex: each vertex is still one of its faces', to the bit, and nothing is open but the boundary. Tells how many macro faces have
/// sides of different levels.
fn check_tagged(model: &Model, faces: MacroFaces) -> usize {
    let level: u32 = if faces.greatest_level() < 8 { 4 } else { 8 };
    let depth =
        |vertex: usize| (vertex.wrapping_mul(0x9e37_79b9) >> 16) as u32 % (level.ilog2() + 1);
    let depths = (0..model.mesh().vertex_count()).map(|vertex| depth(vertex) as f32);
    let tags = DepthTags::new(depths.collect::<Vec<f32>>());
    let prepare = |faces: MacroFaces| method().prepare(model, faces).ok();
    let Some((prepared, single)) = prepare(faces).zip(prepare(MacroFaces::None)) else {
        return 0;
    };
    let list = DrawList::new(&prepared, &options(level), None, cut(level), Some(&tags));
    let list = list.expect("levels may differ");
    let controls = prepared.controls(model.positions());
    let all = list
        .tessellate(&prepared, &controls)
        .expect("it belongs to it");
    let known = singles(&single);
    let own = |point: &TessellatedPoint| {
        let pass = &prepared.passes[point.pass as usize];
        let (slot, uv) = pass.face_at(point.patch as usize, point.uv);
        (known[&pass.patches[slot].ptex], uv)
    };
    for point in &all.points {
        let ((pass, slot), uv) = own(point);
        let alone = single.passes[pass].evaluate(&controls, slot, uv.into());
        assert_eq!(point.surface, alone, "{faces:?} {point:?}");
    }
    let edges = model.topology().edge_count();
    let drawn = drawn_faces(model.topology(), &known);
    // The edges without another face on which a point lies; at a vertex all of these.
    let ends = single.outline.edges();
    let rims = |point: &TessellatedPoint| {
        let ((pass, slot), [u, v]) = own(point);
        let on = [v == 0.0, u == 1.0, v == 1.0, u == 0.0];
        let sides = single.passes[pass].sides[slot].into_iter().zip(on);
        let sides = sides.filter(|&(side, on)| on && (side as usize) < edges);
        let sides: Vec<u32> = sides.map(|(side, _)| side).collect();
        let mut all: BTreeSet<u32> = sides.iter().copied().collect();
        if let &[a, b] = &sides[..] {
            let [a, b] = [a, b].map(|edge| ends[edge as usize]);
            let around = a.into_iter().filter(|vertex| b.contains(vertex));
            all.extend(around.flat_map(|vertex| model.topology().vertex_edges(vertex)));
        }
        all.retain(|&edge| drawn[edge as usize] != 2);
        all
    };
    let mut open: HashMap<[Bits; 2], Option<[u32; 2]>> = HashMap::new();
    for &[a, b, c] in &all.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let at = |i: u32| all.points[i as usize].surface.position.to_array();
            let mut key = [from, to].map(|i| at(i).map(f32::to_bits));
            key.sort_unstable();
            let once = open.entry(key).or_default();
            *once = once.is_none().then_some([from, to]);
        }
    }
    for [from, to] in open.into_values().flatten() {
        let [from, to] = [from, to].map(|i| &all.points[i as usize]);
        if from.surface.position == to.surface.position {
            continue;
        }
        assert!(
            rims(from).intersection(&rims(to)).count() > 0,
            "{faces:?}: a crack between {from:?} and {to:?}"
        );
    }
    let passes = prepared.passes.iter().enumerate();
    let levels = passes.flat_map(|(number, pass)| {
        (0..pass.patches.len() as u32).map(move |patch| (number, patch))
    });
    let levels = levels.filter_map(|(pass, patch)| list.levels(&prepared, pass, patch));
    levels
        .filter(|levels| levels.cells != [1; 2] && levels.edges.iter().any(|&l| l < levels.inside))
        .count()
}

const ALL: [MacroFaces; 3] = [
    MacroFaces::Quartets,
    MacroFaces::Rectangles { span: 16 },
    MacroFaces::Rectangles { span: 3 },
];

#[test]
fn cells_have_the_bits_of_faces() {
    for name in ["hull", "creased-torus", "sheet", "ngons", "cube", "pole-7"] {
        let model = Model::new(builtin(name).expect("it is built in"));
        ALL.into_iter().for_each(|faces| check_drawn(&model, faces));
    }
    let mut lowered = 0;
    for mesh in [grid([12, 7], [true; 2]), grid([9, 6], [false; 2]), cube(4)] {
        let model = Model::new(mesh);
        for faces in ALL {
            check_drawn(&model, faces);
            lowered += check_tagged(&model, faces);
        }
    }
    assert!(
        lowered > 50,
        "{lowered} macro faces with sides of several levels"
    );
}

/// Single faces, rows, rings and tubes, which meet themselves.
#[test]
fn narrow_meshes_are_drawn_like_others() {
    let closings = [[false; 2], [true, false], [false, true], [true; 2]];
    for closed in closings {
        for [columns, rows] in [
            [1, 1],
            [2, 1],
            [3, 1],
            [1, 4],
            [2, 2],
            [3, 2],
            [3, 3],
            [5, 2],
        ] {
            let least = |closed: bool| if closed { 3 } else { 1 };
            if columns < least(closed[0]) || rows < least(closed[1]) {
                continue;
            }
            let model = Model::new(grid([columns, rows], closed));
            for faces in ALL {
                check_drawn(&model, faces);
                check_tagged(&model, faces);
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn cells_of_any_mesh_have_the_bits_of_faces(recipe in wild()) {
        let model = Model::new(recipe.mesh());
        for faces in ALL {
            check_drawn(&model, faces);
            check_tagged(&model, faces);
        }
    }
}

#[test]
fn what_does_not_go_with_macro_faces_is_refused() {
    let model = Model::new(builtin("hull").expect("it is built in"));
    let prepare = |faces: MacroFaces| method().prepare(&model, faces).expect("it can be drawn");
    let refused = |faces: MacroFaces, options: SurfaceOptions| match options.check(&prepare(faces))
    {
        Err(Error::Misuse(misuse)) => Some(misuse),
        Err(other) => panic!("{other}"),
        Ok(()) => None,
    };
    let rectangles = MacroFaces::Rectangles { span: 10 };
    for faces in [MacroFaces::Quartets, rectangles] {
        let most = faces.greatest_level();
        assert_eq!(refused(faces, options(most)), None);
        let level = Misuse::MacroLevel {
            span: faces.span(),
            greatest: most,
        };
        assert_eq!(refused(faces, options(most + 1)), Some(level));
        let pattern = SurfaceOptions {
            backend: Backend::Pattern,
            residence: Residence::Cache,
            ..options(1)
        };
        let misuse = refused(faces, pattern);
        assert!(
            matches!(misuse, Some(Misuse::MacroFaces { .. })),
            "{misuse:?}"
        );
        let fractional = Cut {
            spacing: Spacing::FractionalEven,
            ..cut(1)
        };
        let list = DrawList::new(&prepare(faces), &options(1), None, fractional, None);
        let refused = list.expect_err("refused");
        assert!(
            matches!(refused, Error::Misuse(Misuse::MacroFaces { .. })),
            "{refused}"
        );
    }
}

#[test]
fn edits_prepare_macro_faces_anew() {
    let database = Database::default();
    for faces in ALL {
        let mut model = Model::new(builtin("hull").expect("it is built in"));
        let editable = method().prepare_editable(&model, faces, &database);
        let mut editable = editable.expect("it can be drawn");
        for hole in [40, 200] {
            let [a, b] = model.topology().edges()[hole as usize].vertices;
            let mut edit = model.mesh().edit();
            edit.hole(hole, true).crease(a, b, 2.0);
            let changes = model.apply(&edit).expect("there is such a face");
            let update = editable.update(&model, &changes, &database);
            assert!(update.expect("it goes").is_whole);
            let fresh = method().prepare(&model, faces).expect("it can be drawn");
            let [own, fresh] = [editable.prepared(), &fresh].map(|prepared| {
                let list = DrawList::new(prepared, &options(2), None, cut(2), None);
                let controls = prepared.controls(model.positions());
                list.expect("all is sound").tessellate(prepared, &controls)
            });
            assert_eq!(own.expect("it belongs to it"), fresh.expect("and to it"));
        }
    }
}
