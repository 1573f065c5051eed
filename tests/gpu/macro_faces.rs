//! Several faces as one patch: the device has the bits of single faces, and no cracks.

use std::collections::{BTreeSet, HashMap};

use hullform::frame::DrawList;
use hullform::gpu::{Fill, Residence, SurfaceOptions};
use hullform::mesh::Model;
use hullform::method::{METHODS, MacroFaces, Prepared, to_ptex};
use hullform::tessellation::Spacing;

use crate::common;
use crate::common::gpu::{Frame, Gpu, capturing, cut};
use crate::precision::from_twin;
use crate::shapes;

type Bits = [u32; 3];

/// What the device makes of a model at a level.
fn captured(gpu: &Gpu, model: &Model, faces: MacroFaces, level: f32) -> (Prepared, Frame, u32) {
    let mut methods = METHODS.iter();
    let method = methods
        .find(|method| method.aggregates)
        .expect("there is one");
    let prepared = method.prepare(model, faces).expect("a sound mesh");
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
    let open = open_edges(&prepared, &frame, &list);
    (prepared, frame, open)
}

/// How many edges of triangles have no other beside them, by the bits of their ends.
fn open_edges(prepared: &Prepared, frame: &Frame, list: &DrawList) -> u32 {
    let mut edges: HashMap<[Bits; 2], i32> = HashMap::new();
    for (pass, all) in frame.passes.iter().enumerate() {
        for patch in all.chunk_by(|a, b| a.patch_number == b.patch_number) {
            let uv: Vec<[f32; 2]> = patch.iter().map(|vertex| vertex.uv).collect();
            let triangles = list.triangles(prepared, pass, patch[0].patch_number, &uv);
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
    let kinds = [
        MacroFaces::Quartets,
        MacroFaces::Rectangles { span: 16 },
        MacroFaces::Rectangles { span: 5 },
    ];
    for model in named.into_iter().chain([shapes::torus()]).chain(shared) {
        let mut open = 0;
        for level in [1.0, 2.0, 3.0, 4.0, 7.0] {
            let (prepared, frame, own_open) = captured(&gpu, &model, MacroFaces::None, level);
            let apart = places(&prepared, &frame);
            if level == 1.0 {
                open = own_open;
            }
            for faces in kinds {
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

/// Of quartets alone: they need no ring, and what has one may be cached.
#[test]
fn quartets_go_with_a_cache() {
    let Some(gpu) = Gpu::open() else { return };
    let model = shapes::built_in("hull");
    let (prepared, ring, _) = captured(&gpu, &model, MacroFaces::Quartets, 4.0);
    let at = cut(4.0, Spacing::Equal);
    let options = SurfaceOptions {
        residence: Residence::Cache,
        ..capturing(&prepared, &[at])
    };
    let loaded = gpu.load(&model, prepared, &[], options);
    let mut loaded = loaded.expect("it can be drawn so");
    let cached = loaded.capture(at, Fill::Discard).expect("it is drawn");
    assert_eq!(cached.bits(), ring.bits());
    gpu.finish();
}
