//! Draw lists, without a device: whatever the mesh, cut and options, a list draws each patch once and stays within its bounds.

use std::ops::Range;

use hullform::abi;
use hullform::frame::{
    Backend, Cut, Decides, Draw, DrawList, Residence, Slots, SurfaceOptions, TessellatedPoint,
};
use hullform::mesh::{Model, builtin};
use hullform::method::{DepthTags, METHODS, MethodOptions, Prepared, SurfacePoint};
use hullform::plan::Database;
use hullform::tessellation::{Levels, Spacing, required_level};

/// The limit of drivers that lose patches beyond 16 bits, tighter ones to single patches, and none.
const INSTANCES: [Option<u32>; 4] = [None, Some(65_535), Some(2_000), Some(1)];

const SPACINGS: [Spacing; 2] = [Spacing::Equal, Spacing::FractionalEven];

/// A model as every method makes it ready that can draw it.
fn prepared(name: &str) -> Vec<Prepared> {
    let model = Model::new(builtin(name).expect("it is built in"));
    let mut methods = METHODS.iter().collect::<Vec<_>>();
    methods.retain(|method| method.check_model(&model).is_ok());
    let prepare = |method: &&hullform::method::Method| {
        let prepared = method.prepare(&model, MethodOptions::default());
        prepared.expect("the model is sound")
    };
    methods.iter().map(prepare).collect()
}

fn tags(prepared: &Prepared) -> DepthTags {
    DepthTags::new((0..prepared.vertex_count()).map(|vertex| (vertex % 4) as f32))
}

/// The patches that a list draws of a pass: all, or, where a frame decides how deep is refined, those from the first that has vertices to the last.
fn drawn(list: &DrawList, prepared: &Prepared, pass: usize) -> Range<u32> {
    let all = 0..prepared.passes[pass].patches.len() as u32;
    if !prepared.is_dynamic() {
        return all;
    }
    let has_vertices = |&patch: &u32| list.vertices(prepared, pass, patch) > 0;
    let first = all.clone().find(has_vertices);
    let last = all.rev().find(has_vertices);
    first
        .zip(last)
        .map_or(0..0, |(first, last)| first..last + 1)
}

/// Holds a list to its promises.
fn hold(list: &DrawList, prepared: &Prepared, most: Option<u32>, what: &str) {
    let drawn = (0..prepared.passes.len()).map(|pass| drawn(list, prepared, pass));
    let drawn: Vec<Range<u32>> = drawn.collect();
    let mut next: Vec<u32> = drawn.iter().map(|patches| patches.start).collect();
    let mut ring_batches = 0;
    for batch in list.batches() {
        let (pass, patches) = (batch.pass(), batch.patches());
        assert_eq!(patches.start, next[pass], "{what}: patches in a row");
        next[pass] = patches.end;
        assert!(batch.points() <= list.options().ring_points(), "{what}");
        let &[
            Draw::Patches {
                first,
                per_instance,
                instances,
            },
        ] = batch.draws()
        else {
            panic!("{what}: {:?} is not one draw", batch.draws());
        };
        assert_eq!(first..first + per_instance * instances, patches, "{what}");
        let vertices = patches.map(|patch| list.vertices(prepared, pass, patch));
        let finest = vertices.max().unwrap_or(0);
        let bounded = most.is_none_or(|most| per_instance == 1 || per_instance * finest <= most);
        assert!(bounded, "{what}: {per_instance} of {finest} vertices");
        if !prepared.passes[pass].scratch_points.is_empty() {
            assert_eq!(batch.ring_batch(), ring_batches, "{what}");
            ring_batches += 1;
        }
    }
    let ends: Vec<u32> = drawn.iter().map(|patches| patches.end).collect();
    assert_eq!(next, ends, "{what}: all patches");
    let counters = DrawList::ring_counters(prepared, list.options(), most);
    let counters = counters.expect("a list was made with these options");
    let used = u64::from(ring_batches) * u64::from(list.options().rounds);
    assert!(used <= counters, "{what}: {used} counters of {counters}");
}

