//! The functions that the layer stands in front of: every one that can fail, makes or destroys something, submits, waits or draws.

use std::ffi::{CStr, c_void};

use ash::vk;
use ash::vk::Handle;

use crate::chain::{self, below};
use crate::state::{self, Draw, WAITS};

type Callbacks<'a> = *const vk::AllocationCallbacks<'a>;

/// Declares functions that only fail or are passed on; `$then` sees what became of those that succeeded.
macro_rules! passed_on {
    ($($name:ident: $kind:ident($first:ident: $owner:ty $(, $argument:ident: $type:ty)*) $then:expr;)*) => {
        $(
            #[allow(non_snake_case)]
            unsafe extern "system" fn $name($first: $owner $(, $argument: $type)*) -> vk::Result {
                // SAFETY: the arguments are the application's, and go to the function that they are meant for.
                unsafe {
                    let name = stringify!($name);
                    let fails = state::with(|state| state.call(name));
                    if let Some(code) = fails && !is_done_all_the_same(name, code) {
                        return code;
                    }
                    let next: vk::$kind = below($first.as_raw(), c_name!($name));
                    let result = next($first $(, $argument)*);
                    if result == vk::Result::SUCCESS {
                        #[allow(clippy::redundant_closure_call)]
                        ($then)();
                    }
                    fails.unwrap_or(result)
                }
            }
        )*

        fn passed_on(name: &str) -> Option<*const c_void> {
            $(
                if name == stringify!($name) {
                    let own: vk::$kind = $name;
                    return Some(own as *const c_void);
                }
            )*
            None
        }
    };
}

macro_rules! c_name {
    ($name:ident) => {
        CStr::from_bytes_with_nul_unchecked(concat!(stringify!($name), "\0").as_bytes())
    };
}

/// Declares what makes and destroys the objects of a kind: all have the same shape.
macro_rules! objects {
    ($($owner:ident $handle:ident by $create:ident: $creates:ident($info:ident), $destroy:ident: $destroys:ident;)*) => {
        $(
            #[allow(non_snake_case)]
            unsafe extern "system" fn $create(
                owner: vk::$owner,
                info: *const vk::$info<'_>,
                callbacks: Callbacks<'_>,
                made: *mut vk::$handle,
            ) -> vk::Result {
                if let Some(code) = state::with(|state| state.call(stringify!($create))) {
                    return code;
                }
                // SAFETY: the arguments are the application's, and go to the function that they are meant for.
                unsafe {
                    let next: vk::$creates = below(owner.as_raw(), c_name!($create));
                    let result = next(owner, info, callbacks, made);
                    if result == vk::Result::SUCCESS {
                        state::with(|state| state.made(stringify!($handle), (*made).as_raw()));
                    }
                    result
                }
            }

            #[allow(non_snake_case)]
            unsafe extern "system" fn $destroy(owner: vk::$owner, object: vk::$handle, callbacks: Callbacks<'_>) {
                state::with(|state| state.destroyed(stringify!($handle), object.as_raw()));
                // SAFETY: as above.
                unsafe {
                    let next: vk::$destroys = below(owner.as_raw(), c_name!($destroy));
                    next(owner, object, callbacks);
                }
            }
        )*

        fn objects(name: &str) -> Option<*const c_void> {
            $(
                if name == stringify!($create) {
                    let own: vk::$creates = $create;
                    return Some(own as *const c_void);
                }
                if name == stringify!($destroy) {
                    let own: vk::$destroys = $destroy;
                    return Some(own as *const c_void);
                }
            )*
            None
        }
    };
}

