//! Several faces as one patch: the device has the bits of single faces, and no cracks.

use std::collections::{BTreeSet, HashMap};

use hullform::frame::DrawList;
use hullform::gpu::{Decides, Fill, Metric, Residence, SurfaceOptions};
use hullform::mesh::Model;
use hullform::method::{METHODS, MacroFaces, Prepared, to_ptex};
use hullform::tessellation::{Levels, Spacing};

use crate::common;
use crate::common::gpu::{Frame, Gpu, capturing, cut};
use crate::decide::{RESIDENCES, are_alike, radius, seen, views};
use crate::precision::from_twin;
use crate::shapes;

type Bits = [u32; 3];

fn prepared(model: &Model, faces: MacroFaces) -> Prepared {
    let mut methods = METHODS.iter();
    let method = methods
        .find(|method| method.aggregates)
        .expect("there is one");
    method.prepare(model, faces).expect("a sound mesh")
}

/// What the device makes of a model at a level.
fn captured(gpu: &Gpu, model: &Model, faces: MacroFaces, level: f32) -> (Prepared, Frame, u32) {
    let prepared = prepared(model, faces);
    let cut = cut(level, Spacing::Equal);
    let options = SurfaceOptions {
        ring_bytes: 64 << 20,
        ..capturing(&prepared, &[cut])
    };
    let workarounds = &gpu.device.info().workarounds;
    let loaded = gpu.load(model, prepared, workarounds, options);
    let mut loaded = loaded.expect("it can be drawn so");
    let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    assert_eq!(frame.counters.overflows, 0);
    let prepared = loaded.prepared().clone();
    let list = DrawList::new(&prepared, &options, None, cut, None).expect("as before");
    let levels = |pass, patch| list.levels(&prepared, pass, patch);
    let open = open_edges(&frame, &list, levels);
    (prepared, frame, open)
}

/// How many edges of triangles have no other beside them, by the bits of their ends.
fn open_edges(
    frame: &Frame,
    list: &DrawList,
    levels: impl Fn(usize, u32) -> Option<Levels>,
) -> u32 {
    let mut edges: HashMap<[Bits; 2], i32> = HashMap::new();
    for (pass, all) in frame.passes.iter().enumerate() {
        for patch in all.chunk_by(|a, b| a.patch_number == b.patch_number) {
            let uv: Vec<[f32; 2]> = patch.iter().map(|vertex| vertex.uv).collect();
            let levels = levels(pass, patch[0].patch_number).expect("it is drawn");
            let triangles = list.join(&levels, &uv);
            for triangle in triangles.expect("all vertices came") {
                let [a, b, c] = triangle.map(|i| patch[i as usize].position.map(f32::to_bits));
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    match from < to {
                        true => *edges.entry([from, to]).or_default() += 1,
                        false => *edges.entry([to, from]).or_default() -= 1,
                    }
                }
            }
        }
    }
    edges.values().map(|times| times.unsigned_abs()).sum()
}

/// The bits of position and normal at each place of a ptex face.
fn places(prepared: &Prepared, frame: &Frame) -> HashMap<(u32, [u32; 2]), [Bits; 2]> {
    let passes = prepared.passes.iter().zip(&frame.passes);
    let all = passes.flat_map(|(pass, all)| all.iter().map(move |vertex| (pass, vertex)));
    let all = all.map(|(pass, vertex)| {
        let (slot, uv) = pass.face_at(vertex.patch_number as usize, vertex.uv);
        let face = &pass.patches[slot];
        let bits = [vertex.position, vertex.normal].map(|vector| vector.map(f32::to_bits));
        ((face.ptex, to_ptex(face, uv).map(f32::to_bits)), bits)
    });
    all.collect()
}

#[test]
fn cells_have_the_bits_of_faces_and_no_cracks() {
    let Some(gpu) = Gpu::open() else { return };
    let named = ["hull", "creased-torus", "sheet", "ngons"].map(shapes::built_in);
    let shared = common::model("bigguy").map(Model::new);
    for model in named.into_iter().chain([shapes::torus()]).chain(shared) {
        let mut open = 0;
        for level in [1.0, 2.0, 3.0, 4.0, 5.0] {
            let (prepared, frame, own_open) = captured(&gpu, &model, MacroFaces::None, level);
            let apart = places(&prepared, &frame);
            if level == 1.0 {
                open = own_open;
            }
            for faces in KINDS {
                if level > faces.greatest_level() as f32 {
                    continue;
                }
                let (prepared, frame, own_open) = captured(&gpu, &model, faces, level);
                // Those of the boundary alone.
                assert_eq!(own_open, level as u32 * open, "{faces:?} {level}");
                let worst = from_twin(&model, &prepared, &frame, 1);
                assert!(
                    worst.position <= 1e-6 && worst.normal <= 0.1,
                    "{faces:?} {level}: {worst:?}"
                );
                if level.log2().fract() == 0.0 {
                    hold_places(&places(&prepared, &frame), &apart, level);
                }
            }
        }
    }
    gpu.finish();
}

