//! Levels above 64: patches are cut into pieces, and the surface stays whole and on its limit, on the CPU and on the device.
#![cfg(feature = "host")]

mod common;

use std::collections::{BTreeMap, HashMap};

use hullform::abi::Captured;
use hullform::frame::{
    Cut, Decides, DrawList, Residence, Slots, SurfaceOptions, Tessellated, TessellatedPoint,
};
use hullform::gpu::Fill;
use hullform::host::{Shot, Style};
use hullform::mesh::{Model, Scheme, Triangulation, builtin, triangulated};
use hullform::method::{DepthTags, METHODS, MethodOptions, Prepared, method_for, to_ptex};
use hullform::plan::PlanOptions;
use hullform::subdivision::LimitSurface;
use hullform::tessellation::Spacing;
use hullform::{Error, Misuse};

use common::gpu::{Gpu, Loaded};

fn model(name: &str) -> Model {
    Model::new(builtin(name).expect("it is built in"))
}

/// Of the first method, with plans for every level.
fn prepare(model: &Model) -> Prepared {
    let options = MethodOptions::from(PlanOptions {
        max_level: 10,
        ..PlanOptions::default()
    });
    let prepared = METHODS[0].prepare(model, options);
    prepared.expect("the model is sound")
}

fn cut(level: f32) -> Cut {
    Cut {
        level,
        spacing: Spacing::Equal,
    }
}

fn options(greatest_level: f32) -> SurfaceOptions {
    SurfaceOptions {
        greatest_level,
        ..SurfaceOptions::default()
    }
}

/// Edges of triangles, from one point to another, that no other triangle has the other way round. Points with the same bits are one.
fn edges_without_partner(surface: &Tessellated) -> usize {
    let mut numbers = HashMap::new();
    let points = surface.points.iter().map(|point| {
        let next = numbers.len() as u64;
        let bits = point.surface.position.to_array().map(f32::to_bits);
        *numbers.entry(bits).or_insert(next)
    });
    let points: Vec<u64> = points.collect();
    let mut edges: HashMap<u64, i32> = HashMap::new();
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|point| points[point as usize]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let way = if from < to { 1 } else { -1 };
            *edges.entry(from.min(to) << 32 | from.max(to)).or_insert(0) += way;
        }
    }
    edges.values().filter(|&&balance| balance != 0).count()
}

/// The farthest that every `step`th point is from the limit, over the diagonal.
fn from_limit(model: &Model, prepared: &Prepared, surface: &Tessellated, step: usize) -> f64 {
    let limit = LimitSurface::new(model.mesh());
    let distances = surface.points.iter().step_by(step).map(|point| {
        let record = &prepared.passes[point.pass as usize].patches[point.patch as usize];
        let [u, v] = to_ptex(record, point.uv).map(f64::from);
        let limit = limit.evaluate(record.ptex as usize, u, v);
        let limit = model
            .placement()
            .local(limit.expect("the surface has a limit").position);
        limit.distance(point.surface.position.as_dvec3()) / model.diagonal()
    });
    distances.fold(0.0, f64::max)
}

/// Level 1 everywhere but within a ptex face, which has 1024.
fn one_face(prepared: &Prepared, face: u32) -> DepthTags {
    let tags = DepthTags::new(vec![0.0; prepared.vertex_count()]);
    tags.with_insides((0..=face).map(|own| if own == face { 10.0 } else { 0.0 }))
}

/// The segments of edges that one face has alone.
fn boundary_segments(model: &Model, list: &DrawList, prepared: &Prepared) -> usize {
    let topology = model.topology();
    let is_open = |&side: &u32| {
        let faces = || {
            topology
                .edge_faces(side)
                .iter()
                .filter(|&&face| !topology.is_hole(face))
        };
        (side as usize) < topology.edge_count() && faces().count() == 1
    };
    let mut segments = 0;
    for (number, pass) in prepared.passes.iter().enumerate() {
        for (patch, sides) in (0..).zip(&pass.sides) {
            let levels = list.levels(prepared, number, patch).expect("it is drawn");
            let open = (0..4).filter(|&edge| is_open(&sides[edge]));
            segments += open.map(|edge| levels.edges[edge] as usize).sum::<usize>();
        }
    }
    segments
}

