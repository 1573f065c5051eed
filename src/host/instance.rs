//! The Vulkan instance, and the validation layer's word on what we do.

use crate::error::{Error, Result};
use crate::gpu::failed;
use ash::{ext, khr, vk};
use std::borrow::Cow;
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex, PoisonError};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// A Vulkan instance. Clones share it; it goes with the last of them.
#[derive(Clone)]
pub struct Instance(Arc<Shared>);

struct Shared {
    raw: ash::Instance,
    messenger: Option<Messenger>,
    /// The messenger, and the creation of the instance, point here: behind an `Arc`, so that it stays where it is.
    messages: Arc<Messages>,
    /// The loaded library: no Vulkan function may be called after it is gone.
    entry: ash::Entry,
}

struct Messenger {
    functions: ext::debug_utils::Instance,
    raw: vk::DebugUtilsMessengerEXT,
}

#[derive(Default)]
struct Messages(Mutex<Vec<String>>);

/// Layers and extensions of an instance about to be made.
#[derive(Default)]
struct Parts {
    layers: Vec<*const c_char>,
    extensions: Vec<*const c_char>,
    flags: vk::InstanceCreateFlags,
    synchronization: bool,
}

impl Instance {
    /// Loads Vulkan and makes an instance, with core and synchronization validation if `validation`.
    ///
    /// Each validation message (warning or error) is logged as an error and kept for [`Instance::validation_messages`].
    ///
    /// # Errors
    /// [`Error::NoDevice`] without a Vulkan loader or driver; [`Error::Option`] if validation is asked for and not installed.
    pub fn new(validation: bool) -> Result<Instance> {
        Instance::with_extensions(validation, &[])
    }