/// Each vertex of a macro face is one of its faces', and no position is missing.
fn hold_places(
    together: &HashMap<(u32, [u32; 2]), [Bits; 2]>,
    apart: &HashMap<(u32, [u32; 2]), [Bits; 2]>,
    level: f32,
) {
    for (place, bits) in together {
        match apart.get(place) {
            Some(own) => assert_eq!(bits, own, "{level} {place:?}"),
            // With one row of cells the tessellator still makes two of segments.
            None => assert_eq!(level, 1.0, "{place:?} is no face's"),
        }
    }
    let positions: BTreeSet<Bits> = together.values().map(|bits| bits[0]).collect();
    // Beside an n-gon a single face at level 1 has a vertex in its middle.
    let is_middle = |place: &[u32; 2]| level == 1.0 && *place == [0.5f32.to_bits(); 2];
    let mut apart = apart.iter().filter(|(place, _)| !is_middle(&place.1));
    assert!(apart.all(|(_, bits)| positions.contains(&bits[0])));
}

const KINDS: [MacroFaces; 3] = [
    MacroFaces::Quartets,
    MacroFaces::Rectangles { span: 16 },
    MacroFaces::Rectangles { span: 5 },
];

#[test]
fn ring_and_cache_give_the_same_bits() {
    let Some(gpu) = Gpu::open() else { return };
    for (name, faces) in ["hull", "ngons"]
        .into_iter()
        .flat_map(|n| KINDS.map(|f| (n, f)))
    {
        let model = shapes::built_in(name);
        for level in [1.0, 2.0, 3.0, 4.0] {
            let (prepared, ring, _) = captured(&gpu, &model, faces, level);
            let at = cut(level, Spacing::Equal);
            let options = SurfaceOptions {
                residence: Residence::Cache,
                ..capturing(&prepared, &[at])
            };
            let loaded = gpu.load(&model, prepared, &[], options);
            let mut loaded = loaded.expect("it can be drawn so");
            let cached = loaded.capture(at, Fill::Discard).expect("it is drawn");
            assert_eq!(cached.bits(), ring.bits(), "{name} {faces:?} {level}");
        }
    }
    gpu.finish();
}

/// What lies along a side of a macro face has its level, whoever decides: no cracks in closed meshes, and the levels of the twin.
#[test]
fn levels_of_macro_faces_are_those_of_what_lies_beyond() {
    let Some(gpu) = Gpu::open() else { return };
    let shapes = [
        shapes::built_in("creased-torus"),
        shapes::built_in("ngons"),
        shapes::torus(),
    ];
    let cases = shapes
        .iter()
        .flat_map(|model| KINDS.map(|faces| (model, faces)));
    let mut lowered = 0;
    for (number, (model, faces)) in cases.enumerate() {
        let at = cut(faces.greatest_level().min(13) as f32 - 0.5, Spacing::Equal);
        let prepared = prepared(model, faces);
        let options = SurfaceOptions {
            decides: Decides::Device,
            residence: RESIDENCES[number % 2],
            ring_bytes: 64 << 20,
            ..capturing(&prepared, &[at])
        };
        let loaded = gpu.load(model, prepared, &[], options);
        let mut loaded = loaded.expect("it can be drawn so");
        let radius = radius(model);
        loaded.decision.metric = Metric::Distance(0.5 * radius);
        loaded.view = views(3, radius).last().expect("there are three");
        let frame = loaded.capture(at, Fill::Discard).expect("it is drawn");
        assert_eq!(frame.counters.overflows, 0);
        let (prepared, seen) = (loaded.prepared(), seen(&loaded.view));
        let vertices = model.positions();
        let mut levels: HashMap<(usize, u32), Levels> = HashMap::new();
        for (number, pass) in prepared.passes.iter().enumerate() {
            let decided = loaded.surface().decided(number, 0);
            for (patch, record) in decided.iter().enumerate() {
                let (outline, decision) = (&prepared.outline, loaded.decision);
                let twin = decision.levels(outline, pass, patch, &vertices, at, &seen);
                let twin = twin.expect("there is such a patch");
                assert!(
                    are_alike((record.edges, record.inside), &twin, true),
                    "{faces:?} {patch}: {record:?}, twin {twin:?}"
                );
                lowered += usize::from(twin.cells != [1; 2] && twin.edges[0] != twin.edges[1]);
                let own = Levels {
                    edges: record.edges,
                    inside: record.inside,
                    ..twin
                };
                levels.insert((number, patch as u32), own);
            }
        }
        let list = loaded.draw_list(at).expect("it is a cut");
        let open = open_edges(&frame, &list, |pass, patch| {
            levels.get(&(pass, patch)).copied()
        });
        assert_eq!(open, 0, "{faces:?} {number}");
    }
    assert!(
        lowered > 10,
        "{lowered} macro faces with sides of several levels"
    );
    gpu.finish();
}