#[test]
fn a_face_at_level_1024_opens_nothing_beside_ones_at_1_and_lies_on_the_limit() {
    // A part of an n-gon, which has half of the level, and a whole quad.
    for (name, least) in [("ngons", 2 * 511 * 511), ("creased-torus", 2 * 1023 * 1023)] {
        let model = model(name);
        let prepared = prepare(&model);
        let controls = prepared.controls(model.positions());
        let tags = one_face(&prepared, prepared.passes[0].patches[0].ptex);
        let list = DrawList::new(&prepared, &options(1024.0), None, cut(1024.0), Some(&tags));
        let list = list.expect("it fits");
        let surface = list.tessellate(&prepared, &controls).expect("it is drawn");
        assert!(
            surface.triangles.len() > least,
            "{}",
            surface.triangles.len()
        );
        let open = boundary_segments(&model, &list, &prepared);
        assert_eq!(edges_without_partner(&surface), open, "{name}");
        let away = from_limit(&model, &prepared, &surface, 199);
        assert!(away <= 1e-6, "{name}: {away}");
    }
}

/// Depths of all kinds beside one another, a few of them for levels above 64.
fn all_kinds(prepared: &Prepared) -> DepthTags {
    let every = (prepared.vertex_count() / 6).max(1);
    let depths = (0..prepared.vertex_count()).map(|vertex| match vertex % every {
        0 => 5.0 + (vertex / every % 5) as f32 * 0.55,
        other => (other % 4) as f32 * 0.9,
    });
    DepthTags::new(depths).with_insides([0.0, 7.3, 0.0, 6.9])
}

/// Levels of all kinds beside one another, with creases, n-gons and extraordinary vertices: nothing opens, and lists keep within their bounds.
#[test]
fn pieces_beside_whole_patches_open_nothing_and_fit_into_the_ring() {
    for name in ["ngons", "hull", "creased-torus", "cube"] {
        let model = model(name);
        let prepared = prepare(&model);
        let controls = prepared.controls(model.positions());
        let unpaired = |list: &DrawList| {
            let surface = list.tessellate(&prepared, &controls);
            edges_without_partner(&surface.expect("it is drawn"))
        };
        let tags = all_kinds(&prepared);
        for slots in [Slots::Counter, Slots::Host] {
            let options = SurfaceOptions {
                slots,
                ring_bytes: 1 << 17,
                ..options(200.0)
            };
            let list = DrawList::new(&prepared, &options, Some(65_535), cut(170.5), Some(&tags));
            let list = list.expect("it fits");
            hold(&list, &prepared);
            if slots == Slots::Counter {
                let open = boundary_segments(&model, &list, &prepared);
                assert_eq!(unpaired(&list), open, "{name}");
            }
        }
    }
}

/// Each sub-patch is drawn once, with a slot of its own, within the ring; their batches have counters.
fn hold(list: &DrawList, prepared: &Prepared) {
    assert!(list.has_sub_patches() && list.has_decisions());
    let mut next = vec![0; prepared.passes.len()];
    let mut cut_up = 0;
    for batch in list.batches() {
        let (pass, drawn) = (batch.pass(), batch.drawn());
        assert_eq!(drawn.start, next[pass]);
        next[pass] = drawn.end;
        let own = &list.sub_patches(pass)[drawn.start as usize..drawn.end as usize];
        let slots = own.windows(2).all(|pair| pair[0].slot <= pair[1].slot);
        assert!(slots && own[0].slot == 0 && batch.points() <= list.options().ring_points());
        cut_up += own.iter().filter(|own| own.piece != 0).count();
        let evaluations = batch
            .patches()
            .map(|patch| batch.evaluations(prepared, patch));
        assert_eq!(evaluations.sum::<u32>(), batch.vertices());
    }
    assert!(cut_up > 0);
    let all = (0..next.len()).all(|pass| next[pass] as usize == list.sub_patches(pass).len());
    assert!(all && list.records(0).is_empty());
    let counters = DrawList::ring_counters(prepared, list.options(), Some(65_535));
    let ring_batches = list.batches().map(|batch| batch.ring_batch()).max();
    assert!(u64::from(ring_batches.unwrap_or(0)) < counters.expect("it fits"));
}

