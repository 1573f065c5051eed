//! Group `backends`: tessellator, refinement patterns and geometry shaders draw one surface, and depth tags leave it whole.
//!
//! Patterns and rows of triangles lie on a lattice of powers of two, so their vertices are known beforehand, and where the tessellator has the
//! same place, the bits must be the same: all evaluate by the same functions. Whether a surface is whole is asked of the triangles alone, in
//! words of their positions: an edge that has no partner is open.
//!
//! Where control points need stencils the tessellator's come through the scratch ring and the others' from a cache: so both residences are compared as
//! well.
//!
//! Where depths ask for more than 64 segments patches are cut into pieces, and the surface is whole all the same; and so it is where several faces are one
//! patch, whose vertices have the bits of the faces'.
//!
//! A seeded fault turns a bit of a vertex, or gives a patch's edge the tags of another.

mod macro_faces;

use std::collections::{BTreeMap, HashMap};

use glam::{Vec2, Vec3};

use crate::abi::Captured;
use crate::conformance::capture::{Frame, SPACINGS, bits, capturing, cut, prepare, spacing_name};
use crate::conformance::meshes::{can_draw, under};
use crate::conformance::{Case, Check, Context, Finding, Group, Random};
use crate::error::Result;
use crate::gpu::{Backend, Cut, DrawList, Fill, Residence, Shading, SurfaceOptions};
use crate::mesh::{Model, builtin};
use crate::method::{DepthTags, METHODS, Method, MethodOptions, Pass, Prepared};
use crate::plan::PlanOptions;
use crate::tessellation::{Domain, Spacing, lattice_segments};

/// The group.
pub const GROUP: Group = Group {
    name: "backends",
    about: "patterns and geometry shaders, against the tessellator; depth tags",
    cases,
    model_cases: None,
};

const SOURCE: &str = "Boubekeur, Schlick 2007, section 3.2";

const SHAPES: [&str; 4] = ["cube", "ngons", "pole-7", "sheet"];

const LEVELS: [f32; 3] = [2.0, 8.0, 32.0];

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let drawn = METHODS.iter().flat_map(|method| {
        let schemes = method.schemes.iter().copied();
        schemes.flat_map(move |scheme| SHAPES.map(|shape| (method, scheme, shape)))
    });
    for (method, scheme, shape) in
        drawn.filter(|&(method, scheme, shape)| can_draw(method, shape, scheme))
    {
        let model = move || Ok(Model::new(under(builtin(shape)?, scheme)?));
        for backend in Backend::ALL {
            let what = format!("{}-{}-{scheme}-{shape}", backend.name(), method.name);
            if backend != Backend::Tessellator {
                let name = format!("backends.same.{what}");
                let rule = "the same bits as from the tessellator, all vertices and triangles";
                cases.push(Case::new(name, rule, SOURCE, move |context| {
                    same(context, &model()?, method, backend)
                }));
            }
            if !method.contract.watertight {
                continue;
            }
            let spacings: &[Spacing] = match backend.takes_any_level() {
                true => &SPACINGS,
                false => &[Spacing::Equal],
            };
            for &spacing in spacings {
                let name = format!("backends.tags.{what}-{}", spacing_name(spacing));
                let rule = "no edge is open but the boundary's, whatever the tags of its ends";
                cases.push(Case::new(name, rule, SOURCE, move |context| {
                    tags(context, &model()?, method, backend, spacing)
                }));
            }
        }
    }
    cases.extend(PIECES.map(|shape| {
        let name = format!("backends.pieces.{shape}");
        let rule = "no edge is open but the boundary's, whether patches are cut into pieces or not";
        Case::new(
            name,
            rule,
            "manual, Tess levels, Above 64",
            move |context| pieces(context, &Model::new(builtin(shape)?)),
        )
    }));
    cases.extend(macro_faces::cases());
    cases
}

/// Shapes of which some patches have more than 64 segments.
const PIECES: [&str; 3] = ["cube", "ngons", "creased-torus"];

