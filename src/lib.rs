//! hullform turns a control mesh into plans on the CPU once, and then one patch a face through Vulkan's control and
//! evaluation shaders every frame.
//!
//! # The tour
//!
//! A mesh passes through the modules in this order:
//!
//! 1. [`mesh`]: the control mesh, from slices, from an OBJ file with subdivision tags, or built in. It is checked when it is made.
//! 2. [`subdivision`]: the truth. The limit of any [`Scheme`](mesh::Scheme) at any point, in f64, by recursive refinement.
//! 3. [`plan`]: what a face needs to know about its limit apart from positions: a quadtree over its domain and stencils over its 1-ring.
//! 4. [`method`](mod@method): a way to draw. It prepares a model as tables for the GPU, and says what it promises. Each comes with a twin, which
//!    evaluates in f32 from the same tables what the shader evaluates.
//! 5. [`tessellation`]: tess levels that agree on both sides of every edge.
//! 6. [`frame`]: what a frame decides about a surface: a draw list, a plain value.
//! 7. `gpu` (feature `vulkan`): tables to buffers, pipelines, and draws recorded into your command buffer.
//! 8. `host` (feature `host`): a device and an offscreen picture, for those who have none.
//! 9. `conformance` (feature `host`): the suite of `hullform verify`, for drivers and for ourselves.
//!
//! Up to `frame` everything is plain CPU code. It is not a helper of the GPU: it is what the GPU is tested against.
//!
//! ```
//! use hullform::glam::Vec2;
//! use hullform::mesh::{ControlMesh, Model};
//! use hullform::method::{MethodOptions, from_ptex, method};
//! use hullform::subdivision::LimitSurface;
//!
//! // A cube whose top is held by a semi-sharp crease.
//! let positions = [
//!     [-1.0, -1.0, -1.0], [1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, 1.0],
//!     [-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0],
//! ];
//! let faces = [
//!     0, 1, 2, 3, /* bottom */ 7, 6, 5, 4, /* top */ 3, 2, 6, 7, /* sides */ 2, 1, 5, 6, 1, 0, 4, 5, 0, 3, 7, 4,
//! ];
//! let mut builder = ControlMesh::builder(&positions, &[4; 6], &faces);
//! for [a, b] in [[4, 5], [5, 6], [6, 7], [7, 4]] {
//!     builder = builder.crease(a, b, 2.5);
//! }
//! let mesh = builder.build()?;
//!
//! // The truth: position and normal in the middle of the top, which is face 1.
//! let truth = LimitSurface::new(&mesh).evaluate(1, 0.5, 0.5).expect("face 1 is no hole");
//! assert!(truth.normal().y > 0.999);
//!
//! // What the GPU would get, by the quadtree method: here one pass of six patches and their plans.
//! let model = Model::new(mesh);
//! let prepared = method("quadtree")?.prepare(&model, MethodOptions::default())?;
//! let pass = &prepared.passes[0];
//! assert_eq!(pass.patches.len(), 6);
//!
//! // And what its evaluation shader would make of that, by the twin. A patch may be turned against its face, so that faces share plans;
//! // positions are in local units: see `Placement`.
//! let patch = pass.patches.iter().position(|patch| patch.ptex == 1).expect("each face has a patch");
//! let uv = from_ptex(&pass.patches[patch], [0.5, 0.5]);
//! let twin = pass.evaluate(&prepared.controls(model.positions()), patch, Vec2::from(uv));
//! let position = model.placement().position(twin.position.as_dvec3());
//! assert!(position.distance(truth.position) < 1e-6);
//! # Ok::<(), hullform::Error>(())
//! ```
//!
//! The [`manual`] says all of it in words. `examples/evaluate_limit.rs` asks for single points; `examples/headless_png/main.rs` is the integration guide, from the instance to the
//! picture; `examples/engine/main.rs` is a small engine, with instances, skinning, shadows and two frames in flight.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! | --- | --- | --- |
//! | `vulkan` | through `host` | `gpu`: the layer over a borrowed Vulkan device; without it the crate is pure CPU code |
//! | `host` | yes | `host`: instance, device choice and offscreen target; `conformance`: the suite of `hullform verify` |
//! | `cli` | yes | the `hullform` program |
//! | `view` | yes | its window, `hullform view` |
//! | `shaderc` | no | compile `glsl/` at build time instead of embedding the modules in `glsl/spirv` |
//!
//! An engine takes `default-features = false, features = ["vulkan"]`.
//!
//! # For engines
//!
//! The library borrows device and memory (`gpu::Memory`), records, and never submits, waits or spawns a thread (preparing uses rayon's pool). What each
//! call needs of layouts, stages and lifetimes stands in its `# Safety` section.
//!
//! **The device** needs Vulkan 1.2, three features, `tessellationShader`, `vertexPipelineStoresAndAtomics` and `scalarBlockLayout`, and 8 storage
//! buffers a stage; `gpu::Backend::Geometry` also needs `geometryShader`.
//! `gpu::Support` asks for them, `gpu::FeatureChain` switches them on. With `vulkanMemoryModel` also switch on `vulkanMemoryModelDeviceScope`:
//! our shaders' atomic operations have device scope.
//!
//! **Targets.** `gpu::Target` is what pipelines draw into, a render pass or dynamic rendering: colours or depths alone, samples, culling, comparison. With a
//! ring a render pass needs one thing: the subpass must depend on itself as `gpu::ring::ring_dependency` says. Control shaders hand points
//! to evaluation shaders through a ring in memory; batches that use it one after another have a barrier between them.
//!
//! Dynamic rendering allows no such barrier: with a cache none is needed, and with a ring set `gpu::SurfaceOptions::barriers` to false; before each batch whose `frame::Batch::waits`
//! is true, end rendering, record `gpu::ring::cmd_ring_barrier` and your attachments' barrier, and begin again with `LOAD`. With a ring
//! that holds the whole model nothing waits, but for the few patches that are over where a driver bounds the vertices of an instance.
//!
//! **Lifetimes.** `gpu::TessellatedSurface` is three things in one, which an engine with more than one instance or frame keeps by themselves:
//! `gpu::Tables` live as long as the topology and are shared by all; a `gpu::Pose` belongs to an instance that deforms, and rigid ones share it; a
//! `gpu::FrameSlot` belongs to a frame in flight, so that what a frame writes waits for no other. A `gpu::Drawing` of the three is drawn. Each has a
//! descriptor set of its own. The places of instances, and the views, are the slot's `gpu::View`s: `cmd_prepare` takes them, and a draw draws
//! any number at once.
//!
//! **Residence.** Where control points live is `gpu::SurfaceOptions::residence`: in the `Ring` control shaders compute them as they go, for a single pass.
//! In the `Cache` of a pose `gpu::Pose::cmd_cache` computes each once, and nothing while nothing moves: then no draw has a barrier, dynamic rendering
//! needs no care, any number of passes and views draw the same points, and every back-end draws every patch. The bits are the same.
//!
//! **Draw lists.** `gpu::TessellatedSurface::draw_list` decides what a frame draws: a [`frame::DrawList`], a plain value that is kept as long as
//! the level stays. All patches have the level of its [`frame::Cut`], unless it is made with [`method::DepthTags`]: a depth for each control
//! vertex, by distance, picture or curvature, or of your own. What the host decides about single patches is brought to the device by
//! `gpu::TessellatedSurface::write_draws`, when nothing submitted uses the slot.
//!
//! **Edits.** A model that is edited is prepared by [`Method::prepare_editable`](method::Method::prepare_editable), and its tables are made by `gpu::Tables::editable`: after
//! `gpu::Tables::edit` the next `cmd_upload` records the words that an edit has changed, and no frame in flight is waited for. See [Edits](manual::edits).
//!
//! **Decisions of the device.** With `gpu::SurfaceOptions::decides` a compute pass (`gpu::FrameSlot::cmd_decide`) decides in each frame and for each view what levels
//! edges have, by their distance or by their pixels, and leaves out patches beyond the picture before their control points are computed: a
//! [`frame::Decision`]. The host has nothing to do a patch, frames in flight do not wait for one another, and a frozen view can decide for another.
//!
//! **Misuse** is refused with [`Error::Misuse`], before anything is recorded or written: levels that are no levels, another mesh's tables,
//! another surface's draw list, pipelines for something else, buffers that shaders cannot see, a device without the features.
//!
//! **Shaders of your own.** The sources are in the crate, `gpu::shaders::source("lib/quadtree.glsl")`. Include `method/quadtree.glsl` and
//! `method/quadtree_regular.glsl` in your stages the way the shells `surface.vert`, `.tesc` and `.tese` do, build pipelines with
//! `gpu::Layout`, and hand them in with `gpu::Pipelines::from_raw`. Sets 0 to 2 are the library's, or three that begin elsewhere (`gpu::OwnLayout`, and the macro `HULLFORM_SET`), and so are all push
//! constants: their one range, of 32 bytes, is `gpu::Layout::push_constant_range`, which shows how to make a layout with further sets.
//!
//! **Skinning and morphing.** Positions are read in one function, `control_vertex` in `glsl/lib/control_vertex.glsl`. Put your own in its
//! place: plans do not depend on positions. Or write deformed positions into `gpu::TessellatedSurface::position_buffer` with a compute
//! shader.

pub mod abi;
#[cfg(feature = "host")]
pub mod conformance;
pub mod error;
pub mod frame;
#[cfg(feature = "vulkan")]
pub mod gpu;
#[cfg(feature = "host")]
pub mod host;
pub mod manual;
pub mod mesh;
pub mod method;
pub mod patch;
pub mod plan;
pub mod subdivision;
pub mod tessellation;

pub use error::{Error, Misuse, Place, Result};
// The crates whose types stand in this one's interface, in the version that it uses.
pub use glam;
#[cfg(feature = "vulkan")]
pub use {ash, gpu_allocator};
