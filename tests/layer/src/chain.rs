//! Between the loader and what comes next: how layers are linked (the loader's `LoaderLayerInterface.md`), and who answers for a function.

use std::collections::HashMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::{Mutex, PoisonError};

use ash::vk;
use ash::vk::Handle;

use crate::state;
use crate::{calls, unknown};

/// The functions that an application calls before there is an instance.
pub const BEFORE_INSTANCE: [&str; 3] = [
    "vkEnumerateInstanceVersion",
    "vkEnumerateInstanceExtensionProperties",
    "vkEnumerateInstanceLayerProperties",
];

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

/// Who comes next below an instance or device.
struct Below {
    who: Who,
    /// Answers are kept: below an instance that is complete the loader itself is asked, and answers with the topmost layer's functions.
    known: HashMap<CString, vk::PFN_vkVoidFunction>,
}

enum Who {
    Instance(vk::Instance, vk::PFN_vkGetInstanceProcAddr),
    Device(vk::Device, vk::PFN_vkGetDeviceProcAddr),
}

/// By the loader's key: the first pointer in the object.
static BELOW: Mutex<Option<HashMap<usize, Below>>> = Mutex::new(None);

fn with_below<T>(use_it: impl FnOnce(&mut HashMap<usize, Below>) -> T) -> T {
    let mut below = BELOW.lock().unwrap_or_else(PoisonError::into_inner);
    use_it(below.get_or_insert_default())
}

/// # Safety
/// `handle` is that of a live instance, physical device, device, queue or command buffer.
unsafe fn key(handle: u64) -> usize {
    // SAFETY: such objects begin with the loader's pointer (LoaderLayerInterface.md, "Dispatchable Objects").
    unsafe { *(handle as *const usize) }
}

/// The function of this name below the layer.
///
/// # Safety
/// `handle` is that of a live dispatchable object, and `F` the type of the function.
pub unsafe fn below<F: Copy>(handle: u64, name: &CStr) -> F {
    const { assert!(size_of::<F>() == size_of::<vk::PFN_vkVoidFunction>()) };
    // SAFETY: this function's contract.
    let key = unsafe { key(handle) };
    let found = with_below(|below| {
        let below = below.get_mut(&key).expect("it was made through the layer");
        // SAFETY: the object and its function are those that the loader gave.
        unsafe { below.find(name) }
    });
    assert!(
        found.is_some(),
        "{name:?} is asked for below only where it was above"
    );
    // SAFETY: `F` is the function's own type.
    unsafe { std::mem::transmute_copy(&found) }
}

impl Below {
    /// # Safety
    /// The object lives.
    unsafe fn find(&mut self, name: &CStr) -> vk::PFN_vkVoidFunction {
        if let Some(known) = self.known.get(name) {
            return *known;
        }
        // SAFETY: this function's contract.
        let found = unsafe {
            match self.who {
                Who::Instance(instance, get) => get(instance, name.as_ptr()),
                Who::Device(device, get) => get(device, name.as_ptr()),
            }
        };
        self.known.insert(name.into(), found);
        found
    }
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

unsafe extern "system" fn get_instance_proc_addr(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the loader passes a C string.
    let name = unsafe { CStr::from_ptr(name) };
    if name == c"vkGetInstanceProcAddr" {
        return pointer(get_instance_proc_addr as *const c_void);
    }
    if name == c"vkGetDeviceProcAddr" {
        return pointer(get_device_proc_addr as *const c_void);
    }
    if name == c"vkCreateInstance" {
        return pointer(create_instance as *const c_void);
    }
    if instance.is_null() {
        return None;
    }
    // SAFETY: a live instance.
    unsafe { answer(instance.as_raw(), name) }
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
    unsafe { answer(device.as_raw(), name) }
}

/// The layer's own function where it has one, the next one's where nothing can go wrong, and else a trap.
///
/// # Safety
/// `handle` is that of a live instance or device.
unsafe fn answer(handle: u64, name: &CStr) -> vk::PFN_vkVoidFunction {
    // SAFETY: this function's contract.
    let key = unsafe { key(handle) };
    // SAFETY: as above.
    let next = with_below(|below| unsafe { below.get_mut(&key)?.find(name) })?;
    let plain = name.to_str().ok()?;
    match calls::function(plain) {
        Some(own) => pointer(own),
        None if calls::cannot_fail(plain) => Some(next),
        None => unknown::function(name),
    }
}

fn pointer(function: *const c_void) -> vk::PFN_vkVoidFunction {
    // SAFETY: of a function, whose type the caller of Vulkan knows by its name.
    unsafe { std::mem::transmute::<*const c_void, vk::PFN_vkVoidFunction>(function) }
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

pub unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Instance,
) -> vk::Result {
    if let Some(code) = state::with(|state| state.call("vkCreateInstance")) {
        return code;
    }
    // SAFETY: the loader's info, and its functions.
    unsafe {
        let link = link(
            (*info).p_next,
            vk::StructureType::LOADER_INSTANCE_CREATE_INFO,
        );
        let get = link.get_instance_proc_addr;
        let create = get(vk::Instance::null(), c"vkCreateInstance".as_ptr());
        let create = create.expect("somebody creates instances");
        let create: vk::PFN_vkCreateInstance = std::mem::transmute(create);
        let result = create(info, callbacks, made);
        if result == vk::Result::SUCCESS {
            let handle = (*made).as_raw();
            let mut below = Below {
                who: Who::Instance(*made, get),
                known: HashMap::new(),
            };
            for name in calls::OF_INSTANCES {
                below.find(&CString::new(name).expect("a name"));
            }
            with_below(|all| all.insert(key(handle), below));
            state::with(|state| state.made("Instance", handle));
        }
        result
    }
}

pub unsafe extern "system" fn destroy_instance(
    instance: vk::Instance,
    callbacks: *const vk::AllocationCallbacks<'_>,
) {
    if instance.is_null() {
        return;
    }
    // SAFETY: the application's instance, which is live until the call.
    unsafe {
        let handle = instance.as_raw();
        let destroy: vk::PFN_vkDestroyInstance = below(handle, c"vkDestroyInstance");
        with_below(|below| below.remove(&key(handle)));
        destroy(instance, callbacks);
        state::with(|state| {
            state.destroyed("Instance", handle);
            state.write();
        });
    }
}

pub unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Device,
) -> vk::Result {
    if let Some(code) = state::with(|state| state.call("vkCreateDevice")) {
        return code;
    }
    // SAFETY: the loader's info, and its functions.
    unsafe {
        let link = link((*info).p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO);
        let create: vk::PFN_vkCreateDevice = below(physical.as_raw(), c"vkCreateDevice");
        let result = create(physical, info, callbacks, made);
        if result == vk::Result::SUCCESS {
            let handle = (*made).as_raw();
            let get = link.get_device_proc_addr;
            let below = Below {
                who: Who::Device(*made, get),
                known: HashMap::new(),
            };
            with_below(|all| all.insert(key(handle), below));
            state::with(|state| state.made("Device", handle));
        }
        result
    }
}

