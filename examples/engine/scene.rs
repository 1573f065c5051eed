//! Where instances are, at which level each is drawn, and from where they are seen.

use std::f32::consts::TAU;
use std::ops::Range;

use glam::camera::rh::{proj::vulkan, view};
use glam::{Mat4, Vec3};
use hullform::gpu::View;
use hullform::method::Displacement;

use crate::images::{HEIGHT, SHADOWS, WIDTH};
use crate::material::{Instance, Light};

/// Instances a model.
pub const INSTANCES: u32 = 10;

/// The levels that instances are drawn at, the deepest first.
pub const LEVELS: [f32; 4] = [16.0, 8.0, 4.0, 2.0];

/// An edge of a patch is to be cut into pieces of so many pixels.
const PIXELS: f32 = 4.0;

/// The most pixels that an instance has from side to side, from where the camera stands.
const MOST_PIXELS: f32 = 260.0;

/// What a scene knows of a model: its limit surface's bounding box in local units, and its faces.
#[derive(Clone, Copy)]
pub struct Shape {
    pub low: Vec3,
    pub high: Vec3,
    pub faces: usize,
}

impl Shape {
    /// Which of [`LEVELS`] an instance is drawn at that has so many pixels from side to side.
    fn level(&self, pixels: f32) -> usize {
        // As many faces across as there are in a square of them.
        let wanted = pixels / (0.5 * self.faces as f32).sqrt() / PIXELS;
        let fits = LEVELS.iter().rposition(|&level| level >= wanted);
        fits.unwrap_or(0)
    }

    /// The deepest of [`LEVELS`] that it is ever drawn at: what its pose has room for.
    pub fn deepest(&self) -> usize {
        self.level(MOST_PIXELS)
    }
}

/// Camera and sun of a frame.
pub struct Sight {
    eye: Vec3,
    clip_from_world: Mat4,
    shadow_from_world: Mat4,
    sun: Vec3,
}

/// The instances of a model in a frame.
pub struct Placed {
    pub instances: Vec<Instance>,
    /// Seen by the camera, then in the same order by the sun.
    pub views: Vec<View>,
    /// Which of them have each of [`LEVELS`].
    pub levels: [Range<u32>; 4],
}

impl Sight {
    pub fn new(time: f32) -> Sight {
        let eye = Vec3::new(0.6 * (0.2 * time).sin(), 5.0, 9.4);
        let (near, aspect) = (0.5, WIDTH as f32 / HEIGHT as f32);
        let clip_from_eye = vulkan::perspective_infinite_reverse(0.62, aspect, near);
        let eye_from_world = view::look_at_mat4(eye, Vec3::new(0.0, 0.1, -0.2), Vec3::Y);
        let sun = Vec3::new(-0.55, 0.72, 0.30).normalize();
        let sun_from_world = view::look_at_mat4(20.0 * sun, Vec3::new(0.0, 0.0, -1.5), Vec3::Y);
        let reach = 8.0;
        let map = vulkan::orthographic(-reach, reach, -reach, reach, 5.0, 35.0);
        Sight {
            eye,
            clip_from_world: clip_from_eye * eye_from_world,
            shadow_from_world: map * sun_from_world,
            sun,
        }
    }

    pub fn light(&self) -> Light {
        Light {
            shadow_from_world: self.shadow_from_world,
            sun: self.sun.into(),
            softness: 5.0 / SHADOWS as f32,
            eye: self.eye.into(),
            haze: 1.0 / 24.0,
        }
    }

    /// An instance as both see it. Positions on the device are local, so eyes are, too.
    fn views(&self, world_from_model: Mat4) -> [View; 2] {
        let model_from_world = world_from_model.inverse();
        let view = |clip_from_world: Mat4| View {
            clip_from_model: (clip_from_world * world_from_model).to_cols_array_2d(),
            eye: model_from_world.transform_point3(self.eye).into(),
            displacement: Displacement::default(),
        };
        [view(self.clip_from_world), view(self.shadow_from_world)]
    }

