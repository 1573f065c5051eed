//! Pipelines and passes that are made other than they were meant.

use std::ffi::c_void;

use ash::vk;
use ash::vk::Handle;

use crate::chain::below;
use crate::fault::{Fault, is};

/// What the parts of a pipeline point to, changed. Boxed: infos point to it.
#[derive(Default)]
struct Changed {
    tessellation: Option<Box<vk::PipelineTessellationStateCreateInfo<'static>>>,
    origin: Option<Box<vk::PipelineTessellationDomainOriginStateCreateInfo<'static>>>,
    raster: Option<Box<vk::PipelineRasterizationStateCreateInfo<'static>>>,
}

/// # Safety
/// The info's pointers are the application's, or null.
unsafe fn change(info: &mut vk::GraphicsPipelineCreateInfo<'static>) -> Changed {
    let mut changed = Changed::default();
    // SAFETY: this function's contract.
    let (tessellation, raster) = unsafe {
        (
            info.p_tessellation_state.as_ref(),
            info.p_rasterization_state.as_ref(),
        )
    };
    if let Some(own) = tessellation {
        let mut own = Box::new(*own);
        if is(Fault::OriginAbove) {
            let above = vk::TessellationDomainOrigin::UPPER_LEFT;
            let origin = vk::PipelineTessellationDomainOriginStateCreateInfo::default();
            let origin = changed.origin.insert(Box::new(origin.domain_origin(above)));
            own.p_next = (&raw const **origin).cast();
        }
        if is(Fault::PatchesAreLarger) && (2..32).contains(&own.patch_control_points) {
            own.patch_control_points += 1;
        }
        info.p_tessellation_state = &**changed.tessellation.insert(own);
    }
    if let Some(own) = raster {
        let mut own = Box::new(*own);
        if is(Fault::FrontsAreBacks) {
            own.front_face = match own.front_face {
                vk::FrontFace::CLOCKWISE => vk::FrontFace::COUNTER_CLOCKWISE,
                _ => vk::FrontFace::CLOCKWISE,
            };
        }
        if is(Fault::CullsNothing) {
            own.cull_mode = vk::CullModeFlags::NONE;
        }
        info.p_rasterization_state = &**changed.raster.insert(own);
    }
    changed
}

unsafe extern "system" fn create_graphics_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'static>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: the application's arguments; what is changed lives through the call.
    unsafe {
        let mut infos = std::slice::from_raw_parts(infos, count as usize).to_vec();
        let _changed: Vec<Changed> = infos.iter_mut().map(|info| change(info)).collect();
        let name = c"vkCreateGraphicsPipelines";
        let next: vk::PFN_vkCreateGraphicsPipelines = below(device.as_raw(), name);
        next(device, cache, count, infos.as_ptr(), callbacks, made)
    }
}

unsafe extern "system" fn create_render_pass(
    device: vk::Device,
    info: *const vk::RenderPassCreateInfo<'static>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::RenderPass,
) -> vk::Result {
    // SAFETY: the application's arguments; our subpass with views has no more than one chained struct.
    unsafe {
        let mut info = *info;
        let mut views = vk::RenderPassMultiviewCreateInfo::default();
        let masks = [1];
        let chained = info
            .p_next
            .cast::<vk::RenderPassMultiviewCreateInfo>()
            .as_ref();
        let has_views = chained.is_some_and(|own| own.s_type == views.s_type);
        if is(Fault::DrawsFirstView) && has_views {
            views = views.view_masks(&masks);
            info.p_next = (&raw const views).cast();
        }
        let next: vk::PFN_vkCreateRenderPass = below(device.as_raw(), c"vkCreateRenderPass");
        next(device, &info, callbacks, made)
    }
}

/// The layer's own function of this name.
pub fn function(name: &str) -> Option<*const c_void> {
    match name {
        "vkCreateGraphicsPipelines" => Some(create_graphics_pipelines as *const c_void),
        "vkCreateRenderPass" => Some(create_render_pass as *const c_void),
        _ => None,
    }
}
