//! A logical device with one queue and an allocator.

use crate::error::{Error, Result};
use crate::gpu::features::extension::has_extension;
use crate::gpu::{
    Enabled, ExtraFeatures, FeatureChain, Memory, MemoryBlock, MemoryRequest, failed,
};
use crate::host::Instance;
use crate::host::choice::{DeviceInfo, choose, devices};
use crate::host::instance::unavailable;
use crate::host::swapchain::WindowSurface;
use ash::{khr, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::ffi::CStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long [`Device::submit`] waits. Generous: a software device may well draw for a minute.
const PATIENCE: Duration = Duration::from_secs(300);

/// How often a wait that failed is tried again, and how long after. Memory that lacked may be there a moment later.
const TRIES: u32 = 8;
const PAUSE: Duration = Duration::from_millis(25);

/// A Vulkan device, its graphics queue and its memory. Clones share it; it goes with the last of them.
#[derive(Clone)]
pub struct Device(Arc<Shared>);

/// Fields are dropped in this order: memory is freed while the device lives.
struct Shared {
    allocator: Mutex<Allocator>,
    /// Locked while something is submitted: a queue is for one thread at a time.
    queue: Mutex<vk::Queue>,
    info: DeviceInfo,
    extra: ExtraFeatures,
    hung: AtomicBool,
    logical: Logical,
}

struct Logical {
    raw: ash::Device,
    instance: Instance,
}

impl Drop for Logical {
    fn drop(&mut self) {
        // SAFETY: the last owner goes, so nobody submits. Queues are idle: each submission was waited for (one whose end is not known
        // keeps the device alive for good).
        unsafe { self.raw.destroy_device(None) };
    }
}

impl Device {
    /// Opens the device that `selector` means: an index or a part of a name; without one the first suitable discrete GPU,
    /// else integrated, else any.
    ///
    /// # Errors
    /// [`Error::NoDevice`] says what each device lacks.
    pub fn open(instance: &Instance, selector: Option<&str>) -> Result<Device> {
        Device::open_with(instance, selector, ExtraFeatures::default())
    }

    /// As [`Device::open`], with features that nothing here needs.
    ///
    /// # Errors
    /// As [`Device::open`], also when the device lacks one of them.
    pub fn open_with(
        instance: &Instance,
        selector: Option<&str>,
        extra: ExtraFeatures,
    ) -> Result<Device> {
        Device::open_among(instance, devices(instance)?, selector, extra, &[])
    }

    /// As [`Device::open`], of those that can show pictures in a window.
    ///
    /// # Errors
    /// As [`Device::open`].
    pub fn open_for(
        instance: &Instance,
        selector: Option<&str>,
        surface: &WindowSurface,
    ) -> Result<Device> {
        let mut devices = devices(instance)?;
        for device in &mut devices {
            device.missing.extend(surface.missing(device)?);
        }
        let extensions = [khr::swapchain::NAME];
        let extra = ExtraFeatures::default();
        Device::open_among(instance, devices, selector, extra, &extensions)
    }

    fn open_among(
        instance: &Instance,
        devices: Vec<DeviceInfo>,
        selector: Option<&str>,
        extra: ExtraFeatures,
        extensions: &[&'static CStr],
    ) -> Result<Device> {
        let info = choose(&devices, selector)?;
        tracing::info!(device = info.name, driver = info.driver.info, "opened");
        let family = info.support.graphics_family;
        let family = family.expect("a suitable device has a graphics queue");
        let logical = Logical {
            raw: create(instance, &info, family, extra, extensions)?,
            instance: instance.clone(),
        };
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw().clone(),
            device: logical.raw.clone(),
            physical_device: info.physical,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        });
        // SAFETY: the device was created with one queue of this family.
        let queue = unsafe { logical.raw.get_device_queue(family, 0) };
        Ok(Device(Arc::new(Shared {
            allocator: Mutex::new(allocator.map_err(crate::gpu::memory::out_of_memory)?),
            queue: Mutex::new(queue),
            info,
            extra,
            hung: AtomicBool::new(false),
            logical,
        })))
    }

    /// The functions of this device.
    pub fn raw(&self) -> &ash::Device {
        &self.0.logical.raw
    }

    /// The instance it belongs to.
    pub fn instance(&self) -> &Instance {
        &self.0.logical.instance
    }

    /// What it is and can do. All of [`DeviceInfo::support`] is switched on.
    pub fn info(&self) -> &DeviceInfo {
        &self.0.info
    }

    /// The proof of that, for [`Layout::new`](crate::gpu::Layout::new).
    pub fn enabled(&self) -> Enabled {
        let enabled = FeatureChain::new(&self.0.info.support).enabled();
        enabled.expect("only a device that lacks nothing is opened, with this chain")
    }

    /// What it could have been opened with beyond that, see [`Device::open_with`].
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn possible(&self) -> Result<ExtraFeatures> {
        let (instance, info) = (self.instance().raw(), self.info());
        // SAFETY: the device was listed by this live instance, which was made for Vulkan 1.3.
        unsafe { ExtraFeatures::query(instance, info.physical, info.support.api_version) }
    }

    /// What it was opened with beyond that.
    pub fn extra(&self) -> ExtraFeatures {
        self.0.extra
    }

    /// Its limits.
    pub fn limits(&self) -> &vk::PhysicalDeviceLimits {
        &self.0.info.limits
    }

    /// The family of its queue.
    pub fn queue_family(&self) -> u32 {
        let family = self.0.info.support.graphics_family;
        family.expect("a suitable device has a graphics queue")
    }

    /// Its queue, for the caller alone as long as the guard is held.
    pub fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.0.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Its memory, for the caller alone as long as the guard is held.
    pub fn allocator(&self) -> MutexGuard<'_, Allocator> {
        let allocator = self.0.allocator.lock();
        allocator.unwrap_or_else(PoisonError::into_inner)
    }

    /// Its memory, locked for each piece alone: while something large is made of it, others get theirs.
    pub fn memory(&self) -> SharedMemory<'_> {
        SharedMemory(self)
    }

    /// Whether it is the CPU itself.
    pub fn is_software(&self) -> bool {
        self.0.info.kind == vk::PhysicalDeviceType::CPU
    }

    /// Bytes of its memory that are in use, by all that was made from [`allocator`](Device::allocator).
    pub fn allocated_bytes(&self) -> u64 {
        self.allocator().generate_report().total_allocated_bytes
    }

    /// Whether a submission ran out of patience, or it cannot be known whether it has ended. What it used may still be in use and must not be
    /// destroyed.
    pub fn is_hung(&self) -> bool {
        self.0.hung.load(Ordering::Acquire)
    }

    /// Records commands, submits them and waits until they are done, at most five minutes.
    ///
    /// `record` gets a primary command buffer outside of any render pass, so it may reset queries, fill buffers and begin
    /// passes. If it fails, nothing is submitted. Whatever fails, nothing of it runs any more when this returns, unless the device
    /// [is hung](Device::is_hung).
    pub fn submit<T>(&self, record: impl FnOnce(vk::CommandBuffer) -> Result<T>) -> Result<T> {
        self.submit_within(PATIENCE, record)
    }

    /// As [`Device::submit`], with a patience of one's own.
    ///
    /// When it runs out the error is `vkWaitForFences failed: TIMEOUT`, [`Device::is_hung`] turns true, and the device is
    /// never destroyed: destroying what a queue still uses is undefined. The same where no wait succeeds, for lack of memory, say.
    pub fn submit_within<T>(
        &self,
        patience: Duration,
        record: impl FnOnce(vk::CommandBuffer) -> Result<T>,
    ) -> Result<T> {
        let once = OneShot::new(self)?;
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the command buffer is new and ours.
        unsafe { self.raw().begin_command_buffer(once.cmd, &begin) }
            .map_err(failed("vkBeginCommandBuffer"))?;
        let result = record(once.cmd)?;
        // SAFETY: it is recording since the call above.
        unsafe { self.raw().end_command_buffer(once.cmd) }.map_err(failed("vkEndCommandBuffer"))?;
        self.submit_and_wait(once, patience)?;
        Ok(result)
    }

    fn submit_and_wait(&self, once: OneShot<'_>, patience: Duration) -> Result<()> {
        let buffers = [once.cmd];
        let submit = vk::SubmitInfo::default().command_buffers(&buffers);
        let submitted = {
            let queue = self.queue();
            // SAFETY: the queue is locked; the command buffer has been ended and is submitted once; the fence is unsignalled.
            unsafe { self.raw().queue_submit(*queue, &[submit], once.fence) }
        };
        let finished = match submitted {
            Ok(()) => self.wait(once.fence, patience),
            Err(code) => Err(Unfinished {
                error: failed("vkQueueSubmit")(code),
                // For what is pending, a loss counts as success; after any other failure nothing is (Vulkan spec, "Lost Device" and
                // vkQueueSubmit).
                ended: code != vk::Result::ERROR_DEVICE_LOST || self.becomes_idle(),
            }),
        };
        finished.map_err(|unfinished| {
            if !unfinished.ended {
                // May still be in use.
                std::mem::forget(once);
                self.give_up();
            }
            unfinished.error
        })
    }

    /// [Is hung](Self::is_hung) from now on, and stays to the end of the process.
    pub(super) fn give_up(&self) {
        self.0.hung.store(true, Ordering::Release);
        std::mem::forget(self.clone());
    }

    /// Waits for the fence of a submission. A wait that fails says nothing about the submission, so it is tried again.
    pub(super) fn wait(
        &self,
        fence: vk::Fence,
        patience: Duration,
    ) -> std::result::Result<(), Unfinished> {
        let start = Instant::now();
        let wait = || {
            let left = patience.saturating_sub(start.elapsed());
            let nanoseconds = u64::try_from(left.as_nanos()).unwrap_or(u64::MAX);
            // SAFETY: the fence is the caller's.
            unsafe { self.raw().wait_for_fences(&[fence], true, nanoseconds) }
        };
        let mut waited = wait();
        let Err(first) = waited else { return Ok(()) };
        for _ in 0..TRIES {
            let (late, lost) = (vk::Result::TIMEOUT, vk::Result::ERROR_DEVICE_LOST);
            if waited.is_ok() || waited == Err(late) || waited == Err(lost) {
                break;
            }
            std::thread::sleep(PAUSE);
            waited = wait();
        }
        Err(Unfinished {
            error: match first {
                vk::Result::TIMEOUT => Error::Vulkan {
                    call: "vkWaitForFences",
                    result: format!("TIMEOUT after {} s", patience.as_secs_f32()),
                },
                code => failed("vkWaitForFences")(code),
            },
            ended: match waited {
                Ok(()) => true,
                Err(vk::Result::TIMEOUT) => false,
                Err(_) => self.becomes_idle(),
            },
        })
    }

    /// Waits until nothing runs on the device any more; false when even that fails, and nothing is known.
    ///
    /// A lost device comes back from this in finite time too, and counts as idle (Vulkan spec, "Lost Device").
    pub(super) fn becomes_idle(&self) -> bool {
        // The call is for one who has all queues of the device alone.
        let _queue = self.queue();
        // SAFETY: the device is live.
        let idle = unsafe { self.raw().device_wait_idle() };
        matches!(idle, Ok(()) | Err(vk::Result::ERROR_DEVICE_LOST))
    }
}