objects! {
    Instance SurfaceKHR by vkCreateXlibSurfaceKHR: PFN_vkCreateXlibSurfaceKHR(XlibSurfaceCreateInfoKHR),
        vkDestroySurfaceKHR: PFN_vkDestroySurfaceKHR;
    Instance DebugUtilsMessengerEXT by vkCreateDebugUtilsMessengerEXT: PFN_vkCreateDebugUtilsMessengerEXT(DebugUtilsMessengerCreateInfoEXT),
        vkDestroyDebugUtilsMessengerEXT: PFN_vkDestroyDebugUtilsMessengerEXT;
    Device DeviceMemory by vkAllocateMemory: PFN_vkAllocateMemory(MemoryAllocateInfo), vkFreeMemory: PFN_vkFreeMemory;
    Device Buffer by vkCreateBuffer: PFN_vkCreateBuffer(BufferCreateInfo), vkDestroyBuffer: PFN_vkDestroyBuffer;
    Device Image by vkCreateImage: PFN_vkCreateImage(ImageCreateInfo), vkDestroyImage: PFN_vkDestroyImage;
    Device ImageView by vkCreateImageView: PFN_vkCreateImageView(ImageViewCreateInfo), vkDestroyImageView: PFN_vkDestroyImageView;
    Device ShaderModule by vkCreateShaderModule: PFN_vkCreateShaderModule(ShaderModuleCreateInfo),
        vkDestroyShaderModule: PFN_vkDestroyShaderModule;
    Device PipelineCache by vkCreatePipelineCache: PFN_vkCreatePipelineCache(PipelineCacheCreateInfo),
        vkDestroyPipelineCache: PFN_vkDestroyPipelineCache;
    Device PipelineLayout by vkCreatePipelineLayout: PFN_vkCreatePipelineLayout(PipelineLayoutCreateInfo),
        vkDestroyPipelineLayout: PFN_vkDestroyPipelineLayout;
    Device DescriptorSetLayout by vkCreateDescriptorSetLayout: PFN_vkCreateDescriptorSetLayout(DescriptorSetLayoutCreateInfo),
        vkDestroyDescriptorSetLayout: PFN_vkDestroyDescriptorSetLayout;
    Device DescriptorPool by vkCreateDescriptorPool: PFN_vkCreateDescriptorPool(DescriptorPoolCreateInfo),
        vkDestroyDescriptorPool: PFN_vkDestroyDescriptorPool;
    Device RenderPass by vkCreateRenderPass: PFN_vkCreateRenderPass(RenderPassCreateInfo), vkDestroyRenderPass: PFN_vkDestroyRenderPass;
    Device Framebuffer by vkCreateFramebuffer: PFN_vkCreateFramebuffer(FramebufferCreateInfo), vkDestroyFramebuffer: PFN_vkDestroyFramebuffer;
    Device CommandPool by vkCreateCommandPool: PFN_vkCreateCommandPool(CommandPoolCreateInfo), vkDestroyCommandPool: PFN_vkDestroyCommandPool;
    Device Fence by vkCreateFence: PFN_vkCreateFence(FenceCreateInfo), vkDestroyFence: PFN_vkDestroyFence;
    Device Semaphore by vkCreateSemaphore: PFN_vkCreateSemaphore(SemaphoreCreateInfo), vkDestroySemaphore: PFN_vkDestroySemaphore;
    Device Sampler by vkCreateSampler: PFN_vkCreateSampler(SamplerCreateInfo), vkDestroySampler: PFN_vkDestroySampler;
    Device SwapchainKHR by vkCreateSwapchainKHR: PFN_vkCreateSwapchainKHR(SwapchainCreateInfoKHR),
        vkDestroySwapchainKHR: PFN_vkDestroySwapchainKHR;
    Device QueryPool by vkCreateQueryPool: PFN_vkCreateQueryPool(QueryPoolCreateInfo), vkDestroyQueryPool: PFN_vkDestroyQueryPool;
}

/// Whether a call does what it is for although it returns this code: codes of success say more than that it succeeded; what waits and finds the device lost has waited;
/// and what is presented to a window that has changed, or that is no more, is enqueued and waits for its semaphores (Vulkan spec, `vkQueuePresentKHR`).
fn is_done_all_the_same(name: &str, code: vk::Result) -> bool {
    let gone = [
        vk::Result::ERROR_OUT_OF_DATE_KHR,
        vk::Result::ERROR_SURFACE_LOST_KHR,
    ];
    code.as_raw() > 0
        || code == vk::Result::ERROR_DEVICE_LOST && WAITS.contains(&name)
        || name == "vkQueuePresentKHR" && gone.contains(&code)
}

fn nothing() {}

fn idle() {
    state::with(|state| state.idle());
}

