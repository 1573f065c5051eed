//! Surface methods: how each prepares a model for the GPU, and how its evaluation reads as a CPU twin.
//!
//! A method is one file here, one or more in `glsl/method`, and one row of [`METHODS`]. Command line, documentation and tests go over the
//! rows; nothing else names a method. [The manual](crate::manual::choosing) tells what each is good for.
//!
//! # Adding a method
//!
//! A method `name` is `src/method/name.rs` with what it needs in `src/method/name/`, `glsl/method/name.glsl`, one more
//! `glsl/method/name_something.glsl` for each further set of shaders, and a row. The build compiles every file of `glsl/method`.
//!
//! **The row** is a [`Method`] in [`METHODS`]. [`Contract`] says which surface it draws
//! and how near, which also decides whether it draws a model when nobody names a method; tests hold it to that. `covers` refuses meshes that the method cannot draw, by a face, edge or
//! vertex; refuse rather than draw another surface. `prepare` returns [`Prepared`]: a [`Pass`] for each set of shaders, without those that have no
//! patches. A pass has one [`Domain`] and names its shader. Faces come from `patches::parts`, with their flags and texture coordinates.
//!
//! **Points.** What can be computed once a frame from the control vertices, and not once a patch, goes into [`Prepared::points`]: refined vertices
//! and other weighted sums, limits with their normals, normals of rings of faces, means of normals. The device and the host compute them with
//! the same bits. A patch then names points instead of vertices (`vertices.rs`).
//!
//! **The shader.** `glsl/surface.vert`, `.tesc`, `.tese`, `.frag`, `.pattern.vert` and `.geom` include it in the place of `#include "method"`; the last
//! two call all of its functions in one stage (`lib/whole.glsl`). It defines `TRIANGLES`
//! if its domain is that, includes `lib/levels.glsl`, and gives:
//!
//! | what | in stage | is |
//! | --- | --- | --- |
//! | `const uint CONTROL_POINTS` | all | [`Pass::control_points`] |
//! | `#define CONTROL_VERTICES` | all | invocations of the control shader a patch, 32 at most |
//! | `vec3 control_point(Patch, uint number)` | vertex | what a vertex hands on: a control vertex, or nothing when the control shader fetches points |
//! | `vec3 patch_point(Patch, uint number)` | control | what invocation `number` hands on |
//! | `Point evaluate_patch(Patch, uint slot, vec2 uv)` | evaluation | position and normal; `in_point[]` holds what was handed on (`lib/control_points.glsl`) |
//! | `bool has_one_normal(Patch, vec2 uv)` | evaluation | whether all faces there have the same normal, so that a displacement opens nothing |
//! | `Cell cell_at(Patch, vec2 uv)` | fragment | which piece of the patch a point belongs to, for pictures that show it |
//!
//! A shader that defines `SCRATCH_RING` gives `scratch_points` and `run_stencils` instead of `patch_point` (`lib/scratch.glsl`). Whatever flows into
//! a position or normal is `precise`.
//!
//! **Edges.** A method that promises to be watertight evaluates an edge from what belongs to that edge alone, in an order that reads the same from
//! both ends: as sums in which all other terms are zero (`sum_of_three`, `sum_of_four`), or on one of the faces for all (`bft`).
//!
//! **The twin** is a [`Twin`]: the same operations in f32, from the bytes that the GPU gets. Write it first. The first lines of the shader say where
//! it is.
//!
//! **What holds it**, without a line of its own: the device against the twin, the counts of vertices, points from the device against those of the
//! host (`tests/gpu`), the contract and the bits on shared edges (`hullform verify`), `NoContraction` and layouts read off the SPIR-V, the files
//! (`tests/architecture.rs`). What its paper claims needs tests of its own, in `src/method/name/tests.rs`. Then make its modules with
//! `scripts/update-spirv`, its pictures as `tests/pictures.rs` says, and its lines in [the manual](crate::manual).

mod acc;
mod bft;
mod bicubic;
mod blended;
mod bounds;
mod cached;
mod cell;
mod change;
mod children;
#[cfg(feature = "vulkan")]
mod deciding;
mod depths;
mod dfas;
mod displacement;
mod edge_field;
mod editable;
mod fas;
mod flat;
mod gregory;
mod limits;
mod macro_faces;
mod options;
mod origin;
mod outline;
mod pass;
mod patches;
mod phong;
mod pieces;
mod placed;
mod pn;
mod points;
mod ptex;
mod qas;
mod quads;
mod quadtree;
mod refine;
mod regular;
mod spline;
mod spokes;
mod stage;
mod stam;
mod surface;
mod table;
mod tags;
mod triangles;
mod unit;
mod vertices;

