//! What the device leaves out is not seen, and costs nothing.

use ash::vk;
use hullform::abi;
use hullform::frame::Culled;
use hullform::gpu::shaders::spirv;
use hullform::gpu::{
    Cut, Decision, Fill, Fragment, Metric, Outcome, PipelineOptions, Pipelines, Residence, Samples,
    Shading, SurfaceOptions, View,
};
use hullform::host::{self, Owned, Shot, Style};
use hullform::mesh::Model;
use hullform::method::{Displacement, METHODS, MacroFaces};
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, Loaded, SIDE, SPACINGS, cut};
use crate::decide::{RESIDENCES, options, radius, seen, views};
use crate::shapes;

/// A model, its pipelines that show fronts, and what its pictures are of.
struct Subject<'a> {
    loaded: Loaded<'a>,
    pipelines: Owned<Pipelines>,
    cut: Cut,
}

/// Pipelines whose pictures tell which patch is seen, and none from behind. Not by the rasteriser's culling: llvmpipe culls triangles as they are where another one of
/// the draw is clipped, else as they are when rounded, so that slivers come and go with patches at the picture's edge
/// (`src/conformance/bugs/culled_before_rounding.md`).
fn fronts(gpu: &Gpu, loaded: &Loaded<'_>, style: Style) -> Owned<Pipelines> {
    let device = gpu.device.raw();
    let words = spirv("conformance.fronts.frag").expect("it ships");
    let info = vk::ShaderModuleCreateInfo::default().code(words);
    // SAFETY: the device is live, here and below.
    let module = unsafe { device.create_shader_module(&info, None) }.expect("a module");
    let options = PipelineOptions {
        fragment: Some(Fragment {
            module,
            constants: None,
            tangents: false,
        }),
        ..style.options(gpu.target())
    };
    let (layout, cache) = (gpu.layout(), vk::PipelineCache::null());
    // SAFETY: all of one live device; the module goes when the pipelines are made.
    unsafe {
        let made = Pipelines::new(device, layout, cache, loaded.prepared(), &options);
        device.destroy_shader_module(module, None);
        Owned::new(&gpu.device, made.expect("the modules make pipelines"))
    }
}

impl<'a> Subject<'a> {
    fn new(
        gpu: &'a Gpu,
        model: &Model,
        faces: MacroFaces,
        residence: Residence,
        cut: Cut,
    ) -> Subject<'a> {
        let options = SurfaceOptions {
            ring_bytes: 16 << 20,
            greatest_level: cut.level,
            ..options(residence)
        };
        let prepared = METHODS[0].prepare(model, faces).expect("a sound mesh");
        // Models are large: what drivers lose of them has to be worked around.
        let workarounds = &gpu.device.info().workarounds;
        let loaded = gpu.load(model, prepared, workarounds, options);
        let loaded = loaded.expect("the tessellator draws it");
        let style = Style::new(options, cut.spacing, Fill::Solid(Shading::Patch));
        Subject {
            pipelines: fronts(gpu, &loaded, style),
            loaded,
            cut,
        }
    }

    /// The picture of a view, the points that it took, and what was decided.
    fn draw(&mut self, decision: Decision, view: View) -> (Vec<u8>, u32, Outcome) {
        self.loaded.decision = decision;
        let list = self.loaded.draw_list(self.cut).expect("it is a cut");
        let shot = Shot {
            pipelines: &self.pipelines,
            view,
            instances: 1,
            batches: list.batches().collect(),
        };
        let counted = host::Loaded::draw(&self.loaded, &[shot]);
        let counted = counted.expect("it is executed");
        let surface = self.loaded.surface();
        let counters = surface.counters().expect("it was read back");
        let outcome = surface.outcome(&list, 0..1).expect("it was read back");
        assert_eq!(counters.overflows, 0);
        if let Some([_, evaluations, _]) = counted {
            assert!(evaluations >= outcome.vertices, "{evaluations} {outcome:?}");
        }
        (self.loaded.pixels(), counters.points, outcome)
    }
}

/// Everything that can be left out.
fn culling(metric: Metric) -> Decision {
    Decision {
        metric,
        frustum: true,
        back: true,
        small: Some(Samples {
            a_pixel: 1,
            size: [SIDE as f32; 2],
        }),
        seen_from: None,
    }
}