    /// How large something of this radius is in the picture, in pixels.
    fn pixels(&self, at: Vec3, radius: f32) -> f32 {
        let depth = self.clip_from_world.project_point3(at).z;
        // Reversed: near / depth is the distance along the line of sight.
        let distance = 0.5 / depth.max(1e-6);
        2.0 * radius / distance * HEIGHT as f32 / (2.0 * (0.31f32).tan())
    }
}

/// The ten instances of a model of three at a time: each turns, and goes around its place.
pub fn place(sight: &Sight, model: usize, shape: &Shape, time: f32) -> Placed {
    let extent = (shape.high - shape.low).max_element();
    let scale = 1.5 / extent;
    let mut all: Vec<(usize, Instance)> = (0..INSTANCES as usize)
        .map(|number| {
            let instance = instance(model, number, shape, scale, time);
            let at = instance.world_from_model.transform_point3(Vec3::ZERO);
            let across = sight.pixels(at, 0.5 * scale * extent);
            (shape.level(across).max(shape.deepest()), instance)
        })
        .collect();
    all.sort_by_key(|&(level, _)| level);
    let mut levels = [(); 4].map(|()| 0..0);
    for (level, range) in levels.iter_mut().enumerate() {
        let place = |level: usize| all.partition_point(|&(own, _)| own < level) as u32;
        *range = place(level)..place(level + 1);
    }
    let instances: Vec<Instance> = all.into_iter().map(|(_, instance)| instance).collect();
    Placed {
        views: seen(sight, &instances),
        instances,
        levels,
    }
}

/// What shines no more than this.
const MATT: Instance = Instance {
    world_from_model: Mat4::IDENTITY,
    colour: [0.0; 3],
    gloss: 0.0,
    brushed: 0.0,
    roughness: [0.10, 0.45],
    highlight: 0.3,
};

/// The ground: one instance of a square.
pub fn ground(sight: &Sight, shape: &Shape) -> Placed {
    let instances = vec![Instance {
        world_from_model: Mat4::from_scale(Vec3::splat(60.0)),
        colour: [0.52, 0.49, 0.45],
        gloss: 0.0,
        ..MATT
    }];
    let views = seen(sight, &instances);
    let mut levels = [(); 4].map(|()| 0..0);
    levels[shape.deepest()] = 0..1;
    Placed {
        instances,
        views,
        levels,
    }
}

fn seen(sight: &Sight, instances: &[Instance]) -> Vec<View> {
    let both = instances
        .iter()
        .map(|instance| sight.views(instance.world_from_model));
    let both: Vec<[View; 2]> = both.collect();
    [0, 1]
        .into_iter()
        .flat_map(|who| both.iter().map(move |views| views[who]))
        .collect()
}

fn instance(model: usize, number: usize, shape: &Shape, scale: f32, time: f32) -> Instance {
    // Six in a row, five rows; models take turns.
    let place = 3 * number + (model + number / 2) % 3;
    let (column, row) = ((place % 6) as f32, (place / 6) as f32);
    let phase = TAU * (0.37 * place as f32).fract();
    let around = 0.12 * Vec3::new((phase + time).cos(), 0.0, (phase + time).sin());
    let shift = 0.5 * (row % 2.0) - 0.25;
    let at = Vec3::new(1.62 * (column - 2.5 + shift), 0.0, 3.1 - 1.85 * row) + around;
    let middle = 0.5 * (shape.low + shape.high);
    let foot = Vec3::new(middle.x, shape.low.y, middle.z);
    let world_from_model = Mat4::from_translation(at)
        * Mat4::from_rotation_y(phase + 0.6 * time)
        * Mat4::from_scale(Vec3::splat(scale))
        * Mat4::from_translation(-foot);
    // A colour a model, a shade an instance.
    let colours = [
        Vec3::new(0.72, 0.13, 0.07),
        Vec3::new(0.05, 0.25, 0.42),
        Vec3::new(0.82, 0.46, 0.07),
    ];
    let shade = 0.85 + 0.3 * (0.61 * number as f32).fract();
    Instance {
        world_from_model,
        colour: (colours[model % 3] * shade).into(),
        gloss: 1.0,
        // The third model is of brushed metal.
        brushed: if model % 3 == 2 { 1.0 } else { 0.0 },
        highlight: if model % 3 == 2 { 1.2 } else { 0.3 },
        ..MATT
    }
}