use crate::error::{Error, Result};
use crate::mesh::{Model, Scheme};
use crate::plan::Database;
use crate::tessellation::Domain;
use editable::Edits;
use limits::Limits;
use origin::Origin;

#[cfg(feature = "vulkan")]
pub(crate) use cached::CacheEdits;
#[cfg(feature = "vulkan")]
use cached::EditedPoints;
pub use cached::{CachedPass, CachedPoints, Jobs};
pub use cell::Cell;
pub use change::{PassChange, Update};
#[cfg(feature = "vulkan")]
pub(crate) use deciding::deciding_tables;
pub(crate) use depths::depth_at;
pub use displacement::Displacement;
pub use editable::Editable;
pub use macro_faces::{MacroFace, MacroFaceCounts, MacroFaces};
pub use options::{EndCaps, IsolationOptions, MethodOptions, TableNormals, TableOptions};
pub use outline::Outline;
pub use pass::{Pass, Twin, is_on_hexagon};
pub use points::Points;
pub use ptex::{from_ptex, to_ptex};
pub use quadtree::PlanStatistics;
#[cfg(feature = "host")]
pub(crate) use quadtree::node_kind;
pub use surface::{Controls, SurfacePoint};
pub use table::Table;
pub use tags::DepthTags;

/// Which surface a method draws, and how exactly: distances are over the diagonal of the bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reproduces {
    /// The limit of the scheme, to within this.
    Limit(f64),
    /// The limit of the scheme, to within this, at the corners of a grid of 2^([`Pass::max_level`] - 1) segments a patch's edge, and
    /// linear between them: see [`Pass::is_on_lattice`].
    LimitOnLattice(f64),
    /// The limit of the scheme, to within this, but for end caps around what is irregular at the last level, see [`Pass::caps`]: of these only the corners.
    LimitBesideCaps(f64),
    /// The limit of the scheme, to within this and with its normals, at the corners and the middles of the edges of each triangle, see
    /// [`is_on_hexagon`]; between them it only looks like the limit.
    LimitOnHexagon(f64),
    /// The faces of the control mesh, to within this.
    Faces(f64),
    /// A surface of its own that looks like the limit.
    Itself,
}

impl Reproduces {
    /// Whether what is drawn is the limit of a scheme, apart from what triangles leave out between their vertices.
    pub fn is_limit(self, scheme: Scheme) -> bool {
        match self {
            Reproduces::Limit(_) | Reproduces::LimitOnLattice(_) => true,
            Reproduces::Faces(_) => scheme == Scheme::Bilinear,
            Reproduces::LimitBesideCaps(_) | Reproduces::LimitOnHexagon(_) | Reproduces::Itself => {
                false
            }
        }
    }

    /// How far in kind a surface is from the limit.
    fn remoteness(self) -> u32 {
        match self {
            Reproduces::Limit(_) | Reproduces::LimitOnLattice(_) => 0,
            Reproduces::LimitBesideCaps(_) | Reproduces::LimitOnHexagon(_) => 1,
            Reproduces::Itself => 2,
            Reproduces::Faces(_) => 3,
        }
    }
}

/// What a method promises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contract {
    /// Which surface it draws.
    pub reproduces: Reproduces,
    /// The greatest angle between its normals and the limit's, in degrees.
    pub normals: Option<f64>,
    /// Whether it passes through the control vertices.
    pub interpolates: bool,
    /// Whether both sides of every edge get the same bits.
    pub watertight: bool,
}

/// A row of the table of methods.
#[derive(Clone, Copy)]
pub struct Method {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub summary: &'static str,
    /// Where it is described.
    pub paper: &'static str,
    /// The schemes whose surfaces it renders, or stands in for.
    pub schemes: &'static [Scheme],
    /// The shapes that its patches can have.
    pub domains: &'static [Domain],
    /// What it promises.
    pub contract: Contract,
    /// Whether it goes by [`MethodOptions::tables`].
    pub uses_tables: bool,
    /// Whether it goes by [`MethodOptions::isolation`].
    pub isolates: bool,
    /// Whether it goes by [`MethodOptions::macro_faces`].
    pub aggregates: bool,
    /// Whether it refines as deep as each frame needs, everywhere by itself where the host decides; see [`Prepared::is_dynamic`].
    pub dynamic: bool,
    /// Refuses meshes that it cannot draw, by a place in them.
    covers: fn(&Model) -> Result<()>,
    /// Prepares a model of one of its schemes; [`Method::prepare`] refuses others.
    prepare: fn(&Model, MethodOptions, &Database) -> Result<Prepared>,
    /// The same with what prepares again what edits influence; None where that is everything.
    edits: Option<Editing>,
}

/// Prepares a model that will be edited.
type Editing = fn(&Model, MethodOptions, &Database) -> Result<(Prepared, Box<dyn Edits>)>;

