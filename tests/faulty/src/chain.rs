//! Between the loader and what comes next (the loader's `LoaderLayerInterface.md`).

use std::collections::HashMap;
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Mutex, PoisonError};

use ash::vk;
use ash::vk::Handle;

use crate::{commands, modules, pipelines};

/// `VkNegotiateLayerInterface`.
#[repr(C)]
pub struct NegotiateLayerInterface {
    kind: i32,
    next: *mut c_void,
    version: u32,
    get_instance_proc_addr: Option<vk::PFN_vkGetInstanceProcAddr>,
    get_device_proc_addr: Option<vk::PFN_vkGetDeviceProcAddr>,
    get_physical_device_proc_addr: *const c_void,
}

/// `VkLayerInstanceCreateInfo` and `VkLayerDeviceCreateInfo`: they begin alike.
#[repr(C)]
struct LayerCreateInfo {
    kind: vk::StructureType,
    next: *const c_void,
    /// 0: there is a link; other numbers mean other contents.
    function: u32,
    link: *mut LayerLink,
}

/// `VkLayerInstanceLink` and `VkLayerDeviceLink`. The last member is another function of instances, and unused there.
#[repr(C)]
struct LayerLink {
    next: *mut LayerLink,
    get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    get_device_proc_addr: vk::PFN_vkGetDeviceProcAddr,
}

/// Who answers below an instance or a device, by the loader's key: the first pointer in the object, which is also that of their children.
static INSTANCES: Mutex<Option<HashMap<usize, (u64, vk::PFN_vkGetInstanceProcAddr)>>> =
    Mutex::new(None);
static DEVICES: Mutex<Option<HashMap<usize, (u64, vk::PFN_vkGetDeviceProcAddr)>>> =
    Mutex::new(None);

fn with<V, T>(
    all: &Mutex<Option<HashMap<usize, V>>>,
    use_it: impl FnOnce(&mut HashMap<usize, V>) -> T,
) -> T {
    let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
    use_it(all.get_or_insert_default())
}

/// # Safety
/// `handle` is that of a live dispatchable object.
unsafe fn key(handle: u64) -> usize {
    // SAFETY: such objects begin with the loader's pointer (LoaderLayerInterface.md, "Dispatchable Objects").
    unsafe { *(handle as *const usize) }
}

/// The function of this name below the layer.
///
/// # Safety
/// `handle` is that of a live device, queue or command buffer, and `F` the type of the function.
pub unsafe fn below<F: Copy>(handle: u64, name: &CStr) -> F {
    const { assert!(size_of::<F>() == size_of::<vk::PFN_vkVoidFunction>()) };
    // SAFETY: this function's contract.
    let key = unsafe { key(handle) };
    let (device, get) = with(&DEVICES, |all| all[&key]);
    // SAFETY: the device lives as long as its children.
    let found = unsafe { get(vk::Device::from_raw(device), name.as_ptr()) };
    assert!(
        found.is_some(),
        "{name:?} is asked for only where it was above"
    );
    // SAFETY: `F` is the function's own type.
    unsafe { std::mem::transmute_copy(&found) }
}

/// # Safety
/// Called by the loader with its struct.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: this function's contract.
    let interface = unsafe { &mut *interface };
    interface.version = interface.version.min(2);
    interface.get_instance_proc_addr = Some(get_instance_proc_addr);
    interface.get_device_proc_addr = Some(get_device_proc_addr);
    interface.get_physical_device_proc_addr = std::ptr::null();
    vk::Result::SUCCESS
}

fn pointer(function: *const c_void) -> vk::PFN_vkVoidFunction {
    // SAFETY: of a function, whose type the caller of Vulkan knows by its name.
    unsafe { std::mem::transmute::<*const c_void, vk::PFN_vkVoidFunction>(function) }
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the loader passes a C string.
    let name = unsafe { CStr::from_ptr(name) };
    match name.to_bytes() {
        b"vkGetInstanceProcAddr" => return pointer(get_instance_proc_addr as *const c_void),
        b"vkGetDeviceProcAddr" => return pointer(get_device_proc_addr as *const c_void),
        b"vkCreateInstance" => return pointer(create_instance as *const c_void),
        b"vkCreateDevice" => return pointer(create_device as *const c_void),
        _ if instance.is_null() => return None,
        _ => {}
    }
    // SAFETY: a live instance.
    let key = unsafe { key(instance.as_raw()) };
    let (_, get) = with(&INSTANCES, |all| all.get(&key).copied())?;
    // SAFETY: as above.
    unsafe { get(instance, name.as_ptr()) }
}

unsafe extern "system" fn get_device_proc_addr(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the loader passes a C string.
    let name = unsafe { CStr::from_ptr(name) };
    if name == c"vkGetDeviceProcAddr" {
        return pointer(get_device_proc_addr as *const c_void);
    }
    // SAFETY: a live device.
    let key = unsafe { key(device.as_raw()) };
    let (_, get) = with(&DEVICES, |all| all.get(&key).copied())?;
    // SAFETY: as above. What the driver lacks nobody has.
    let next = unsafe { get(device, name.as_ptr()) }?;
    let plain = name.to_str().ok()?;
    let own = commands::function(plain)
        .or_else(|| pipelines::function(plain))
        .or_else(|| modules::function(plain));
    own.map_or(Some(next), pointer)
}

/// The link to the next layer, and moves it on for that one.
///
/// # Safety
/// `next` is the chain of an info that the loader passes to layers.
unsafe fn link(mut next: *const c_void, kind: vk::StructureType) -> &'static LayerLink {
    loop {
        assert!(!next.is_null(), "the loader links its layers");
        // SAFETY: this function's contract: each struct begins with its type and the next one's place.
        let info = unsafe { &mut *next.cast_mut().cast::<LayerCreateInfo>() };
        if info.kind == kind && info.function == 0 {
            // SAFETY: the loader's link lives through the call that creates.
            let link = unsafe { &*info.link };
            info.link = link.next;
            return link;
        }
        next = info.next;
    }
}

unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: the loader's info, and its functions.
    unsafe {
        let kind = vk::StructureType::LOADER_INSTANCE_CREATE_INFO;
        let get = link((*info).p_next, kind).get_instance_proc_addr;
        let create = get(vk::Instance::null(), c"vkCreateInstance".as_ptr());
        let create = create.expect("somebody creates instances");
        let create: vk::PFN_vkCreateInstance = std::mem::transmute(create);
        let result = create(info, callbacks, made);
        if result == vk::Result::SUCCESS {
            let handle = (*made).as_raw();
            with(&INSTANCES, |all| all.insert(key(handle), (handle, get)));
        }
        result
    }
}

unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Device,
) -> vk::Result {
    // SAFETY: the loader's info, and its functions.
    unsafe {
        let link = link((*info).p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO);
        let (instance, _) = with(&INSTANCES, |all| all[&key(physical.as_raw())]);
        let instance = vk::Instance::from_raw(instance);
        let create = (link.get_instance_proc_addr)(instance, c"vkCreateDevice".as_ptr());
        let create = create.expect("somebody creates devices");
        let create: vk::PFN_vkCreateDevice = std::mem::transmute(create);
        let result = create(physical, info, callbacks, made);
        if result == vk::Result::SUCCESS {
            let handle = (*made).as_raw();
            let get = link.get_device_proc_addr;
            with(&DEVICES, |all| all.insert(key(handle), (handle, get)));
        }
        result
    }
}
