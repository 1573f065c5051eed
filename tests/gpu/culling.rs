//! What the device leaves out is not seen, and costs nothing.

use std::rc::Rc;

use ash::vk;
use hullform::gpu::{
    Cut, Decision, Fill, Metric, Outcome, Pipelines, Residence, Samples, Shading, SurfaceOptions,
    View,
};
use hullform::host::{self, Owned, Shot, Style};
use hullform::mesh::Model;
use hullform::method::METHODS;
use hullform::tessellation::Spacing;

use crate::common::gpu::{Gpu, Loaded, SIDE, SPACINGS, cut, prepare};
use crate::decide::{RESIDENCES, options, radius, seen, views};
use crate::shapes;

/// A model, its pipelines that cull backs, and what its pictures are of.
struct Subject<'a> {
    loaded: Loaded<'a>,
    pipelines: Rc<Owned<Pipelines>>,
    cut: Cut,
}

impl<'a> Subject<'a> {
    fn new(gpu: &'a Gpu, model: &Model, residence: Residence, cut: Cut) -> Subject<'a> {
        Subject::with(gpu, model, options(residence), cut)
    }

    fn with(gpu: &'a Gpu, model: &Model, options: SurfaceOptions, cut: Cut) -> Subject<'a> {
        let prepared = prepare(model, METHODS[0].name);
        // Models are large: what drivers lose of them has to be worked around.
        let workarounds = &gpu.device.info().workarounds;
        let loaded = gpu.load(model, prepared, workarounds, options);
        let loaded = loaded.expect("the tessellator draws it");
        let style = Style {
            cull: vk::CullModeFlags::BACK,
            ..Style::new(options, cut.spacing, Fill::Solid(Shading::Patch))
        };
        let pipelines = gpu.pipelines(loaded.prepared(), style);
        Subject {
            pipelines: pipelines.expect("the shipped modules make pipelines"),
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

/// The pixels that differ.
fn differing(a: &[u8], b: &[u8]) -> Vec<usize> {
    let pixels = a.chunks(4).zip(b.chunks(4)).enumerate();
    pixels
        .filter(|(_, (a, b))| a != b)
        .map(|(at, _)| at)
        .collect()
}

/// With and without what can be left out, for some views: what was left out of all of them.
fn assert_same_pictures(
    gpu: &Gpu,
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
        let mut differing = differing(&whole.0, &culled.0);
        if !differing.is_empty() {
            // What llvmpipe draws of a triangle may depend on what else is drawn with it: what has been left out is in no batch.
            let others = SurfaceOptions {
                batch_vertices: 1000,
                ..subject.loaded.surface().options()
            };
            let mut other = Subject::with(gpu, model, others, subject.cut);
            let other = other.draw(culling(metric), view).0;
            differing.retain(|&at| other[4 * at..][..4] != whole.0[4 * at..][..4]);
        }
        let differing = differing.len();
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

/// On each model, of as many views as `HULLFORM_VIEWS` says.
#[test]
fn what_is_left_out_is_not_seen() {
    let Some(gpu) = Gpu::open() else { return };
    let views = std::env::var("HULLFORM_VIEWS").ok();
    let views = views.map_or(60, |count| count.parse().expect("a number of views"));
    let built_in =
        ["hull", "ngons", "creased-torus"].map(|name| (name.to_owned(), shapes::built_in(name)));
    let files = crate::common::obj_files("models").into_iter().map(|file| {
        let mesh = hullform::mesh::read_obj(&file).expect("it is sound");
        (crate::common::stem(&file), Model::new(mesh))
    });
    let (mut sum, mut splines) = (Outcome::default(), 0);
    for (number, (name, model)) in built_in.into_iter().chain(files).enumerate() {
        let cut = cut(5.0, SPACINGS[number % 2]);
        let mut subject = Subject::new(&gpu, &model, RESIDENCES[number / 2 % 2], cut);
        let culled = assert_same_pictures(&gpu, &name, &mut subject, &model, views);
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

/// What half of the points are for is beyond the picture's edge, or half of the vertices.
#[test]
fn where_half_is_outside_half_the_points_are_computed() {
    let Some(gpu) = Gpu::open() else { return };
    let mut sums = [0; 2];
    for file in crate::common::obj_files("models") {
        let model = Model::new(hullform::mesh::read_obj(&file).expect("it is sound"));
        let name = crate::common::stem(&file);
        let places = model.positions();
        let mut subject = Subject::new(&gpu, &model, Residence::Ring, cut(8.0, Spacing::Equal));
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