/// All pieces of what is chosen, as they are in the whole list, and of the rest nothing but places.
#[test]
fn of_what_is_chosen_all_pieces_are_drawn_and_of_the_others_none() {
    let model = model("ngons");
    let prepared = prepare(&model);
    let controls = prepared.controls(model.positions());
    let tags = all_kinds(&prepared);
    let options = options(200.0);
    let whole = DrawList::new(&prepared, &options, None, cut(170.5), Some(&tags));
    let whole = whole.expect("it fits");
    let is_cut = |pass: usize, patch: u32| {
        let levels = whole.levels(&prepared, pass, patch);
        levels.is_some_and(|levels| levels.greatest() > 64.0)
    };
    let chosen = |pass: usize, patch: u32| patch % 3 == u32::from(is_cut(pass, patch));
    let few = whole.clone().only(&prepared, chosen).expect("its own");
    let [points, right] = [&few, &whole].map(|list| {
        let surface = list.tessellate(&prepared, &controls);
        surface.expect("it is drawn").points
    });
    assert!(points.len() < right.len());
    let right = right.iter().filter(|p| chosen(p.pass as usize, p.patch));
    assert!(right.eq(&points));
    let (mut cut_up, mut left_out) = (0, 0);
    for pass in 0..prepared.passes.len() {
        let [own, all] = [&few, &whole].map(|list| list.sub_patches(pass));
        assert_eq!(own.len(), all.len());
        for (own, all) in own.iter().zip(all) {
            assert_eq!((own.patch_number, own.piece), (all.patch_number, all.piece));
            let is_chosen = chosen(pass, own.patch_number);
            let levels = if is_chosen {
                (all.edges, all.inside)
            } else {
                ([0.0; 4], 0.0)
            };
            assert_eq!((own.edges, own.inside), levels);
            cut_up += usize::from(is_chosen && own.piece != 0);
            left_out += usize::from(!is_chosen && own.piece != 0);
        }
    }
    assert!(cut_up > 0 && left_out > 0, "{cut_up} {left_out}");
    // What is not chosen takes no room in the ring.
    let points = |list: &DrawList| -> u64 {
        let slots = (0..prepared.passes.len()).flat_map(|pass| list.sub_patches(pass));
        slots.map(|own| u64::from(own.slot)).sum()
    };
    assert!(points(&few) < points(&whole));
}

/// Where what is captured holds no whole patch, each batch has the triangles of its own pieces: together those of the patch, each once.
#[test]
fn a_patch_in_several_captured_batches_has_each_triangle_once() {
    let model = model("ngons");
    let prepared = prepare(&model);
    let controls = prepared.controls(model.positions());
    let tags = all_kinds(&prepared);
    let options = SurfaceOptions {
        capture_vertices: 1 << 13,
        ..options(200.0)
    };
    let list = DrawList::new(&prepared, &options, None, cut(170.5), Some(&tags));
    let list = list.expect("it fits");
    let surface = list.tessellate(&prepared, &controls);
    let surface = surface.expect("it is drawn");
    let mut split = 0;
    for pass in 0..prepared.passes.len() {
        for patch in 0..prepared.passes[pass].patches.len() as u32 {
            let own = surface.points.iter();
            let own = own.filter(|p| (p.pass as usize, p.patch) == (pass, patch));
            let uv: Vec<[f32; 2]> = own.map(|point| point.uv).collect();
            let batches = list.batches().filter(|batch| batch.pass() == pass);
            let batches: Vec<_> = batches.filter(|b| b.patches().contains(&patch)).collect();
            let part = |batch: &hullform::frame::Batch<'_>| {
                assert!(batch.vertices() <= options.capture_vertices);
                let triangles = batch
                    .triangles(&prepared, patch, &uv)
                    .expect("all are there");
                let mut corners: Vec<u32> = triangles.concat();
                corners.sort_unstable();
                corners.dedup();
                let different = batch.different_vertices(&prepared, patch);
                assert_eq!(corners.len(), different as usize);
                triangles
            };
            let mut parts: Vec<[u32; 3]> = batches.iter().flat_map(part).collect();
            let whole = list.triangles(&prepared, pass, patch, &uv);
            let mut whole = whole.expect("all are there");
            parts.sort_unstable();
            whole.sort_unstable();
            assert_eq!(parts, whole, "{pass} {patch}");
            split += usize::from(batches.len() > 1);
        }
    }
    assert!(split > 2, "{split}");
}