impl Method {
    /// Prepares a model. Options of other methods do not count.
    ///
    /// # Errors
    /// As [`Method::check_model`]; [`Error::Option`] names an option that is out of range.
    pub fn prepare(&self, model: &Model, options: impl Into<MethodOptions>) -> Result<Prepared> {
        self.prepare_with(model, options, &Database::default())
    }

    /// The same with plans of a database, which gets those that it lacks: models that share one share what is alike, and an edited model has most of its
    /// plans already.
    ///
    /// # Errors
    /// As [`Method::prepare`].
    pub fn prepare_with(
        &self,
        model: &Model,
        options: impl Into<MethodOptions>,
        database: &Database,
    ) -> Result<Prepared> {
        self.check_model(model)?;
        let prepared = (self.prepare)(model, options.into(), database)?;
        Ok(self.completed(prepared, model))
    }

    /// With what all methods' have.
    fn completed(&self, mut prepared: Prepared, model: &Model) -> Prepared {
        prepared.method = self.name;
        let limits = Limits::new(model, self.contract.interpolates);
        prepared.outline = Outline::new(model.topology(), limits);
        prepared.origin = Origin::new(model);
        let patches = prepared.passes.iter().map(|pass| &pass.patches[..]);
        let sides = outline::sides_of(model, patches);
        for (pass, sides) in prepared.passes.iter_mut().zip(sides) {
            pass.sides = sides;
            pass.needs = [model.mesh().vertex_count(), prepared.points.count as usize];
        }
        if prepared.macro_faces != MacroFaces::None {
            macro_faces::join_sides(&mut prepared);
        }
        prepared
    }

    /// Whether the method can draw a model, without preparing it.
    ///
    /// # Errors
    /// As [`Method::check`]; [`Error::Input`] names an edge or vertex that the method has no way to draw.
    pub fn check_model(&self, model: &Model) -> Result<()> {
        self.check(model.mesh().options().scheme)?;
        (self.covers)(model)
    }

    /// Whether the method does a scheme.
    ///
    /// # Errors
    /// [`Error::Option`] when it does not, with the methods that do.
    pub fn check(&self, scheme: Scheme) -> Result<()> {
        if self.schemes.contains(&scheme) {
            return Ok(());
        }
        let able = METHODS
            .iter()
            .filter(|method| method.schemes.contains(&scheme));
        let able: Vec<&str> = able.map(|method| method.name).collect();
        let own: Vec<&str> = self.schemes.iter().map(|scheme| scheme.name()).collect();
        Err(Error::Option {
            option: "--method",
            problem: format!("{} does not do the scheme {scheme}", self.name),
            remedy: format!(
                "choose a method that does ({}), or a scheme that it does ({})",
                able.join(", "),
                own.join(", ")
            ),
        })
    }
}

/// For methods that can draw whatever their schemes know.
fn every_mesh(_: &Model) -> Result<()> {
    Ok(())
}

/// Every method.
pub const METHODS: &[Method] = &[
    quadtree::METHOD,
    qas::METHOD,
    bft::METHOD,
    fas::METHOD,
    dfas::METHOD,
    gregory::METHOD,
    acc::METHOD,
    stam::METHOD,
    refine::METHOD,
    pn::METHOD,
    phong::METHOD,
    flat::METHOD,
];

/// The method that draws a model when nobody names one: of those that can, one that draws the limit, else one whose surface is nearest to it in
/// kind, and among equals the first in the table.
pub fn method_for(model: &Model) -> &'static Method {
    nearest(model, METHODS.iter())
}

/// Prepares a model by the method that draws it when nobody names one, see [`method_for`]; where that refuses after all, as it does tables that devices may
/// not be able to bind, by the one that comes next. [`Prepared::method`] tells by which; the errors are those of the methods before it.
///
/// # Errors
/// That of the first, when all refuse.
pub fn prepare_by_default(
    model: &Model,
    options: impl Into<MethodOptions>,
) -> Result<(Prepared, Vec<Error>)> {
    prepare_by_default_with(model, options, &Database::default())
}

/// The same with plans of a database, see [`Method::prepare_with`].
///
/// # Errors
/// As [`prepare_by_default`].
pub fn prepare_by_default_with(
    model: &Model,
    options: impl Into<MethodOptions>,
    database: &Database,
) -> Result<(Prepared, Vec<Error>)> {
    let options = options.into();
    let mut able: Vec<&Method> = METHODS
        .iter()
        .filter(|method| method.check_model(model).is_ok())
        .collect();
    // In the order of the table among equals.
    able.sort_by_key(|method| method.contract.reproduces.remoteness());
    let mut refusals = Vec::new();
    for method in able {
        match method.prepare_with(model, options, database) {
            Ok(prepared) => return Ok((prepared, refusals)),
            Err(refusal) => refusals.push(refusal),
        }
    }
    Err(refusals.swap_remove(0))
}