    /// As [`Instance::new`], with instance extensions that the caller needs: those of surfaces, for one who has a window.
    ///
    /// # Errors
    /// As [`Instance::new`]; [`Error::NoDisplay`] names an extension that the loader and its drivers lack.
    pub fn with_extensions(validation: bool, wanted: &[&'static CStr]) -> Result<Instance> {
        let entry = load()?;
        let mut parts = Parts::choose(&entry, validation)?;
        parts.add(&entry, wanted)?;
        let messages = Arc::<Messages>::default();
        // SAFETY: `messages` does not move, and is kept in the same struct as the instance.
        let raw = unsafe { create(&entry, &parts, validation.then_some(&*messages)) }?;
        let mut shared = Shared {
            raw,
            messenger: None,
            messages,
            entry,
        };
        if validation {
            // From here on `shared` destroys the instance if anything fails.
            shared.messenger = Some(Messenger::new(&shared)?);
        }
        Ok(Instance(Arc::new(shared)))
    }

    /// The functions of this instance.
    pub fn raw(&self) -> &ash::Instance {
        &self.0.raw
    }

    /// The loader's functions, for surfaces.
    pub fn entry(&self) -> &ash::Entry {
        &self.0.entry
    }

    /// Every validation message so far, in order. Empty without validation.
    pub fn validation_messages(&self) -> Vec<String> {
        self.0.messages.lock().clone()
    }
}

impl Messages {
    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<String>> {
        // Pushing a string cannot leave the list half-changed, so a panic elsewhere does not spoil it.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// For `map_err`: without what `call` would give there is no device.
pub(super) fn unavailable(call: &'static str) -> impl Fn(vk::Result) -> Error {
    move |code| Error::NoDevice(failed(call)(code).to_string())
}

fn load() -> Result<ash::Entry> {
    // SAFETY: loading runs the initialisers of the system's Vulkan loader, which is made to be loaded so.
    let entry = unsafe { ash::Entry::load() }.map_err(|error| {
        Error::NoDevice(format!(
            "the Vulkan loader is not installed ({error}); install it and a driver (Debian: libvulkan1, mesa-vulkan-drivers)"
        ))
    })?;
    // SAFETY: the entry is loaded.
    let version = unsafe { entry.try_enumerate_instance_version() };
    match version.map_err(unavailable("vkEnumerateInstanceVersion"))? {
        Some(version) if version >= vk::API_VERSION_1_2 => Ok(entry),
        _ => Err(Error::NoDevice(
            "the Vulkan loader is older than 1.2; install a newer one".into(),
        )),
    }
}

impl Parts {
    fn choose(entry: &ash::Entry, validation: bool) -> Result<Parts> {
        let mut parts = Parts::default();
        let available = extensions(entry, None)?;
        // Drivers on top of another API (MoltenVK) are listed only to those who ask.
        if has(&available, khr::portability_enumeration::NAME) {
            let name = khr::portability_enumeration::NAME;
            parts.extensions.push(name.as_ptr());
            parts.flags |= vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
        }
        if validation {
            parts.add_validation(entry, &available)?;
        }
        Ok(parts)
    }

    fn add(&mut self, entry: &ash::Entry, wanted: &[&'static CStr]) -> Result<()> {
        let available = extensions(entry, None)?;
        for &name in wanted {
            if !has(&available, name) {
                return Err(Error::NoDisplay(format!(
                    "Vulkan draws to no window here: it lacks {}",
                    name.to_string_lossy()
                )));
            }
            self.extensions.push(name.as_ptr());
        }
        Ok(())
    }

    fn add_validation(
        &mut self,
        entry: &ash::Entry,
        available: &[vk::ExtensionProperties],
    ) -> Result<()> {
        // SAFETY: the entry is loaded.
        let layers = unsafe { entry.enumerate_instance_layer_properties() }
            .map_err(unavailable("vkEnumerateInstanceLayerProperties"))?;
        let is_validation =
            |layer: &vk::LayerProperties| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER);
        if !layers.iter().any(is_validation) {
            return Err(no_validation("the layer VK_LAYER_KHRONOS_validation"));
        }
        let of_layer = extensions(entry, Some(VALIDATION_LAYER))?;
        let debug = ext::debug_utils::NAME;
        if !has(available, debug) && !has(&of_layer, debug) {
            return Err(no_validation("the extension VK_EXT_debug_utils"));
        }
        self.layers.push(VALIDATION_LAYER.as_ptr());
        self.extensions.push(debug.as_ptr());
        self.synchronization = has(&of_layer, ext::validation_features::NAME);
        if self.synchronization {
            self.extensions
                .push(ext::validation_features::NAME.as_ptr());
        } else {
            tracing::warn!("this validation layer checks no synchronization");
        }
        Ok(())
    }
}

fn no_validation(what: &str) -> Error {
    Error::Option {
        option: "validation",
        problem: format!("{what} is not installed"),
        remedy: "install it (Debian: vulkan-validationlayers) or run without validation".into(),
    }
}

fn extensions(entry: &ash::Entry, layer: Option<&CStr>) -> Result<Vec<vk::ExtensionProperties>> {
    // SAFETY: the entry is loaded; the layer's name is a C string that lives through the call.
    unsafe { entry.enumerate_instance_extension_properties(layer) }
        .map_err(unavailable("vkEnumerateInstanceExtensionProperties"))
}

fn has(extensions: &[vk::ExtensionProperties], name: &CStr) -> bool {
    extensions
        .iter()
        .any(|extension| extension.extension_name_as_c_str() == Ok(name))
}

/// # Safety
/// `messages` stays where it is as long as the instance lives.
unsafe fn create(
    entry: &ash::Entry,
    parts: &Parts,
    messages: Option<&Messages>,
) -> Result<ash::Instance> {
    let application = vk::ApplicationInfo::default()
        .application_name(c"hullform")
        .engine_name(c"hullform")
        .api_version(vk::API_VERSION_1_3);
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&parts.layers)
        .enabled_extension_names(&parts.extensions)
        .flags(parts.flags);
    if parts.synchronization {
        info = info.push_next(&mut features);
    }
    // A messenger cannot exist before its instance: one in the chain speaks while the instance is made and destroyed.
    let mut messenger = messages.map(messenger_info);
    if let Some(messenger) = &mut messenger {
        info = info.push_next(messenger);
    }
    // SAFETY: all that `info` points to lives through the call, and `messages` longer, by this function's contract.
    unsafe { entry.create_instance(&info, None) }.map_err(|code| match code {
        vk::Result::ERROR_INCOMPATIBLE_DRIVER => Error::NoDevice(
            "no Vulkan driver is installed; install one (Debian: mesa-vulkan-drivers)".into(),
        ),
        code => unavailable("vkCreateInstance")(code),
    })
}

fn messenger_info(messages: &Messages) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    use vk::DebugUtilsMessageSeverityFlagsEXT as Severity;
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(Severity::WARNING | Severity::ERROR)
        // Not GENERAL, which is the loader grumbling about drivers that do not concern us.
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(on_message))
        .user_data(std::ptr::from_ref(messages).cast_mut().cast())
}

/// # Safety
/// Called by the validation layer, with the pointers that the specification of `PFN_vkDebugUtilsMessengerCallbackEXT` promises
/// and with the user data of [`messenger_info`].
unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes a valid struct for the length of the call.
    let text = match unsafe { (*data).message_as_c_str() } {
        Some(text) => text.to_string_lossy(),
        None => Cow::Borrowed("a message without text"),
    };
    tracing::error!("validation: {text}");
    // SAFETY: the user data is what `Shared::messages` owns, which outlives messenger and instance.
    let messages = unsafe { &*messages.cast::<Messages>() };
    messages.lock().push(text.into_owned());
    // The specification leaves VK_TRUE (fail the call) to layer developers.
    vk::FALSE
}

impl Messenger {
    fn new(shared: &Shared) -> Result<Messenger> {
        let functions = ext::debug_utils::Instance::new(&shared.entry, &shared.raw);
        let info = messenger_info(&shared.messages);
        // SAFETY: the instance is live and was made with VK_EXT_debug_utils; the messages outlive it.
        let raw = unsafe { functions.create_debug_utils_messenger(&info, None) }
            .map_err(failed("vkCreateDebugUtilsMessengerEXT"))?;
        Ok(Messenger { functions, raw })
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        if let Some(messenger) = &self.messenger {
            // SAFETY: made by these functions, destroyed once, while the instance lives.
            unsafe {
                messenger
                    .functions
                    .destroy_debug_utils_messenger(messenger.raw, None);
            }
        }
        // SAFETY: devices hold a clone of the `Instance`, so none is left. The messages and the library go after this.
        unsafe { self.raw.destroy_instance(None) };
    }
}