/// What there is to say where a device has no such backend; None where it has.
fn lacking(context: &Context, backend: Backend) -> Result<Option<Finding>> {
    let has = context.device()?.info().support.optional.geometry_shader;
    let lacks = backend == Backend::Geometry && !has;
    Ok(lacks.then(|| Finding::skip("the device has no geometry shaders")))
}

/// What a backend draws at a cut, with tags or without.
pub struct Drawn {
    /// Captured vertices, a list a pass.
    pub passes: Vec<Vec<Captured>>,
    /// Triangles that were clipped and discarded or drawn, where the device counts them.
    pub primitives: Option<u64>,
    /// The vertices that were expected.
    pub expected: u64,
    /// The segments of the mesh's boundary, which are open.
    pub boundary: usize,
    /// The triangles that were expected, as numbers of the vertices of each patch.
    triangles: Vec<Vec<[[u32; 3]; 3]>>,
}

impl Drawn {
    /// Draws a prepared model.
    ///
    /// # Errors
    /// When it cannot be drawn, and Vulkan's own.
    pub fn new(
        context: &Context,
        model: &Model,
        prepared: Prepared,
        backend: Backend,
        tags: Option<DepthTags>,
        cut: Cut,
    ) -> Result<Drawn> {
        let has_ring = prepared.passes.iter().any(|pass| pass.cached.is_some());
        // What the tessellator draws through the ring the others draw from a cache.
        let residence = match has_ring && !backend.takes_ring() {
            true => Residence::Cache,
            false => Residence::Ring,
        };
        Drawn::from(context, model, prepared, (backend, residence), tags, cut)
    }

    /// The same with control points in a residence.
    fn from(
        context: &Context,
        model: &Model,
        prepared: Prepared,
        (backend, residence): (Backend, Residence),
        tags: Option<DepthTags>,
        cut: Cut,
    ) -> Result<Drawn> {
        let options = SurfaceOptions {
            backend,
            residence,
            ..capturing(context, &prepared, backend.cut(cut))
        };
        let workarounds = context.workarounds()?;
        let bench = context.bench()?;
        let mut loaded = bench.load(model, prepared, &workarounds, options)?;
        loaded.tags = tags;
        let frame = loaded.capture(cut, Fill::Solid(Shading::Patch))?;
        let list = loaded.draw_list(cut)?;
        let prepared = loaded.prepared();
        let passes = prepared.passes.iter().enumerate();
        let patches = passes.flat_map(|(number, pass)| {
            (0..pass.patches.len() as u32).map(move |patch| (number, patch))
        });
        let patches: Vec<(usize, u32)> = patches.collect();
        let vertices = |&(pass, patch)| u64::from(list.vertices(prepared, pass, patch));
        // Patterns have spacings of their own.
        let spacing = backend.cut(cut).spacing;
        let boundary = |&(pass, patch)| boundary(model, prepared, &list, spacing, pass, patch);
        Ok(Drawn {
            expected: patches.iter().map(vertices).sum(),
            boundary: patches.iter().map(boundary).sum(),
            triangles: triangles(prepared, &list, &frame),
            primitives: frame.statistics.map(|[_, _, primitives]| primitives),
            passes: frame.passes,
        })
    }

    /// The vertices by pass, patch and place.
    fn by_place(&self) -> HashMap<(usize, u32, [u32; 2]), &Captured> {
        let passes = self.passes.iter().enumerate();
        let all = passes.flat_map(|(pass, vertices)| {
            let place = move |v: &Captured| (pass, v.patch_number, v.uv.map(f32::to_bits));
            vertices.iter().map(move |vertex| (place(vertex), vertex))
        });
        all.collect()
    }

    /// The edges of triangles that have no partner with the same two positions, bit by bit.
    pub fn open_edges(&self) -> usize {
        let mut edges: BTreeMap<[[u32; 3]; 2], i64> = BTreeMap::new();
        for at in self.triangles.iter().flatten() {
            for [a, b] in [[at[0], at[1]], [at[1], at[2]], [at[2], at[0]]] {
                let (key, way) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                if a != b {
                    *edges.entry(key).or_default() += way;
                }
            }
        }
        edges.values().filter(|&&sum| sum != 0).count()
    }
}