passed_on! {
    vkEnumeratePhysicalDevices: PFN_vkEnumeratePhysicalDevices(
        instance: vk::Instance, count: *mut u32, devices: *mut vk::PhysicalDevice) nothing;
    vkEnumerateDeviceExtensionProperties: PFN_vkEnumerateDeviceExtensionProperties(
        device: vk::PhysicalDevice, layer: *const std::ffi::c_char, count: *mut u32, properties: *mut vk::ExtensionProperties) nothing;
    vkMapMemory: PFN_vkMapMemory(
        device: vk::Device, memory: vk::DeviceMemory, offset: u64, size: u64, flags: vk::MemoryMapFlags, data: *mut *mut c_void) nothing;
    vkBindBufferMemory: PFN_vkBindBufferMemory(device: vk::Device, buffer: vk::Buffer, memory: vk::DeviceMemory, offset: u64) nothing;
    vkBindImageMemory: PFN_vkBindImageMemory(device: vk::Device, image: vk::Image, memory: vk::DeviceMemory, offset: u64) nothing;
    vkAllocateDescriptorSets: PFN_vkAllocateDescriptorSets(
        device: vk::Device, info: *const vk::DescriptorSetAllocateInfo<'_>, sets: *mut vk::DescriptorSet) nothing;
    vkAllocateCommandBuffers: PFN_vkAllocateCommandBuffers(
        device: vk::Device, info: *const vk::CommandBufferAllocateInfo<'_>, buffers: *mut vk::CommandBuffer) nothing;
    vkBeginCommandBuffer: PFN_vkBeginCommandBuffer(cmd: vk::CommandBuffer, info: *const vk::CommandBufferBeginInfo<'_>) nothing;
    vkEndCommandBuffer: PFN_vkEndCommandBuffer(cmd: vk::CommandBuffer) nothing;
    vkResetCommandPool: PFN_vkResetCommandPool(device: vk::Device, pool: vk::CommandPool, flags: vk::CommandPoolResetFlags) nothing;
    vkResetFences: PFN_vkResetFences(device: vk::Device, count: u32, fences: *const vk::Fence) nothing;
    vkGetPipelineCacheData: PFN_vkGetPipelineCacheData(
        device: vk::Device, cache: vk::PipelineCache, size: *mut usize, data: *mut c_void) nothing;
    vkGetQueryPoolResults: PFN_vkGetQueryPoolResults(
        device: vk::Device, pool: vk::QueryPool, first: u32, count: u32, size: usize, data: *mut c_void, stride: u64,
        flags: vk::QueryResultFlags) nothing;
    vkQueueSubmit: PFN_vkQueueSubmit(queue: vk::Queue, count: u32, submits: *const vk::SubmitInfo<'_>, fence: vk::Fence)
        || state::with(|state| state.submitted());
    vkQueueWaitIdle: PFN_vkQueueWaitIdle(queue: vk::Queue) idle;
    vkDeviceWaitIdle: PFN_vkDeviceWaitIdle(device: vk::Device) idle;
    vkWaitForFences: PFN_vkWaitForFences(device: vk::Device, count: u32, fences: *const vk::Fence, all: u32, timeout: u64) idle;
    vkGetFenceStatus: PFN_vkGetFenceStatus(device: vk::Device, fence: vk::Fence) idle;
    vkFreeDescriptorSets: PFN_vkFreeDescriptorSets(
        device: vk::Device, pool: vk::DescriptorPool, count: u32, sets: *const vk::DescriptorSet) nothing;
    vkFlushMappedMemoryRanges: PFN_vkFlushMappedMemoryRanges(
        device: vk::Device, count: u32, ranges: *const vk::MappedMemoryRange<'_>) nothing;
    vkGetSwapchainImagesKHR: PFN_vkGetSwapchainImagesKHR(
        device: vk::Device, swapchain: vk::SwapchainKHR, count: *mut u32, images: *mut vk::Image) nothing;
    vkAcquireNextImageKHR: PFN_vkAcquireNextImageKHR(
        device: vk::Device, swapchain: vk::SwapchainKHR, timeout: u64, semaphore: vk::Semaphore, fence: vk::Fence, number: *mut u32) nothing;
    vkQueuePresentKHR: PFN_vkQueuePresentKHR(queue: vk::Queue, info: *const vk::PresentInfoKHR<'_>) nothing;
    vkGetPhysicalDeviceSurfaceSupportKHR: PFN_vkGetPhysicalDeviceSurfaceSupportKHR(
        device: vk::PhysicalDevice, family: u32, surface: vk::SurfaceKHR, supported: *mut u32) nothing;
    vkGetPhysicalDeviceSurfaceCapabilitiesKHR: PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR(
        device: vk::PhysicalDevice, surface: vk::SurfaceKHR, able: *mut vk::SurfaceCapabilitiesKHR) nothing;
    vkGetPhysicalDeviceSurfaceFormatsKHR: PFN_vkGetPhysicalDeviceSurfaceFormatsKHR(
        device: vk::PhysicalDevice, surface: vk::SurfaceKHR, count: *mut u32, formats: *mut vk::SurfaceFormatKHR) || encode(formats, count);
    vkGetPhysicalDeviceSurfacePresentModesKHR: PFN_vkGetPhysicalDeviceSurfacePresentModesKHR(
        device: vk::PhysicalDevice, surface: vk::SurfaceKHR, count: *mut u32, modes: *mut vk::PresentModeKHR) nothing;
    vkCreateGraphicsPipelines: PFN_vkCreateGraphicsPipelines(
        device: vk::Device, cache: vk::PipelineCache, count: u32, infos: *const vk::GraphicsPipelineCreateInfo<'_>,
        callbacks: Callbacks<'_>, made: *mut vk::Pipeline) || pipelines_made(made, count);
    vkCreateComputePipelines: PFN_vkCreateComputePipelines(
        device: vk::Device, cache: vk::PipelineCache, count: u32, infos: *const vk::ComputePipelineCreateInfo<'_>,
        callbacks: Callbacks<'_>, made: *mut vk::Pipeline) || pipelines_made(made, count);
}

/// # Safety
/// So many formats are there, unless it is null: then they are counted.
unsafe fn encode(formats: *mut vk::SurfaceFormatKHR, count: *mut u32) {
    if formats.is_null() || !state::with(|state| state.encodes()) {
        return;
    }
    // SAFETY: this function's contract.
    for own in unsafe { std::slice::from_raw_parts_mut(formats, *count as usize) } {
        own.format = match own.format {
            vk::Format::B8G8R8A8_UNORM => vk::Format::B8G8R8A8_SRGB,
            vk::Format::R8G8B8A8_UNORM => vk::Format::R8G8B8A8_SRGB,
            other => other,
        };
    }
}

/// # Safety
/// So many pipelines were made there.
unsafe fn pipelines_made(made: *mut vk::Pipeline, count: u32) {
    // SAFETY: this function's contract.
    let made = unsafe { std::slice::from_raw_parts(made, count as usize) };
    state::with(|state| {
        made.iter()
            .for_each(|pipeline| state.made("Pipeline", pipeline.as_raw()))
    });
}

#[allow(non_snake_case)]
unsafe extern "system" fn vkDestroyPipeline(
    device: vk::Device,
    pipeline: vk::Pipeline,
    callbacks: Callbacks<'_>,
) {
    state::with(|state| state.destroyed("Pipeline", pipeline.as_raw()));
    // SAFETY: the arguments are the application's, here and below.
    unsafe {
        let next: vk::PFN_vkDestroyPipeline = below(device.as_raw(), c"vkDestroyPipeline");
        next(device, pipeline, callbacks);
    }
}

/// The vertices and instances of a draw that are left of it.
fn left(vertices: u32, instances: u32) -> (u32, u32) {
    match state::with(|state| state.draw()) {
        Draw::Whole => (vertices, instances),
        Draw::Nothing => (0, 0),
        Draw::Half if instances > 1 => (vertices, instances / 2),
        Draw::Half => (vertices / 2, instances),
    }
}

/// Declares draws; `$left` tells what of their counts is left.
macro_rules! draws {
    ($($name:ident: $kind:ident($($argument:ident: $type:ty),*) $counts:pat = $left:expr;)*) => {
        $(
            #[allow(non_snake_case)]
            unsafe extern "system" fn $name(cmd: vk::CommandBuffer $(, $argument: $type)*) {
                let $counts = $left;
                // SAFETY: as above; a draw of nothing is allowed.
                unsafe {
                    let next: vk::$kind = below(cmd.as_raw(), c_name!($name));
                    next(cmd $(, $argument)*);
                }
            }
        )*

        fn draws(name: &str) -> Option<*const c_void> {
            $(
                if name == stringify!($name) {
                    let own: vk::$kind = $name;
                    return Some(own as *const c_void);
                }
            )*
            None
        }
    };
}

draws! {
    vkCmdDraw: PFN_vkCmdDraw(vertices: u32, instances: u32, vertex: u32, instance: u32)
        (vertices, instances) = left(vertices, instances);
    vkCmdDrawIndexed: PFN_vkCmdDrawIndexed(indices: u32, instances: u32, index: u32, vertex: i32, instance: u32)
        (indices, instances) = left(indices, instances);
    vkCmdDrawIndirect: PFN_vkCmdDrawIndirect(buffer: vk::Buffer, offset: u64, draws: u32, stride: u32)
        (draws, _) = left(draws, 1);
    vkCmdDrawIndexedIndirect: PFN_vkCmdDrawIndexedIndirect(buffer: vk::Buffer, offset: u64, draws: u32, stride: u32)
        (draws, _) = left(draws, 1);
}

/// What is asked for below an instance.
pub const OF_INSTANCES: [&str; 12] = [
    "vkDestroyInstance",
    "vkCreateDevice",
    "vkEnumeratePhysicalDevices",
    "vkEnumerateDeviceExtensionProperties",
    "vkCreateDebugUtilsMessengerEXT",
    "vkDestroyDebugUtilsMessengerEXT",
    "vkCreateXlibSurfaceKHR",
    "vkDestroySurfaceKHR",
    "vkGetPhysicalDeviceSurfaceSupportKHR",
    "vkGetPhysicalDeviceSurfaceCapabilitiesKHR",
    "vkGetPhysicalDeviceSurfaceFormatsKHR",
    "vkGetPhysicalDeviceSurfacePresentModesKHR",
];

/// The layer's own function of this name.
pub fn function(name: &str) -> Option<*const c_void> {
    let destroy_pipeline: vk::PFN_vkDestroyPipeline = vkDestroyPipeline;
    let create_device: vk::PFN_vkCreateDevice = chain::create_device;
    let destroy_device: vk::PFN_vkDestroyDevice = chain::destroy_device;
    let destroy_instance: vk::PFN_vkDestroyInstance = chain::destroy_instance;
    Some(match name {
        "vkDestroyPipeline" => destroy_pipeline as *const c_void,
        "vkCreateDevice" => create_device as *const c_void,
        "vkDestroyDevice" => destroy_device as *const c_void,
        "vkDestroyInstance" => destroy_instance as *const c_void,
        _ => {
            return objects(name)
                .or_else(|| passed_on(name))
                .or_else(|| draws(name));
        }
    })
}

/// Functions that return nothing, make nothing, destroy nothing and draw nothing. Commands are such, those apart that a layer must see.
pub fn cannot_fail(name: &str) -> bool {
    const OTHERS: [&str; 19] = [
        "vkFreeCommandBuffers",
        "vkGetDeviceQueue",
        "vkGetBufferMemoryRequirements",
        "vkGetImageMemoryRequirements",
        "vkUpdateDescriptorSets",
        "vkUnmapMemory",
        "vkGetPhysicalDeviceProperties",
        "vkGetPhysicalDeviceProperties2",
        "vkGetPhysicalDeviceProperties2KHR",
        "vkGetPhysicalDeviceFeatures",
        "vkGetPhysicalDeviceFeatures2",
        "vkGetPhysicalDeviceFeatures2KHR",
        "vkGetPhysicalDeviceQueueFamilyProperties",
        "vkGetPhysicalDeviceQueueFamilyProperties2",
        "vkGetPhysicalDeviceMemoryProperties",
        "vkGetPhysicalDeviceMemoryProperties2",
        "vkGetPhysicalDeviceMemoryProperties2KHR",
        "vkGetPhysicalDeviceFormatProperties",
        "vkGetPhysicalDeviceFormatProperties2",
    ];
    // None of the core returns anything; draws that are not among the layer's own may not slip past it.
    name.starts_with("vkCmd") && !name.starts_with("vkCmdDraw") || OTHERS.contains(&name)
}