/// With and without what can be left out, for some views: what was left out of all of them.
fn assert_same_pictures(
    name: &str,
    subject: &mut Subject<'_>,
    model: &Model,
    count: u32,
) -> Outcome {
    let (places, radius) = (model.positions(), radius(model));
    let bounds = places.iter().fold([places[0]; 2], |[low, high], &place| {
        [low.min(place), high.max(place)]
    });
    let mut sum = Outcome::default();
    for (number, view) in views(count, radius).enumerate() {
        let metric = match number % 4 {
            0 => Metric::Cut,
            1 => Metric::Distance(radius),
            2 => Metric::Screen {
                pixels: 2.0,
                size: [SIDE as f32; 2],
            },
            _ => Metric::Curvature(12.0),
        };
        let whole = Decision {
            metric,
            ..Decision::default()
        };
        let whole = subject.draw(whole, view);
        let culled = subject.draw(culling(metric), view);
        let differing = whole.0.chunks(4).zip(culled.0.chunks(4));
        let differing = differing.filter(|(a, b)| a != b).count();
        assert_eq!(
            differing, 0,
            "{name}, view {number} by {metric:?}: {view:?}"
        );
        // Of what is seen of no instance, no patch is drawn.
        if !culling(metric).may_show(bounds, &seen(&view)) {
            assert_eq!(culled.2.drawn, 0, "{name}, view {number}");
        }
        let all = culled.2.drawn + culled.2.frustum + culled.2.back + culled.2.small;
        assert_eq!(whole.2.drawn, all, "{name}, view {number}");
        if subject.loaded.surface().options().residence == Residence::Ring {
            assert!(
                u64::from(culled.1) >= culled.2.points && culled.1 <= whole.1,
                "{name}"
            );
        }
        sum += culled.2;
    }
    sum
}

/// As many as `HULLFORM_VIEWS` says.
fn count_of_views() -> u32 {
    let views = std::env::var("HULLFORM_VIEWS").ok();
    views.map_or(60, |count| count.parse().expect("a number of views"))
}

fn files() -> impl Iterator<Item = (String, Model)> {
    crate::common::obj_files("models").into_iter().map(|file| {
        let mesh = hullform::mesh::read_obj(&file).expect("it is sound");
        (crate::common::stem(&file), Model::new(mesh))
    })
}

#[test]
fn what_is_left_out_is_not_seen() {
    let Some(gpu) = Gpu::open() else { return };
    let views = count_of_views();
    let built_in =
        ["hull", "ngons", "creased-torus"].map(|name| (name.to_owned(), shapes::built_in(name)));
    let files = files();
    let (mut sum, mut splines) = (Outcome::default(), 0);
    for (number, (name, model)) in built_in.into_iter().chain(files).enumerate() {
        let (residence, cut) = (RESIDENCES[number / 2 % 2], cut(5.0, SPACINGS[number % 2]));
        let mut subject = Subject::new(&gpu, &model, MacroFaces::None, residence, cut);
        let culled = assert_same_pictures(&name, &mut subject, &model, views);
        println!("{name}: {culled:?}");
        sum += culled;
        // No other patches are left out for their backs.
        for pass in &subject.loaded.prepared().passes {
            let own = (0..pass.patches.len()).filter(|&patch| pass.spline(patch).is_some());
            splines += u64::from(views) * own.count() as u64;
        }
    }
    let all = sum.drawn + sum.frustum + sum.back + sum.small;
    assert!(
        sum.frustum > all / 20 && sum.back > splines / 50 && sum.small > all / 50,
        "{sum:?}"
    );
    gpu.finish();
}

/// Several faces at once, as the twin would leave them out.
#[test]
fn macro_faces_that_are_left_out_are_not_seen() {
    let Some(gpu) = Gpu::open() else { return };
    let views = count_of_views();
    let shapes = [
        ("hull".into(), shapes::built_in("hull")),
        ("torus".into(), shapes::torus()),
    ];
    // Files are for long runs.
    let files = files().filter(|_| views > 60);
    let subjects = shapes.into_iter().chain(files);
    let kinds = [
        MacroFaces::Quartets,
        MacroFaces::Rectangles { span: 4 },
        MacroFaces::Rectangles { span: 16 },
    ];
    let subjects = subjects.flat_map(|subject| kinds.map(|kind| (subject.clone(), kind)));
    let mut sum = [0; 3];
    for (number, ((name, model), faces)) in subjects.enumerate() {
        let level = faces.greatest_level().min(5) as f32;
        let cut = cut(level, Spacing::Equal);
        let mut subject = Subject::new(&gpu, &model, faces, RESIDENCES[number % 2], cut);
        let culled = assert_same_pictures(&name, &mut subject, &model, views);
        println!("{name}, {faces:?}: {culled:?}");
        let own = hold_macro_faces(&mut subject, &model);
        for (sum, own) in sum.iter_mut().zip(own) {
            *sum += own;
        }
    }
    assert!(sum.into_iter().all(|left_out| left_out > 20), "{sum:?}");
    gpu.finish();
}

