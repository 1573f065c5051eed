//! Instance, device, queue and memory, and a holder of whatever is made with them: every engine has these.

use std::cell::{RefCell, RefMut};
use std::error::Error;
use std::ops::{Deref, DerefMut};

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use hullform::gpu::{
    Buffer, Driver, Enabled, FeatureChain, Support, Workaround, shaders, workarounds,
};

/// For `map_err`: which call failed, and how.
pub fn failed(call: &'static str) -> impl Fn(vk::Result) -> String {
    move |code| format!("{call} failed: {code:?}")
}

/// A device of the engine's own.
pub struct Gpu {
    pub device: ash::Device,
    pub family: u32,
    pub enabled: Enabled,
    pub workarounds: Vec<&'static Workaround>,
    pub name: String,
    /// Goes before the device.
    allocator: RefCell<Option<Allocator>>,
    instance: ash::Instance,
    _entry: ash::Entry,
}

impl Gpu {
    /// The first device that lacks nothing of what hullform and the engine need.
    pub fn new() -> Result<Gpu, Box<dyn Error>> {
        // SAFETY: the loader lives in what is made, and outlives everything that it loads.
        let entry = unsafe { ash::Entry::load()? };
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the infos live through the call.
        let instance = unsafe { entry.create_instance(&info, None) };
        let instance = instance.map_err(failed("vkCreateInstance"))?;
        match open(&instance) {
            Ok((physical, support, device, enabled)) => {
                let allocator = Allocator::new(&AllocatorCreateDesc {
                    instance: instance.clone(),
                    device: device.clone(),
                    physical_device: physical,
                    debug_settings: Default::default(),
                    buffer_device_address: false,
                    allocation_sizes: Default::default(),
                });
                // SAFETY: `physical` belongs to the live instance, which was made for Vulkan 1.3.
                let driver = unsafe { Driver::query(&instance, physical) };
                let gpu = Gpu {
                    device,
                    family: support.graphics_family.unwrap_or(0),
                    enabled,
                    workarounds: workarounds(&driver),
                    name: driver.info.clone(),
                    allocator: RefCell::new(None),
                    instance,
                    _entry: entry,
                };
                gpu.allocator.replace(Some(allocator?));
                Ok(gpu)
            }
            Err(error) => {
                // SAFETY: nothing of it is left.
                unsafe { instance.destroy_instance(None) };
                Err(error)
            }
        }
    }

    /// The memory.
    pub fn allocator(&self) -> RefMut<'_, Allocator> {
        RefMut::map(self.allocator.borrow_mut(), |allocator| {
            allocator.as_mut().expect("there until the device goes")
        })
    }

    /// Holds what was made with this device.
    pub fn hold<T>(&self, made: T, destroy: fn(&Gpu, T)) -> Held<'_, T> {
        Held {
            gpu: self,
            made: Some(made),
            destroy,
        }
    }

    /// A buffer.
    pub fn buffer(
        &self,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Held<'_, Buffer>, Box<dyn Error>> {
        let allocator = &mut self.allocator();
        // SAFETY: device and allocator belong together; the usages of this engine need no feature.
        let made = unsafe { Buffer::new(&self.device, allocator, name, size, usage, location) };
        Ok(self.hold(made?, |gpu, buffer| {
            // SAFETY: nothing is in use when what is held goes: see `Idle`. The same holds for all of them.
            unsafe { buffer.destroy(&gpu.device, &mut gpu.allocator()) };
        }))
    }

    /// One of the engine's own shader modules.
    pub fn module(&self, name: &str) -> Result<Held<'_, vk::ShaderModule>, Box<dyn Error>> {
        let words = shaders::spirv(name).ok_or("the engine's shaders come with it")?;
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words are a valid module.
        let module = unsafe { self.device.create_shader_module(&info, None) };
        let module = module.map_err(failed("vkCreateShaderModule"))?;
        Ok(self.hold(module, |gpu, module| {
            // SAFETY: see `buffer`.
            unsafe { gpu.device.destroy_shader_module(module, None) };
        }))
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // Memory goes before the device.
        self.allocator.replace(None);
        // SAFETY: all that was made with them is gone.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// Something that was made with a device, and is destroyed at the end of its scope.
pub struct Held<'g, T> {
    gpu: &'g Gpu,
    made: Option<T>,
    destroy: fn(&Gpu, T),
}

impl<T> Deref for Held<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.made.as_ref().expect("there until it is dropped")
    }
}

impl<T> DerefMut for Held<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        self.made.as_mut().expect("there until it is dropped")
    }
}

impl<T> Drop for Held<'_, T> {
    fn drop(&mut self) {
        if let Some(made) = self.made.take() {
            (self.destroy)(self.gpu, made);
        }
    }
}

type Opened = (vk::PhysicalDevice, Support, ash::Device, Enabled);

fn open(instance: &ash::Instance) -> Result<Opened, Box<dyn Error>> {
    // SAFETY: the instance is live, here and below.
    let all = unsafe { instance.enumerate_physical_devices() };
    for physical in all.map_err(failed("vkEnumeratePhysicalDevices"))? {
        // SAFETY: `physical` belongs to the instance, which was made for Vulkan 1.3.
        let support = unsafe { Support::query(instance, physical) };
        // The engine itself renders dynamically.
        if !support.missing().is_empty() || !support.optional.dynamic_rendering {
            continue;
        }
        let family = support.graphics_family.unwrap_or(0);
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(family)
            .queue_priorities(&[1.0])];
        let extensions: Vec<_> = support.extensions().iter().map(|e| e.as_ptr()).collect();
        let mut features = FeatureChain::new(&support);
        let enabled = features.enabled()?;
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions);
        // SAFETY: nothing is missing; the extensions are named; no other feature struct is chained.
        let info = unsafe { features.chain(info) };
        // SAFETY: the info is complete.
        let device = unsafe { instance.create_device(physical, &info, None) };
        let device = device.map_err(failed("vkCreateDevice"))?;
        return Ok((physical, support, device, enabled));
    }
    Err("no device has what is needed".into())
}
