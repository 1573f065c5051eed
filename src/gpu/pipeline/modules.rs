//! Which modules pipelines are made of, and what of them.

use std::borrow::Cow;

use ash::vk;

use crate::error::Result;
use crate::frame::Residence;
use crate::gpu::shaders::{Modules, with_invocations, with_outputs};
use crate::gpu::target::{Fill, PipelineOptions};
use crate::method::Pass;

/// The file that evaluates a pass's patches.
fn shader(pass: &Pass, residence: Residence) -> &'static str {
    match residence {
        Residence::Ring => pass.shader,
        Residence::Cache => pass.cached.unwrap_or(pass.shader),
    }
}

/// The modules of ours that a pass's pipeline has, by name.
pub(super) fn names(
    pass: &Pass,
    options: &PipelineOptions<'_>,
) -> Vec<(vk::ShaderStageFlags, String)> {
    use vk::ShaderStageFlags as Stage;
    let method = shader(pass, options.residence);
    let views = match options.target.view_mask {
        0 => "",
        _ => "multiview.",
    };
    let tangents = if options.tangents() { "tangents." } else { "" };
    let named = |&(stage, name): &(Stage, &str)| {
        let name = name
            .replace("{method}", method)
            .replace("{views}", views)
            .replace("{spacing}", options.spacing.name())
            .replace("{tangents}", tangents);
        (stage, name)
    };
    let mut stages: Vec<_> = options
        .backend
        .on_device()
        .stages
        .iter()
        .map(named)
        .collect();
    // Rasterisation that is discarded has no fragment shader (VUID-VkGraphicsPipelineCreateInfo-pStages-06894 and neighbours); depths need none.
    let shaded = matches!(options.fill, Fill::Solid(_) | Fill::Lines);
    if shaded && options.fragment.is_none() {
        stages.push((Stage::FRAGMENT, format!("{method}.frag")));
    }
    stages
}

/// A stage and the words of its module.
pub(super) type Module<'m> = (vk::ShaderStageFlags, Cow<'m, [u32]>);

/// The modules that a pass's pipeline has. The one that evaluates hands on what is read of it, and nothing else; one that shares its work among invocations has so
/// many.
pub(super) fn modules<'m>(
    pass: &Pass,
    options: &PipelineOptions<'_>,
    invocations: u32,
    from: &'m dyn Modules,
) -> Result<Vec<Module<'m>>> {
    let evaluates = options.backend.on_device().stages.last();
    let found = names(pass, options).into_iter().map(|(stage, name)| {
        let mut words = from.module(&name)?;
        if evaluates.is_some_and(|&(evaluating, _)| evaluating == stage)
            && let Cow::Owned(fewer) = with_outputs(&words, |output| options.reads(output))
        {
            words = Cow::Owned(fewer);
        }
        if stage == vk::ShaderStageFlags::TESSELLATION_CONTROL
            && let Cow::Owned(told) = with_invocations(&words, invocations)
        {
            words = Cow::Owned(told);
        }
        Ok((stage, words))
    });
    found.collect()
}