/// How many macro faces are outside, backs and small in a few views, some through a wide lens, all of which the twin says.
fn hold_macro_faces(subject: &mut Subject<'_>, model: &Model) -> [u32; 3] {
    let (vertices, radius) = (model.positions(), radius(model));
    let mut counts = [0; 3];
    for (number, mut view) in views(12, radius).enumerate() {
        view.displacement = Displacement::default();
        for column in view.clip_from_model.iter_mut().filter(|_| number % 3 == 0) {
            column[0] /= 30.0;
            column[1] /= 30.0;
        }
        let decision = culling(Metric::Cut);
        let whole = subject.draw(Decision::default(), view);
        assert!(subject.draw(decision, view).0 == whole.0, "{number}");
        let prepared = subject.loaded.prepared();
        for (number, pass) in prepared.passes.iter().enumerate() {
            let decided = subject.loaded.surface().decided(number, 0);
            for (patch, record) in decided.iter().enumerate() {
                let (outline, seen) = (&prepared.outline, seen(&view));
                let twin = decision.decide(outline, pass, patch, &vertices, subject.cut, &seen);
                let reasons = [Culled::Frustum, Culled::Back, Culled::Small];
                let flags = [abi::DECIDE_FRUSTUM, abi::DECIDE_BACK, abi::DECIDE_SMALL];
                let reason = |why: Culled| reasons.iter().position(|&one| one == why);
                let Some(twin) = twin else { continue };
                let twin = twin.err().and_then(reason);
                // What is drawn has a slot there.
                let left_out = if record.inside == 0.0 { record.slot } else { 0 };
                assert_eq!(left_out, twin.map_or(0, |why| flags[why]), "{patch}");
                let is_macro = pass.faces_of(patch).len() > 1;
                if let Some(why) = twin.filter(|_| is_macro) {
                    counts[why] += 1;
                }
            }
        }
    }
    counts
}

/// What half of the points are for is beyond the picture's edge, or half of the vertices.
#[test]
fn where_half_is_outside_half_the_points_are_computed() {
    let Some(gpu) = Gpu::open() else { return };
    let mut sums = [0; 2];
    for (name, model) in files() {
        let places = model.positions();
        let (residence, cut) = (Residence::Ring, cut(8.0, Spacing::Equal));
        let mut subject = Subject::new(&gpu, &model, MacroFaces::None, residence, cut);
        let mut of_vertices: Vec<(f32, u32)> = places.iter().map(|place| (place.x, 1)).collect();
        let mut of_points = Vec::new();
        let prepared = subject.loaded.prepared();
        for pass in &prepared.passes {
            for (patch, sides) in pass.sides.iter().enumerate() {
                let own = sides.iter().flat_map(|&side| prepared.outline.side(side));
                let own: Vec<f32> = own.map(|&vertex| places[vertex as usize].x).collect();
                let middle = own.iter().sum::<f32>() / own.len() as f32;
                of_points.push((middle, pass.points(patch, 3)));
            }
        }
        for (what, halves) in [("vertices", &mut of_vertices), ("points", &mut of_points)] {
            halves.sort_by(|a, b| a.0.total_cmp(&b.0));
            let all: u32 = halves.iter().map(|half| half.1).sum();
            let mut so_far = 0;
            let middle = halves.iter().find(|half| {
                so_far += half.1;
                2 * so_far >= all
            });
            let (at, _) = middle.expect("there are some");
            let mut view = subject.loaded.view;
            view.clip_from_model[3][0] = 1.0 - view.clip_from_model[0][0] * at;
            let whole = subject.draw(Decision::default(), view);
            let frustum = Decision {
                frustum: true,
                ..Decision::default()
            };
            let culled = subject.draw(frustum, view);
            println!(
                "{name}, half of the {what}: {} of {} points",
                culled.1, whole.1
            );
            assert!(whole.0 == culled.0, "{name}");
            // Faces that are half outside are not left out, and those of a car are large.
            let few = 100 * culled.1 <= 59 * whole.1;
            assert!(few, "{name}: {} of {}", culled.1, whole.1);
            sums[0] += culled.1;
            sums[1] += whole.1;
        }
        drop(subject);
    }
    assert!(100 * sums[0] <= 55 * sums[1], "{sums:?}");
    gpu.finish();
}