/// The segments of a patch's edges beyond which there is no face that is drawn.
fn boundary(
    model: &Model,
    prepared: &Prepared,
    list: &DrawList,
    spacing: Spacing,
    pass: usize,
    patch: u32,
) -> usize {
    let topology = model.topology();
    let is_open = |side: u32| {
        let faces = (side < topology.edge_count() as u32).then(|| topology.edge_faces(side));
        faces.is_some_and(|all| all.iter().filter(|&&face| !topology.is_hole(face)).count() == 1)
    };
    let Some(levels) = list.levels(prepared, pass, patch) else {
        return 0;
    };
    let sides = prepared.passes[pass].sides[patch as usize];
    let edges = sides
        .into_iter()
        .zip(levels.edges)
        .take(levels.domain.corners());
    let open = edges.filter(|&(side, _)| is_open(side));
    open.map(|(_, level)| spacing.segments(level) as usize)
        .sum()
}

/// The triangles of each pass, as the bits of their positions.
fn triangles(prepared: &Prepared, list: &DrawList, frame: &Frame) -> Vec<Vec<[[u32; 3]; 3]>> {
    let of_pass = |(pass, vertices): (usize, &Vec<Captured>)| {
        let patches = vertices.chunk_by(|a, b| a.patch_number == b.patch_number);
        let of_patch = patches.flat_map(|own| {
            let uv: Vec<[f32; 2]> = own.iter().map(|vertex| vertex.uv).collect();
            let found = list.triangles(prepared, pass, own[0].patch_number, &uv);
            let found = found.unwrap_or_default();
            let at = |i: u32| own[i as usize].position.map(f32::to_bits);
            found.into_iter().map(move |triangle| triangle.map(at))
        });
        of_patch.collect()
    };
    frame.passes.iter().enumerate().map(of_pass).collect()
}

fn same(
    context: &Context,
    model: &Model,
    method: &'static Method,
    backend: Backend,
) -> Result<Finding> {
    let (mut check, mut compared) = (Check::default(), 0);
    for level in LEVELS {
        let cut = cut(level, Spacing::Equal);
        let prepared = prepare(model, method.name)?;
        if let Some(finding) = lacking(context, backend)? {
            return Ok(finding);
        }
        let draw = |backend| Drawn::new(context, model, prepared.clone(), backend, None, cut);
        let (reference, mut own) = (draw(Backend::Tessellator)?, draw(backend)?);
        if context.is_wrong() {
            own.passes[0][0].position[0] += 1.0;
        }
        compared += hold_same(&mut check, model, &prepared, &reference, &own, level);
    }
    Ok(check.finish(format!("{compared} vertices with the same bits")))
}

/// The triangles of all patches' lattices.
fn lattice_triangles(prepared: &Prepared, cut: Cut) -> u64 {
    let of_pass = |pass: &Pass| {
        let levels = (0..pass.patches.len()).filter_map(|patch| cut.levels(pass, patch));
        let all = levels.map(|levels| u64::from(lattice_segments(&levels)).pow(2));
        let count: u64 = all.sum();
        match pass.domain {
            Domain::Quads => 2 * count,
            Domain::Triangles => count,
        }
    };
    prepared.passes.iter().map(of_pass).sum()
}

/// Holds what a backend drew to the tessellator's vertices and to the twins; returns how many places both have.
fn hold_same(
    check: &mut Check,
    model: &Model,
    prepared: &Prepared,
    reference: &Drawn,
    own: &Drawn,
    level: f32,
) -> usize {
    let most = 1e-6 * model.diagonal() as f32;
    let controls = prepared.controls(model.positions());
    let (known, places) = (reference.by_place(), own.by_place());
    check.hold(places.len() as u64 == own.expected, || {
        format!(
            "level {level}: {} of {} vertices",
            places.len(),
            own.expected
        )
    });
    let made: usize = own.triangles.iter().map(Vec::len).sum();
    // Where levels differ a geometry shader makes all triangles of the lattice, with those that have no area.
    let whole = lattice_triangles(prepared, cut(level, Spacing::Equal));
    let is_known = |count: u64| count == made as u64 || count == whole;
    check.hold(own.primitives.is_none_or(is_known), || {
        format!(
            "level {level}: {:?} triangles instead of {made}",
            own.primitives
        )
    });
    let mut compared = 0;
    for (place, vertex) in places {
        let (pass, patch) = (&prepared.passes[place.0], place.1 as usize);
        let twin = pass
            .evaluate(&controls, patch, Vec2::from(vertex.uv))
            .position;
        let distance = twin.distance(Vec3::from(vertex.position));
        check.hold(distance <= most, || {
            format!("level {level}: {distance} from the twin at {vertex:?}")
        });
        // Inside of triangles the tessellator has other points.
        if let Some(same) = known.get(&place) {
            check.hold(bits(same) == bits(vertex), || {
                format!("level {level}: {vertex:?} and {same:?}")
            });
            compared += 1;
        }
    }
    compared
}

