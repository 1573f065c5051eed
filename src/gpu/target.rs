//! What pipelines are made for: attachments, states, and what becomes of the triangles.

use ash::vk;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Backend, Residence};
use crate::gpu::Enabled;
use crate::tessellation::Spacing;

/// Where pixels go. Classic render passes and dynamic rendering are equals.
#[derive(Clone, Copy, Debug)]
pub enum Attachments<'a> {
    /// A subpass of a render pass. For what uses the scratch ring in several batches it depends on itself as
    /// [`ring_dependency`](super::ring::ring_dependency) says.
    RenderPass {
        /// The pass; any compatible one will do for drawing.
        render_pass: vk::RenderPass,
        /// Which of its subpasses.
        subpass: u32,
        /// How many colour attachments that has.
        colours: u32,
    },
    /// Dynamic rendering, by the formats of the attachments. Needs the feature `dynamicRendering`, which
    /// [`Enabled::with_dynamic_rendering`] shows.
    Dynamic {
        /// Of the colours; none where depths alone count.
        colours: &'a [vk::Format],
        /// Of depth, `UNDEFINED` for none.
        depth: vk::Format,
        /// Of the stencil, `UNDEFINED` for none; that of depth, where an attachment has both.
        stencil: vk::Format,
    },
}

impl Attachments<'_> {
    /// How many colours there are.
    pub(super) fn colours(&self) -> usize {
        match *self {
            Attachments::RenderPass { colours, .. } => colours as usize,
            Attachments::Dynamic { colours, .. } => colours.len(),
        }
    }
}

/// How depths are moved, for shadow maps: by so many of the least differences that they can have, and so many times their slope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthBias {
    /// In least differences.
    pub constant: f32,
    /// In slopes.
    pub slope: f32,
}

/// What pipelines draw into, and how.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// Where pixels go.
    pub attachments: Attachments<'a>,
    /// Multiview: the view mask of the subpass or of the rendering; 0 without. [`Backend::Tessellator`] only, and with the features that
    /// [`Enabled::with_multiview`] shows. An instance then has a view for each bit up to the highest, in a row.
    pub view_mask: u32,
    /// Samples a pixel.
    pub samples: vk::SampleCountFlags,
    /// Which triangles are left out. The front of a surface is where its faces are counter-clockwise, whoever cuts them.
    pub cull: vk::CullModeFlags,
    /// How depths are compared; what passes is written, but after `EQUAL`, which leaves depths as they are. `LESS_OR_EQUAL` for pictures as they come.
    /// After a pre-pass `EQUAL`, which is exact: our shaders' positions are `invariant`, so all pipelines of one backend and spacing have the
    /// same depths. For reversed depths `GREATER_OR_EQUAL`.
    pub compare: vk::CompareOp,
    /// How depths are moved.
    pub bias: DepthBias,
    /// How wide the lines of [`Fill::Lines`] are, in pixels. Above 1 within the device's `lineWidthRange`, and with the feature `wideLines`. Few devices
    /// draw lines that are thinner than a pixel: below 1 they are a pixel wide and have so much less of their colour, by blending, of which
    /// attachments must be capable.
    pub line_width: f32,
}

impl<'a> Target<'a> {
    /// One view, one sample, all triangles, the nearest in front, depths as they are.
    pub fn new(attachments: Attachments<'a>) -> Target<'a> {
        Target {
            attachments,
            view_mask: 0,
            samples: vk::SampleCountFlags::TYPE_1,
            cull: vk::CullModeFlags::NONE,
            compare: vk::CompareOp::LESS_OR_EQUAL,
            bias: DepthBias::default(),
            line_width: 1.0,
        }
    }

    /// The same for subpass 0 of a render pass with one colour.
    pub fn render_pass(render_pass: vk::RenderPass) -> Target<'static> {
        Target::new(Attachments::RenderPass {
            render_pass,
            subpass: 0,
            colours: 1,
        })
    }

    /// Whether greater depths are nearer.
    pub(super) fn is_reversed(&self) -> bool {
        let reversed = [vk::CompareOp::GREATER, vk::CompareOp::GREATER_OR_EQUAL];
        reversed.contains(&self.compare)
    }

    /// How much of their colour lines have. The edge between two triangles is drawn by both: what shines through is what shines through twice.
    pub(super) fn line_share(&self) -> f32 {
        1.0 - (1.0 - self.line_width.clamp(0.0, 1.0)).sqrt()
    }

    /// How many views an instance has.
    pub(super) fn eyes(&self) -> u32 {
        (32 - self.view_mask.leading_zeros()).max(1)
    }
}

/// What the colours of our own fragment shader mean. A constant of the pipeline: fragments do not pay for what others are shaded by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// A lit surface.
    #[default]
    Lit,
    /// The normal's direction.
    Normal,
    /// A colour for each patch.
    Patch,
    /// The kind of node that a point was evaluated in.
    Node,
    /// The valences of the face's vertices.
    Valence,
    /// The tess levels of patches and their edges.
    Level,
    /// Squares of texture coordinates, eight a unit.
    Checker,
    /// How deep in the quadtree a point was evaluated.
    Depth,
    /// The height of the displacement.
    Height,
}