#[test]
fn what_cannot_be_cut_into_pieces_is_refused() {
    let cube = model("cube");
    let prepared = prepare(&cube);
    let refused = |options: &SurfaceOptions, cut: Cut| match DrawList::new(
        &prepared, options, None, cut, None,
    ) {
        Err(Error::Misuse(misuse)) => Some(misuse),
        _ => None,
    };
    assert_eq!(refused(&options(1024.0), cut(1024.0)), None);
    for level in [64.01, 1024.0] {
        let even = Cut {
            spacing: Spacing::FractionalEven,
            ..cut(level)
        };
        assert_eq!(
            refused(&options(1024.0), even),
            Some(Misuse::SubPatchSpacing)
        );
    }
    let device = SurfaceOptions {
        decides: Decides::Device,
        ..options(65.0)
    };
    let what = "levels above 64";
    assert_eq!(
        refused(&device, cut(1.0)),
        Some(Misuse::DecidedByDevice { what })
    );
    assert!(matches!(
        refused(&options(1024.5), cut(1.0)),
        Some(Misuse::Level { .. })
    ));
    for backend in &hullform::frame::Backend::ALL[1..] {
        let lattice = SurfaceOptions {
            backend: *backend,
            residence: Residence::Cache,
            ..options(65.0)
        };
        assert!(matches!(
            refused(&lattice, cut(1.0)),
            Some(Misuse::BackendLevel { .. })
        ));
    }
    let triangles = triangulated(cube.mesh(), Triangulation::default()).and_then(|mesh| {
        let model = Model::new(mesh.with_scheme(Scheme::Loop)?);
        method_for(&model).prepare(&model, MethodOptions::default())
    });
    let triangles = triangles.expect("a method draws triangles");
    let list = DrawList::new(&triangles, &options(65.0), None, cut(1.0), None);
    assert!(matches!(
        list,
        Err(Error::Misuse(Misuse::SubPatchesOfTriangles))
    ));
    let list =
        |tags: DepthTags| DrawList::new(&prepared, &options(8.0), None, cut(8.0), Some(&tags));
    let deep = DepthTags {
        insides: vec![0.0, 10.5],
        ..DepthTags::new([0.0; 8])
    };
    let (ptex, depth) = (1, 10.5);
    assert!(
        matches!(list(deep), Err(Error::Misuse(misuse)) if misuse == Misuse::InsideDepth { ptex, depth })
    );
}

/// What the device has captured, as the CPU would have it; each vertex once.
fn captured(loaded: &mut Loaded<'_>, cut: Cut) -> Tessellated {
    let list = loaded.draw_list(cut).expect("it fits");
    let frame = loaded.capture(cut, Fill::Discard).expect("it is drawn");
    assert_eq!(frame.counters.overflows, 0);
    let mut surface = Tessellated::default();
    for (pass, vertices) in (0..).zip(&frame.passes) {
        let mut patches: BTreeMap<u32, HashMap<[u32; 2], &Captured>> = BTreeMap::new();
        for vertex in vertices {
            let known = patches.entry(vertex.patch_number).or_default();
            let before = known.insert(vertex.uv.map(f32::to_bits), vertex);
            let same = before.is_none_or(|before| before.position == vertex.position);
            assert!(same, "two pieces, two positions: {vertex:?}");
        }
        for (patch, vertices) in patches {
            let vertices: Vec<&Captured> = vertices.into_values().collect();
            let uv: Vec<[f32; 2]> = vertices.iter().map(|vertex| vertex.uv).collect();
            let triangles = list.triangles(loaded.prepared(), pass, patch, &uv);
            let first = surface.points.len() as u32;
            let triangles = triangles.expect("every vertex came").into_iter();
            let numbered = triangles.map(|triangle| triangle.map(|i| first + i));
            surface.triangles.extend(numbered);
            surface
                .points
                .extend(vertices.iter().map(|vertex| TessellatedPoint {
                    pass: pass as u32,
                    patch,
                    uv: vertex.uv,
                    surface: hullform::method::SurfacePoint {
                        position: vertex.position.into(),
                        normal: vertex.normal.into(),
                    },
                }));
        }
    }
    surface
}