#[test]
fn a_list_draws_each_patch_once_within_its_bounds() {
    let mut lists = 0;
    for name in ["cube", "ngons", "hull", "pole-64", "sheet"] {
        for prepared in prepared(name) {
            for (ring_bytes, capture_vertices) in [(1 << 20, 0), (1 << 15, 0), (1 << 15, 500)] {
                let options = SurfaceOptions {
                    ring_bytes,
                    capture_vertices,
                    rounds: 2,
                    greatest_level: 16.0,
                    ..SurfaceOptions::default()
                };
                for most in INSTANCES {
                    // A pole of 64 faces may be too much for a small ring.
                    if DrawList::ring_counters(&prepared, &options, most).is_err() {
                        continue;
                    }
                    for level in [1.0, 2.5, 5.0, 8.0, 15.0, 16.0] {
                        for spacing in SPACINGS {
                            let cut = Cut { level, spacing };
                            let list = DrawList::new(&prepared, &options, most, cut, None);
                            let list = list.expect("what holds the greatest level holds all");
                            let what = format!("{name} {cut:?} {ring_bytes} {most:?}");
                            hold(&list, &prepared, most, &what);
                            lists += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(lists > 1000, "{lists}");
}

/// Of what was edited some slots are vacant: nothing is drawn of these, whoever makes the triangles and whoever decides, and all else as of a fresh preparation.
#[test]
fn vacant_slots_are_drawn_nowhere() {
    let database = Database::default();
    let mut model = Model::new(builtin("hull").expect("it is built in"));
    let method = METHODS.iter().find(|method| method.edits_in_place());
    let method = method.expect("one edits in place");
    let editable = method.prepare_editable(&model, MethodOptions::default(), &database);
    let mut editable = editable.expect("the model is sound");
    let mut edit = model.mesh().edit();
    (0..40).for_each(|face| {
        edit.hole(7 * face, true);
    });
    let [a, b] = model.topology().edges()[500].vertices;
    edit.crease(a, b, 2.0);
    let changes = model.apply(&edit).expect("all of it is there");
    let update = editable.update(&model, &changes, &database);
    assert!(!update.expect("the model is sound").is_whole);
    let fresh = method.prepare_with(&model, MethodOptions::default(), &database);
    let (edited, fresh) = (editable.prepared(), fresh.expect("the model is sound"));
    let controls = fresh.controls(model.positions());
    let cut = Cut {
        level: 4.0,
        spacing: Spacing::Equal,
    };
    for backend in Backend::ALL {
        for (slots, tagged) in [
            (Slots::Counter, false),
            (Slots::Host, false),
            (Slots::Counter, true),
        ] {
            let options = SurfaceOptions {
                backend,
                slots,
                residence: Residence::Cache,
                greatest_level: 4.0,
                ..SurfaceOptions::default()
            };
            let drawn = |prepared: &Prepared| {
                let tags = tagged.then(|| tags(prepared));
                let list = DrawList::new(prepared, &options, None, cut, tags.as_ref());
                let list = list.expect("options and cut go together");
                let mut instances = 0;
                for batch in list.batches() {
                    instances += batch.draws().iter().fold(0, |sum, draw| match draw {
                        Draw::Pattern { instances, .. } => sum + instances,
                        Draw::Patches { .. } | Draw::Decided { .. } => sum,
                    });
                }
                let tessellated = list.tessellate(prepared, &controls).expect("its own");
                let bits = |point: &TessellatedPoint| {
                    let SurfacePoint { position, normal } = point.surface;
                    (
                        position.to_array().map(f32::to_bits),
                        normal.to_array().map(f32::to_bits),
                    )
                };
                let mut points: Vec<_> = tessellated.points.iter().map(bits).collect();
                points.sort_unstable();
                (points, tessellated.triangles.len(), instances)
            };
            let [own, right] = [edited, &fresh].map(drawn);
            assert!(own == right, "{backend:?} {slots:?} {tagged}");
        }
    }
}

/// Slots of the host follow one another in each batch, and leave room for what each patch needs.
#[test]
fn slots_of_the_host_do_not_overlap() {
    let prepared = &prepared("ngons")[0];
    let options = SurfaceOptions {
        slots: Slots::Host,
        ring_bytes: 1 << 15,
        greatest_level: 8.0,
        ..SurfaceOptions::default()
    };
    let cut = Cut {
        level: 8.0,
        spacing: Spacing::Equal,
    };
    let tags = tags(prepared);
    for tags in [None, Some(&tags)] {
        let list = DrawList::new(prepared, &options, None, cut, tags).expect("it fits");
        assert!(list.has_decisions() && list.batches().len() > 1);
        for batch in list.batches() {
            let pass = &prepared.passes[batch.pass()];
            let mut next = 0;
            for patch in batch.patches() {
                let record = list.records(batch.pass())[patch as usize];
                assert_eq!(record.slot, next);
                let levels = list.levels(prepared, batch.pass(), patch);
                let level = levels.map(|levels| required_level(&levels, pass.max_level));
                next += pass.points(patch as usize, level.expect("it is drawn"));
            }
            assert_eq!(next, batch.points());
        }
    }
}

/// Whatever draws it: by ring and cache, tagged or not, by the tessellator or by patterns.
#[test]
fn of_what_is_chosen_a_list_draws_all_and_of_the_others_nothing() {
    let chosen = |pass: usize, patch: u32| (pass as u32 + patch).is_multiple_of(3);
    let positions = Model::new(builtin("ngons").expect("it is built in")).positions();
    for prepared in prepared("ngons") {
        let controls = prepared.controls(positions.clone());
        let tags = tags(&prepared);
        let backends = [Backend::Tessellator, Backend::Pattern];
        for (backend, tags) in backends.iter().flat_map(|b| [(b, None), (b, Some(&tags))]) {
            let options = SurfaceOptions {
                backend: *backend,
                residence: match backend {
                    Backend::Pattern => Residence::Cache,
                    _ => Residence::Ring,
                },
                ..SurfaceOptions::default()
            };
            let cut = Cut {
                level: 4.0,
                spacing: Spacing::Equal,
            };
            let Ok(whole) = DrawList::new(&prepared, &options, None, cut, tags) else {
                continue;
            };
            let few = whole.clone().only(&prepared, chosen).expect("its own");
            assert!(few.number() != whole.number() && few.has_decisions());
            let drawn = |list: &DrawList| {
                let tessellated = list.tessellate(&prepared, &controls).expect("its own");
                let mut points = tessellated.points;
                points.retain(|point| chosen(point.pass as usize, point.patch));
                points
            };
            let points = few
                .tessellate(&prepared, &controls)
                .expect("its own")
                .points;
            assert!(!points.is_empty() && points == drawn(&whole));
            for batch in few.batches() {
                for patch in batch.patches() {
                    let record = few.records(batch.pass())[patch as usize];
                    assert_eq!(record.inside > 0.0, chosen(batch.pass(), patch));
                }
            }
        }
    }
}

#[test]
fn every_patch_is_an_instance_of_a_pattern() {
    let prepared = prepared("ngons").pop();
    let prepared = &prepared.expect("the last method does every mesh");
    let options = SurfaceOptions {
        backend: Backend::Pattern,
        ..SurfaceOptions::default()
    };
    let cut = Cut {
        level: 5.0,
        spacing: Spacing::FractionalEven,
    };
    let list = DrawList::new(prepared, &options, Some(1), cut, Some(&tags(prepared)));
    let list = list.expect("no ring is needed");
    assert_eq!(
        (list.cut().level, list.cut().spacing),
        (8.0, Spacing::Equal)
    );
    assert!(list.patterns().len() > 3);
    let mut all = 0;
    for (number, pass) in prepared.passes.iter().enumerate() {
        let mut patches = list.instances(number).to_vec();
        patches.sort_unstable();
        assert!(patches.into_iter().eq(0..pass.patches.len() as u32));
        all += pass.patches.len();
    }
    let draws = list.batches().flat_map(|batch| batch.draws());
    let drawn = draws.map(|draw| match *draw {
        Draw::Pattern {
            pattern, instances, ..
        } => {
            assert!((pattern as usize) < list.patterns().len());
            instances as usize
        }
        Draw::Patches { .. } | Draw::Decided { .. } => panic!("patterns are drawn"),
    });
    assert_eq!(drawn.sum::<usize>(), all);
}

/// A ring of the bytes that a cut tells of has a batch a pass, and one that is a point smaller has more.
#[test]
fn a_cut_tells_the_ring_that_it_needs() {
    let mut ringed = 0;
    for name in ["hull", "ngons", "pole-360"] {
        for prepared in prepared(name) {
            for spacing in SPACINGS {
                let cut = Cut {
                    level: 8.0,
                    spacing,
                };
                let ring_bytes = cut.ring_bytes(&prepared);
                let batches = |ring_bytes| {
                    let options = SurfaceOptions {
                        ring_bytes,
                        ..SurfaceOptions::default()
                    };
                    let list = DrawList::new(&prepared, &options, None, cut, None);
                    list.map_or(usize::MAX, |list| list.batches().len())
                };
                assert_eq!(batches(ring_bytes), prepared.passes.len(), "{name}");
                if ring_bytes > 0 {
                    ringed += 1;
                    let fewer = batches(ring_bytes - 16);
                    assert!(fewer > prepared.passes.len(), "{name}");
                }
            }
        }
    }
    assert!(ringed > 0);
}

/// Decisions of any kind: nothing, levels below the cut's, or all of it.
fn decisions(list: &DrawList, prepared: &Prepared, pass: usize, seed: u32) -> Vec<abi::PatchDraw> {
    let patches = &prepared.passes[pass];
    let random = |patch: u32| (patch + 1).wrapping_mul(2_654_435_761).rotate_left(seed) >> 8;
    let decided = (0..patches.patches.len() as u32).map(|patch| {
        let share = (random(patch) % 1000) as f32 / 1000.0;
        let level = 1.0 + share * (list.cut().level - 1.0);
        let cut = Cut {
            level: if seed.is_multiple_of(3) {
                list.cut().level
            } else {
                level
            },
            ..list.cut()
        };
        let drawn = seed % 3 != 2 || random(patch).is_multiple_of(5);
        let levels = list.levels(prepared, pass, patch).filter(|_| drawn);
        let levels = levels.and_then(|_| cut.levels(patches, patch as usize));
        levels.map_or_else(abi::PatchDraw::default, |own| abi::PatchDraw {
            slot: 0,
            edges: own.edges,
            inside: own.inside,
        })
    });
    decided.collect()
}

/// Holds what is made of decisions about a pass to its promises: how many batches draw nothing.
fn hold_compacted(list: &DrawList, prepared: &Prepared, pass: usize, seed: u32) -> usize {
    let decided = decisions(list, prepared, pass, seed);
    let Some(made) = list.compacted(prepared, pass, &decided) else {
        return 0;
    };
    let drawn = (0u32..).zip(&decided).filter(|(_, own)| own.inside > 0.0);
    assert!(drawn.map(|(patch, _)| patch).eq(made.list.iter().copied()));
    let recorded = list.batches().filter(|batch| batch.pass() == pass).count();
    assert_eq!(made.batches.len(), recorded);
    let mut next = 0;
    for batch in &made.batches {
        assert_eq!(batch.first, next, "one after another");
        next += batch.patches;
        let places = batch.per_instance * batch.instances;
        assert!(places >= batch.patches && places < batch.patches + batch.instances.max(1));
        let own = batch.first as usize..next as usize;
        // Without a ring there are no slots.
        if list.options().residence == Residence::Cache {
            continue;
        }
        let mut end = 0;
        for (&patch, &slot) in made.list[own.clone()].iter().zip(&made.slots[own]) {
            let own = &decided[patch as usize];
            let levels = Levels {
                domain: prepared.passes[pass].domain,
                cells: [1; 2],
                edges: own.edges,
                inside: own.inside,
            };
            assert!(slot >= end, "slots do not overlap");
            end = slot + prepared.passes[pass].points(patch as usize, required_level(&levels, 10));
        }
        assert!(end <= list.options().ring_points());
    }
    assert_eq!(next as usize, made.list.len());
    made.batches.iter().filter(|own| own.patches == 0).count()
}

/// Whatever a device decides, what it makes of that draws each patch once, in no more batches than are recorded, each within the ring.
#[test]
fn what_is_made_of_decisions_draws_what_is_drawn_once_and_within_bounds() {
    let (mut lists, mut empty) = (0, 0);
    for name in ["cube", "ngons", "hull", "pole-64", "sheet"] {
        for prepared in prepared(name) {
            for (ring_bytes, batch_vertices) in
                [(1 << 20, u32::MAX), (1 << 14, u32::MAX), (1 << 14, 500)]
            {
                for residence in Residence::ALL {
                    let options = SurfaceOptions {
                        ring_bytes,
                        batch_vertices,
                        residence,
                        decides: Decides::Device,
                        greatest_level: 16.0,
                        ..SurfaceOptions::default()
                    };
                    // A pole of 64 faces may be too much for a small ring.
                    let Ok(counters) = DrawList::ring_counters(&prepared, &options, Some(2000))
                    else {
                        continue;
                    };
                    for (level, spacing) in [1.0, 5.0, 16.0].into_iter().zip(SPACINGS.repeat(2)) {
                        let cut = Cut { level, spacing };
                        let list = DrawList::new(&prepared, &options, Some(2000), cut, None);
                        let list = list.expect("what holds the greatest level holds all");
                        let ringed = list.batches().filter(|batch| batch.points() > 0);
                        assert!(ringed.count() as u64 <= counters);
                        for pass in 0..prepared.passes.len() {
                            empty += (0..3)
                                .map(|seed| hold_compacted(&list, &prepared, pass, seed))
                                .sum::<usize>();
                        }
                        lists += 1;
                    }
                }
            }
        }
    }
    assert!(lists > 200 && empty > 200, "{lists} {empty}");
}
