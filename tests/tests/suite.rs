//! The suite on every backend that there is.

/// On wgpu.
mod wgpu {
    use tressfx_backend_wgpu::WgpuBackend;

    tressfx_conformance::suite!(|| WgpuBackend::headless());

    #[test]
    fn an_adapter_that_is_not_there_is_named() {
        let missing = WgpuBackend::headless_on(Some("no such adapter")).unwrap_err().to_string();
        let listed = missing.contains("no adapter is named `no such adapter`; there are: ");
        assert!(listed || missing.contains("no graphics adapter was found"), "{missing}");
    }
}

/// On raw Vulkan, under the eyes of the validation layer: whatever it says fails a case.
mod vulkan {
    use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};

    tressfx_conformance::suite!(|| VulkanBackend::open(&VulkanOptions { validation: true, ..Default::default() }));

    #[test]
    fn an_adapter_that_is_not_there_is_named() {
        let missing = VulkanOptions { adapter: Some(String::from("no such adapter")), ..Default::default() };
        let missing = VulkanBackend::open(&missing).unwrap_err().to_string();
        let listed = missing.contains("no adapter is named `no such adapter`; there are: ");
        assert!(listed || missing.contains("no graphics adapter with Vulkan 1.3 was found"), "{missing}");
    }
}

/// On the backend that runs nothing: what it can be asked without results.
mod null {
    use tressfx_core::error::Error;
    use tressfx_core::null::NullBackend;

    tressfx_conformance::suite!(|| Ok::<_, Error>(NullBackend::default()));
}