#[test]
fn devices_draw_pieces_as_the_cpu_has_them() {
    let Some(gpu) = Gpu::open() else { return };
    let workarounds = gpu.device.info().workarounds.clone();
    let (ring, cache) = (Residence::Ring, Residence::Cache);
    for (name, level, residence, slots) in [
        ("ngons", 170.0, ring, Slots::Counter),
        ("ngons", 128.0, cache, Slots::Counter),
        ("creased-torus", 100.0, ring, Slots::Host),
    ] {
        let model = model(name);
        let prepared = prepare(&model);
        let controls = prepared.controls(model.positions());
        let options = SurfaceOptions {
            residence,
            slots,
            ring_bytes: 1 << 18,
            capture_vertices: 1 << 18,
            ..options(level)
        };
        let loaded = gpu.load(&model, prepared.clone(), &workarounds, options);
        let mut loaded = loaded.expect("it fits");
        loaded.tags = Some(all_kinds(&prepared));
        let surface = captured(&mut loaded, cut(level));
        let what = format!("{name} {residence:?} {slots:?}");
        let list = loaded.draw_list(cut(level)).expect("it fits");
        let open = boundary_segments(&model, &list, &prepared);
        assert_eq!(edges_without_partner(&surface), open, "{what}");
        // Records of pieces are no decisions of the device.
        assert!(list.has_sub_patches() && loaded.surface().decided(0, 0).is_empty());
        let twin = list.tessellate(&prepared, &controls).expect("it is drawn");
        assert_eq!(surface.points.len(), twin.points.len(), "{what}");
        assert_eq!(surface.triangles.len(), twin.triangles.len(), "{what}");
        let away = from_twin(&prepared, &controls, &surface) / model.diagonal();
        assert!(away <= 1e-6, "{what}: {away}");
    }
    gpu.finish();
}

/// The farthest that points are from where the twin has them.
fn from_twin(
    prepared: &Prepared,
    controls: &hullform::method::Controls,
    surface: &Tessellated,
) -> f64 {
    let distances = surface.points.iter().map(|point| {
        let pass = &prepared.passes[point.pass as usize];
        let twin = pass.evaluate(controls, point.patch as usize, point.uv.into());
        f64::from(twin.position.distance(point.surface.position))
    });
    distances.fold(0.0, f64::max)
}

/// And pipelines that know nothing of pieces refuse them.
#[test]
fn a_device_draws_one_face_at_level_1024_among_ones_at_1() {
    let Some(gpu) = Gpu::open() else { return };
    let model = model("ngons");
    let prepared = prepare(&model);
    let options = SurfaceOptions {
        residence: Residence::Cache,
        capture_vertices: 1 << 21,
        ..options(1024.0)
    };
    let workarounds = gpu.device.info().workarounds.clone();
    let loaded = gpu.load(&model, prepared.clone(), &workarounds, options);
    let mut loaded = loaded.expect("it fits");
    loaded.tags = Some(one_face(&prepared, prepared.passes[0].patches[0].ptex));
    let surface = captured(&mut loaded, cut(1024.0));
    assert!(surface.points.len() > 511 * 511);
    let list = loaded.draw_list(cut(1024.0)).expect("it fits");
    let open = boundary_segments(&model, &list, &prepared);
    assert_eq!(edges_without_partner(&surface), open);
    let away = from_limit(&model, &prepared, &surface, 199);
    assert!(away <= 1e-6, "{away}");
    let style = Style {
        sub_patches: false,
        ..Style::new(options, Spacing::Equal, Fill::Discard)
    };
    let pipelines = gpu.pipelines(&prepared, style).expect("they are built");
    let refused = hullform::host::Loaded::draw(
        &loaded,
        &[Shot {
            pipelines: &pipelines,
            view: loaded.view,
            instances: 1,
            batches: list.batches().collect(),
        }],
    );
    let misuse = Misuse::SubPatchPipelines;
    assert!(matches!(refused, Err(Error::Misuse(own)) if own == misuse));
    drop((pipelines, loaded));
    gpu.finish();
}
