//! What the validation layer says.

use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use ash::{ext, vk};
use tressfx_core::error::{Error, Result};

pub(crate) const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Messages that are not passed on: a part of their text, and why. Everything else is.
const EXEMPT: [(&str, &str); 0] = [];

/// Synchronization validation, which is off by default.
pub(crate) fn features() -> vk::ValidationFeaturesEXT<'static> {
    const ENABLED: &[vk::ValidationFeatureEnableEXT] = &[vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    vk::ValidationFeaturesEXT::default().enabled_validation_features(ENABLED)
}

/// Storage buffers that shaders write and read are only watched where newer layers are told to.
pub(crate) fn settings() -> vk::LayerSettingEXT<'static> {
    static ON: vk::Bool32 = vk::TRUE;
    vk::LayerSettingEXT {
        value_count: 1,
        p_values: std::ptr::from_ref(&ON).cast(),
        ..vk::LayerSettingEXT::default()
            .layer_name(LAYER)
            .setting_name(c"syncval_shader_accesses_heuristic")
            .ty(vk::LayerSettingTypeEXT::BOOL32)
    }
}

/// Collects the messages of an instance.
pub(crate) struct Messages {
    debug: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    /// Where the callback writes to. The callback has its address, which a box that is moved would not promise.
    texts: Arc<Mutex<Vec<String>>>,
}

impl Messages {
    pub(crate) fn listen(entry: &ash::Entry, instance: &ash::Instance) -> Result<Self> {
        let debug = ext::debug_utils::Instance::new(entry, instance);
        let texts = Arc::new(Mutex::new(Vec::new()));
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
            )
            .message_type(
                vk::DebugUtilsMessageTypeFlagsEXT::GENERAL
                    | vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                    | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
            )
            .pfn_user_callback(Some(on_message))
            .user_data(Arc::as_ptr(&texts).cast_mut().cast());
        // SAFETY: the extension is enabled wherever messages are listened to, and `texts` outlives the messenger.
        let messenger = unsafe { debug.create_debug_utils_messenger(&info, None) };
        let messenger =
            messenger.map_err(|error| Error::Backend { label: "validation", message: error.to_string() })?;
        Ok(Self { debug, messenger, texts })
    }

    pub(crate) fn take(&self) -> Vec<String> {
        std::mem::take(&mut self.texts.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Messages {
    fn drop(&mut self) {
        // SAFETY: it was made by `listen`, and the instance is destroyed after this.
        unsafe { self.debug.destroy_debug_utils_messenger(self.messenger, None) };
    }
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    texts: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer gives valid data, and `texts` is what `listen` gave it.
    let (data, texts) = unsafe { (&*data, &*texts.cast_const().cast::<Mutex<Vec<String>>>()) };
    // SAFETY: the message is a C string or null.
    let text = unsafe { data.message_as_c_str() }.map_or_else(Default::default, CStr::to_string_lossy);
    // SAFETY: as above.
    let name = unsafe { data.message_id_name_as_c_str() }.map_or_else(Default::default, CStr::to_string_lossy);
    let text = if text.contains(&*name) { text } else { format!("[ {name} ] {text}").into() };
    if !EXEMPT.iter().any(|(part, _)| text.contains(part)) {
        texts.lock().unwrap_or_else(PoisonError::into_inner).push(text.into_owned());
    }
    vk::FALSE
}