fn tags(
    context: &Context,
    model: &Model,
    method: &'static Method,
    backend: Backend,
    spacing: Spacing,
) -> Result<Finding> {
    let (mut check, mut triangles) = (Check::default(), 0);
    let mut random = Random::new(context.settings.seed, "backends.tags");
    let cut = cut(16.0, spacing);
    for _ in 0..3 {
        let prepared = prepare(model, method.name)?;
        if let Some(finding) = lacking(context, backend)? {
            return Ok(finding);
        }
        let depths = (0..model.mesh().vertex_count()).map(|_| random.between(-0.5, 4.5) as f32);
        let tags = DepthTags::new(depths.collect::<Vec<f32>>());
        triangles += whole(context, model, prepared, (backend, tags, cut), &mut check)?;
    }
    Ok(check.finish(format!("{triangles} triangles")))
}

/// One vertex and the inside of one face are so deep that their patches are cut into pieces.
fn pieces(context: &Context, model: &Model) -> Result<Finding> {
    let (mut check, mut triangles) = (Check::default(), 0);
    let mut random = Random::new(context.settings.seed, "backends.pieces");
    let (count, options) = (
        model.mesh().vertex_count(),
        MethodOptions::from(PlanOptions {
            max_level: 7,
            ..PlanOptions::default()
        }),
    );
    for level in [100.0, 128.0] {
        let prepared = METHODS[0].prepare(model, options)?;
        let deep = random.below(count as u32) as usize;
        let depths = (0..count).map(|vertex| match vertex == deep {
            true => 7.0,
            false => random.between(-0.5, 3.5) as f32,
        });
        let tags = DepthTags::new(depths.collect::<Vec<f32>>()).with_insides([7.0]);
        let drawn = (Backend::Tessellator, tags, cut(level, Spacing::Equal));
        triangles += whole(context, model, prepared, drawn, &mut check)?;
    }
    Ok(check.finish(format!("{triangles} triangles")))
}

/// Draws with tags, and holds what comes to be whole: how many triangles.
fn whole(
    context: &Context,
    model: &Model,
    mut prepared: Prepared,
    (backend, tags, cut): (Backend, DepthTags, Cut),
    check: &mut Check,
) -> Result<usize> {
    mislead(context, &mut prepared);
    let drawn = Drawn::new(context, model, prepared, backend, Some(tags), cut)?;
    Ok(hold_whole(&drawn, check))
}

/// The seeded fault of what is to be whole: whatever the levels are, they are not those of the neighbours.
fn mislead(context: &Context, prepared: &mut Prepared) {
    if context.is_wrong() {
        let all = prepared.outline.edges().len() as u32;
        for sides in prepared.passes[0].sides.iter_mut().step_by(2) {
            *sides = sides.map(|side| (side + all / 2) % all);
        }
    }
}

/// Holds what was drawn to be whole: how many triangles.
fn hold_whole(drawn: &Drawn, check: &mut Check) -> usize {
    let arrived: usize = drawn.passes.iter().map(Vec::len).sum();
    check.hold(arrived as u64 == drawn.expected, || {
        format!("{arrived} of {} vertices", drawn.expected)
    });
    let (open, boundary) = (drawn.open_edges(), drawn.boundary);
    check.hold(open == boundary, || {
        format!("{open} open edges instead of {boundary}")
    });
    drawn.triangles.iter().map(Vec::len).sum()
}
