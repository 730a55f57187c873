//! Starting Vulkan and finding an adapter.

use std::collections::BTreeSet;
use std::ffi::{CStr, c_char};
use std::sync::OnceLock;

use ash::{ext, vk};
use tressfx_core::error::{Error, Result};

use crate::label::lock_loader;
use crate::validation::{self, Messages};

/// An instance of our own. To be made, asked for adapters and dropped [`lock_loader`].
pub(crate) struct Instance {
    pub(crate) instance: ash::Instance,
    /// Whether VK_EXT_debug_utils is enabled.
    pub(crate) debug_utils: bool,
    messages: Option<Messages>,
}

/// The loader, once for the process: loading and unloading it on several threads at once has been seen to crash inside of it.
fn entry() -> Result<&'static ash::Entry> {
    static ENTRY: OnceLock<Result<ash::Entry>> = OnceLock::new();
    // SAFETY: the loader is what the system has, and it stays.
    let load = || unsafe { ash::Entry::load() }.map_err(|error| none(format!("Vulkan was not found ({error})")));
    ENTRY.get_or_init(load).as_ref().map_err(Clone::clone)
}

impl Instance {
    pub(crate) fn start(validation: bool) -> Result<Self> {
        let entry = entry()?;
        // SAFETY: the entry is loaded.
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }.unwrap_or_default();
        let debug_utils = validation || names(&extensions).contains(ext::debug_utils::NAME);
        // SAFETY: as above. Where the layer is not installed, making the instance says so.
        let of_layer = unsafe { entry.enumerate_instance_extension_properties(Some(validation::LAYER)) };
        let has_settings = names(&of_layer.unwrap_or_default()).contains(ext::layer_settings::NAME);
        let wanted: Vec<*const c_char> = [
            (debug_utils, ext::debug_utils::NAME),
            (validation, ext::validation_features::NAME),
            (validation && has_settings, ext::layer_settings::NAME),
        ]
        .iter()
        .filter(|(wanted, _)| *wanted)
        .map(|(_, name)| name.as_ptr())
        .collect();
        let layers: &[*const c_char] = if validation { &[validation::LAYER.as_ptr()] } else { &[] };
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3).application_name(c"tressfx");
        let mut features = validation::features();
        let settings = [validation::settings()];
        let mut settings = vk::LayerSettingsCreateInfoEXT::default().settings(&settings);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_extension_names(&wanted)
            .enabled_layer_names(layers);
        if validation {
            info = info.push_next(&mut features);
        }
        if validation && has_settings {
            info = info.push_next(&mut settings);
        }
        // SAFETY: all pointers live until the call is over.
        let instance = unsafe { entry.create_instance(&info, None) }.map_err(|error| match error {
            vk::Result::ERROR_LAYER_NOT_PRESENT => Error::NoAdapter {
                message: String::from(
                    "validation was asked for, but its layer is not installed: on Debian and Ubuntu `apt-get install \
                     vulkan-validationlayers`",
                ),
            },
            error => none(format!("Vulkan could not be started ({error})")),
        })?;
        let mut started = Self { instance, debug_utils, messages: None };
        if validation {
            started.messages = Some(Messages::listen(entry, &started.instance)?);
        }
        Ok(started)
    }

    /// What the validation layer said since the last call.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.messages.as_ref().map_or_else(Vec::new, Messages::take)
    }

    /// The adapters with Vulkan 1.3, the fastest first, with their names.
    fn adapters(&self) -> Vec<(vk::PhysicalDevice, String)> {
        // SAFETY: the instance is alive.
        let found = unsafe { self.instance.enumerate_physical_devices() }.unwrap_or_default();
        let mut adapters: Vec<_> = found
            .into_iter()
            // SAFETY: as above.
            .map(|adapter| (adapter, unsafe { self.instance.get_physical_device_properties(adapter) }))
            .filter(|(_, properties)| properties.api_version >= vk::API_VERSION_1_3)
            .collect();
        adapters.sort_by_key(|(_, properties)| kind(properties.device_type).0);
        adapters.into_iter().map(|(adapter, properties)| (adapter, describe(&properties))).collect()
    }

    /// The fastest adapter, or the first whose description contains `wanted`.
    pub(crate) fn pick(&self, wanted: Option<&str>) -> Result<(vk::PhysicalDevice, String)> {
        let adapters = self.adapters();
        let matches = |name: &str| wanted.is_none_or(|wanted| name.to_lowercase().contains(&wanted.to_lowercase()));
        if let Some(found) = adapters.iter().find(|(_, name)| matches(name)) {
            return Ok(found.clone());
        }
        let names: Vec<_> = adapters.into_iter().map(|(_, name)| name).collect();
        Err(match wanted {
            Some(wanted) if !names.is_empty() => {
                Error::NoAdapter { message: format!("no adapter is named `{wanted}`; there are: {}", names.join("; ")) }
            }
            _ => none(String::from("no graphics adapter with Vulkan 1.3 was found")),
        })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        self.messages = None;
        // SAFETY: the device and the messenger are gone: both go before this.
        unsafe { self.instance.destroy_instance(None) };
    }
}

/// The adapters of the system with Vulkan 1.3, as people name them: `NAME (raw Vulkan VERSION, kind)`.
pub fn adapters() -> Vec<String> {
    let _alone = lock_loader();
    let started = Instance::start(false);
    started.map_or_else(|_| Vec::new(), |started| started.adapters().into_iter().map(|(_, name)| name).collect())
}

fn none(what: String) -> Error {
    let message = format!(
        "{what}. Install the driver of the graphics card, or a software Vulkan: on Debian and Ubuntu `apt-get install \
         mesa-vulkan-drivers libvulkan1`"
    );
    Error::NoAdapter { message }
}

/// Which of two kinds is faster, and what it is called.
fn kind(kind: vk::PhysicalDeviceType) -> (u32, &'static str) {
    match kind {
        vk::PhysicalDeviceType::DISCRETE_GPU => (0, "DiscreteGpu"),
        vk::PhysicalDeviceType::INTEGRATED_GPU => (1, "IntegratedGpu"),
        vk::PhysicalDeviceType::VIRTUAL_GPU => (2, "VirtualGpu"),
        vk::PhysicalDeviceType::CPU => (4, "Cpu"),
        _ => (3, "Other"),
    }
}

pub(crate) fn describe(properties: &vk::PhysicalDeviceProperties) -> String {
    let name = properties.device_name_as_c_str().map_or_else(|_| "?".into(), CStr::to_string_lossy);
    let version = properties.api_version;
    let (major, minor) = (vk::api_version_major(version), vk::api_version_minor(version));
    format!("{name} (raw Vulkan {major}.{minor}, {})", kind(properties.device_type).1)
}

pub(crate) fn names(extensions: &[vk::ExtensionProperties]) -> BTreeSet<&CStr> {
    extensions.iter().filter_map(|extension| extension.extension_name_as_c_str().ok()).collect()
}