impl Shading {
    fn code(self) -> u32 {
        match self {
            Shading::Lit => abi::SHADING_LIT,
            Shading::Normal => abi::SHADING_NORMAL,
            Shading::Patch => abi::SHADING_PATCH,
            Shading::Node => abi::SHADING_NODE,
            Shading::Valence => abi::SHADING_VALENCE,
            Shading::Level => abi::SHADING_LEVEL,
            Shading::Checker => abi::SHADING_CHECKER,
            Shading::Depth => abi::SHADING_DEPTH,
            Shading::Height => abi::SHADING_HEIGHT,
        }
    }
}

/// What becomes of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// They are filled.
    Solid(Shading),
    /// Their edges are drawn in one dark colour, a little in front of the filled ones. Needs the feature `fillModeNonSolid`.
    Lines,
    /// Their depths alone count: there is no colour, and no fragment shader but the engine's own. For pre-passes and shadow maps.
    Depth,
    /// Nothing: only what is captured counts.
    Discard,
}

impl Fill {
    /// The constant of our fragment shader.
    pub(super) fn shading(self) -> u32 {
        match self {
            Fill::Solid(shading) => shading.code(),
            Fill::Lines | Fill::Depth | Fill::Discard => abi::SHADING_LINES,
        }
    }
}

/// A fragment shader of the engine's own, in the place of ours: `main` of a module whose inputs are those of `glsl/surface.frag`, or some of them.
#[derive(Clone, Copy, Debug)]
pub struct Fragment<'a> {
    /// The module; it may go when the pipelines are made.
    pub module: vk::ShaderModule,
    /// Its constants.
    pub constants: Option<&'a vk::SpecializationInfo<'a>>,
    /// Whether it gets tangents: dP/du at location 5 and dP/dv at location 6, in local units, by the (u, v) of the ptex face. Otherwise these two are
    /// undefined, and cost nothing. See the manual, *Shaders*.
    pub tangents: bool,
}

/// A pipeline layout of the engine's own: three sets in a row and the push constants are [`Layout`](super::Layout)'s, all others the engine's. It lives
/// as long as the pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnLayout {
    /// The layout.
    pub raw: vk::PipelineLayout,
    /// The number of the first of the three: 0 where the engine's begin with 3, 1 where it keeps set 0 for what is the same in all its draws. The
    /// engine's own shaders are compiled with the macro `HULLFORM_SET` for it; ours are moved when pipelines are made.
    pub first_set: u32,
}

/// What pipelines are made for.
#[derive(Clone, Copy, Debug)]
pub struct PipelineOptions<'a> {
    /// What they draw into.
    pub target: Target<'a>,
    /// Who cuts patches.
    pub backend: Backend,
    /// Where control points live.
    pub residence: Residence,
    /// The spacing of the cuts that are drawn.
    pub spacing: Spacing,
    /// What becomes of the triangles.
    pub fill: Fill,
    /// The engine's own fragment shader; None for ours.
    pub fragment: Option<Fragment<'a>>,
    /// Whether they draw lists of levels above 64 too, whose patches are [cut into pieces](crate::frame::SurfaceOptions::greatest_level).
    pub sub_patches: bool,
    /// The engine's own layout, where it has further sets; None for [`Layout::pipeline`](super::Layout::pipeline).
    pub layout: Option<OwnLayout>,
}

impl PipelineOptions<'_> {
    /// Whether tangents are asked for.
    pub(super) fn tangents(&self) -> bool {
        self.fragment.is_some_and(|own| own.tangents)
    }

    /// Whether a fragment shader reads what `glsl/lib/vertex.glsl` hands on at a location: tangents at 5 and 6. Where nothing is drawn all is handed on
    /// that would be of a picture: so what is measured there is a picture's work.
    pub(super) fn reads(&self, location: u32) -> bool {
        match location {
            5 | 6 => self.tangents(),
            _ => self.fill != Fill::Depth || self.fragment.is_some(),
        }
    }

    /// Whether a device can draw so.
    ///
    /// # Errors
    /// [`Misuse::Features`] for what it was created without; [`Misuse::MultiviewBackend`].
    pub(super) fn check(&self, enabled: &Enabled) -> Result<()> {
        let (lines, geometry) = (
            self.fill == Fill::Lines,
            self.backend.on_device().geometry_shader,
        );
        let attachments = self.target.attachments;
        let dynamic = matches!(attachments, Attachments::Dynamic { .. });
        let multiview = self.target.view_mask != 0;
        let wide = lines && self.target.line_width > 1.0;
        Enabled::require(lines, enabled.fill_mode_non_solid, "fillModeNonSolid")?;
        Enabled::require(wide, enabled.wide_lines, "wideLines")?;
        Enabled::require(geometry, enabled.geometry_shader, "geometryShader")?;
        Enabled::require(dynamic, enabled.dynamic_rendering, "dynamicRendering")?;
        Enabled::require(multiview, enabled.multiview, "multiviewTessellationShader")?;
        if multiview && !self.backend.takes_multiview() {
            let backend = self.backend.name();
            return Err(Error::Misuse(Misuse::MultiviewBackend { backend }));
        }
        Ok(())
    }
}