pub unsafe extern "system" fn destroy_device(
    device: vk::Device,
    callbacks: *const vk::AllocationCallbacks<'_>,
) {
    if device.is_null() {
        return;
    }
    // SAFETY: the application's device, which is live until the call.
    unsafe {
        let handle = device.as_raw();
        let destroy: vk::PFN_vkDestroyDevice = below(handle, c"vkDestroyDevice");
        with_below(|below| below.remove(&key(handle)));
        state::with(|state| state.destroyed("Device", handle));
        destroy(device, callbacks);
        state::with(|state| state.write());
    }
}

/// A call before there is an instance: the next one's function comes with the arguments (`VkEnumerateInstance...Chain`).
#[repr(C)]
pub struct Chain<F> {
    kind: i32,
    version: u32,
    size: u32,
    next: F,
    link: *const c_void,
}

type NextVersion = unsafe extern "system" fn(*const c_void, *mut u32) -> vk::Result;
type NextExtensions = unsafe extern "system" fn(
    *const c_void,
    *const c_char,
    *mut u32,
    *mut vk::ExtensionProperties,
) -> vk::Result;
type NextLayers =
    unsafe extern "system" fn(*const c_void, *mut u32, *mut vk::LayerProperties) -> vk::Result;

/// # Safety
/// Called by the loader.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn failing_driver_vkEnumerateInstanceVersion(
    chain: &Chain<NextVersion>,
    version: *mut u32,
) -> vk::Result {
    let fails = state::with(|state| state.call("vkEnumerateInstanceVersion"));
    // SAFETY: this function's contract.
    fails.unwrap_or_else(|| unsafe { (chain.next)(chain.link, version) })
}

/// # Safety
/// Called by the loader.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn failing_driver_vkEnumerateInstanceExtensionProperties(
    chain: &Chain<NextExtensions>,
    layer: *const c_char,
    count: *mut u32,
    properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    let fails = state::with(|state| state.call("vkEnumerateInstanceExtensionProperties"));
    // SAFETY: this function's contract.
    fails.unwrap_or_else(|| unsafe { (chain.next)(chain.link, layer, count, properties) })
}

/// # Safety
/// Called by the loader.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn failing_driver_vkEnumerateInstanceLayerProperties(
    chain: &Chain<NextLayers>,
    count: *mut u32,
    properties: *mut vk::LayerProperties,
) -> vk::Result {
    let fails = state::with(|state| state.call("vkEnumerateInstanceLayerProperties"));
    // SAFETY: this function's contract.
    fails.unwrap_or_else(|| unsafe { (chain.next)(chain.link, count, properties) })
}