/// A device's memory, for many threads at once: see [`Device::memory`].
pub struct SharedMemory<'a>(&'a Device);

// SAFETY: as the allocator, which is locked for each call.
unsafe impl Memory for SharedMemory<'_> {
    fn allocate(&mut self, request: &MemoryRequest<'_>) -> Result<MemoryBlock> {
        Memory::allocate(&mut self.0.allocator(), request)
    }

    fn free(&mut self, block: MemoryBlock) {
        Memory::free(&mut self.0.allocator(), block);
    }
}

/// A submission that came to a bad end.
pub(super) struct Unfinished {
    pub(super) error: Error,
    /// Whether nothing of it runs any more.
    pub(super) ended: bool,
}

/// A command buffer for one submission, with a pool and a fence of its own: nothing to share, so nothing to lock.
struct OneShot<'a> {
    device: &'a Device,
    pool: vk::CommandPool,
    cmd: vk::CommandBuffer,
    fence: vk::Fence,
}

impl<'a> OneShot<'a> {
    fn new(device: &'a Device) -> Result<OneShot<'a>> {
        let raw = device.raw();
        let mut once = OneShot {
            device,
            pool: vk::CommandPool::null(),
            cmd: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
        };
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.queue_family())
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is live, here and below; what is made is dropped with `once` if a later step fails.
        once.pool = unsafe { raw.create_command_pool(&pool, None) }
            .map_err(failed("vkCreateCommandPool"))?;
        let buffers = vk::CommandBufferAllocateInfo::default()
            .command_pool(once.pool)
            .command_buffer_count(1);
        // SAFETY: the pool is new and ours.
        once.cmd = unsafe { raw.allocate_command_buffers(&buffers) }
            .map_err(failed("vkAllocateCommandBuffers"))?[0];
        // SAFETY: as above.
        once.fence = unsafe { raw.create_fence(&vk::FenceCreateInfo::default(), None) }
            .map_err(failed("vkCreateFence"))?;
        Ok(once)
    }
}