/// The method by which [`prepare_by_default`] draws a model unless it refuses that.
pub fn method_by_default(model: &Model) -> &'static Method {
    nearest(model, METHODS.iter())
}

/// The way out when a method refuses a model: what draws it when that one does not.
fn instead_of(refusing: &str, model: &Model) -> &'static Method {
    nearest(
        model,
        METHODS.iter().filter(|method| method.name != refusing),
    )
}

fn nearest(model: &Model, methods: impl Iterator<Item = &'static Method>) -> &'static Method {
    let able = methods.filter(|method| method.check_model(model).is_ok());
    let nearest = able.min_by_key(|method| method.contract.reproduces.remoteness());
    nearest.expect("the baseline draws every model, and refuses none")
}

/// The method of a name.
///
/// # Errors
/// [`Error::Option`] with the names there are.
pub fn method(name: &str) -> Result<&'static Method> {
    METHODS
        .iter()
        .find(|method| method.name == name)
        .ok_or_else(|| Error::Option {
            option: "--method",
            problem: format!("there is no method '{name}'"),
            remedy: format!(
                "choose one of {}",
                METHODS
                    .iter()
                    .map(|method| method.name)
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
        })
}

/// What a method made of a model: passes to draw, independent of one another.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// The name of the method. Filled in by [`Method::prepare`].
    pub method: &'static str,
    /// The passes.
    pub passes: Vec<Pass>,
    /// What is computed from the control vertices before patches are drawn; nothing for most methods.
    pub points: Points,
    /// The edges and faces of the control mesh, which [`Pass::sides`] count.
    pub outline: Outline,
    /// What is known about the plans, when the method has any.
    pub plans: Option<PlanStatistics>,
    /// Which faces are drawn together.
    pub macro_faces: MacroFaces,
    /// How many irregularities have depths of their own.
    irregularities: u32,
    /// Tells what a cache holds of its control points.
    cached: Option<fn(&Prepared, u32) -> CachedPoints>,
    /// The same of what is edited.
    #[cfg(feature = "vulkan")]
    recached: Option<fn(&Prepared, u32) -> EditedPoints>,
    /// What it was made of. Filled in by [`Method::prepare`].
    origin: Origin,
}

impl Prepared {
    /// Passes alone; those without patches are left out.
    fn of(passes: impl IntoIterator<Item = Pass>) -> Prepared {
        let passes = passes.into_iter().filter(|pass| !pass.patches.is_empty());
        Prepared {
            passes: passes.collect(),
            ..Prepared::default()
        }
    }

    /// Whether it was made of a model, or of one with the same faces, tags and scheme: the same mesh deformed is as good.
    pub fn is_of(&self, model: &Model) -> bool {
        self.origin.is_of(model)
    }

    /// The control vertices that it was made of.
    pub fn vertex_count(&self) -> usize {
        self.origin.vertices
    }

    /// A number that clones share and nothing else that was prepared has.
    pub(crate) fn number(&self) -> u64 {
        self.origin.number
    }

    /// A number that tells what it was before an edit from what it is now.
    pub(crate) fn version(&self) -> u64 {
        self.origin.version
    }

    /// Says that it was edited, and is a model's now; as something else where devices have to make all anew.
    fn follow(&mut self, model: &Model, is_whole: bool) {
        let Origin {
            number, version, ..
        } = self.origin;
        self.origin = Origin::new(model);
        if !is_whole {
            (self.origin.number, self.origin.version) = (number, version + 1);
        }
        self.plans = None;
    }

    /// The words of all tables.
    fn table_words(&self) -> usize {
        let words = |pass: &Pass| {
            let own = pass.tables.iter().map(|table| table.len());
            pass.controls.len() + own.sum::<usize>()
        };
        self.passes.iter().map(words).sum()
    }

    /// How many patches each pass has room for.
    fn capacities(&self) -> Vec<usize> {
        self.passes.iter().map(|pass| pass.patches.len()).collect()
    }

    /// Refuses lists that have not one entry a control vertex.
    pub(crate) fn check_count(&self, what: &'static str, given: usize) -> Result<()> {
        self.outline.check_count(what, given)
    }

    /// Control vertices, in local units, with the points that are computed from them: what [`Pass::evaluate`] needs. Of more or fewer than
    /// [`vertex_count`](Self::vertex_count) there are no points, and no surface.
    pub fn controls(&self, vertices: Vec<glam::Vec3>) -> Controls {
        let points = match vertices.len() == self.vertex_count() {
            true => self.points.compute(&vertices),
            false => Vec::new(),
        };
        Controls { vertices, points }
    }
}