impl Drop for OneShot<'_> {
    fn drop(&mut self) {
        // SAFETY: made from this device and not in use (one still in use is forgotten instead); null handles are allowed.
        unsafe {
            self.device.raw().destroy_fence(self.fence, None);
            self.device.raw().destroy_command_pool(self.pool, None);
        }
    }
}

fn create(
    instance: &Instance,
    info: &DeviceInfo,
    family: u32,
    extra: ExtraFeatures,
    wanted: &[&'static CStr],
) -> Result<ash::Device> {
    let mut extensions = info.support.extensions();
    extensions.extend(extra.extensions());
    extensions.extend(wanted);
    // VUID-VkDeviceCreateInfo-pProperties-04451: a device that has it insists on it.
    let subset = khr::portability_subset::NAME;
    // SAFETY: the device was listed by this live instance.
    let has_subset = unsafe { has_extension(instance.raw(), info.physical, subset) };
    if has_subset.map_err(unavailable("vkEnumerateDeviceExtensionProperties"))? {
        extensions.push(subset);
    }
    let extensions: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let queues = [vk::DeviceQueueCreateInfo::default()
        .queue_family_index(family)
        .queue_priorities(&[1.0])];
    let create = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(&extensions);
    let mut features = FeatureChain::new(&info.support).with(extra);
    // SAFETY: `choose` returns devices that lack nothing; `create` names the extensions and has no features yet.
    let create = unsafe { features.chain(create) };
    // SAFETY: the device was listed by this live instance; all that `create` points to lives through the call.
    unsafe { instance.raw().create_device(info.physical, &create, None) }
        .map_err(unavailable("vkCreateDevice"))
}
