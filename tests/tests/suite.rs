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

/// On the backend that runs nothing: what it can be asked without results.
mod null {
    use tressfx_core::error::Error;
    use tressfx_core::null::NullBackend;

    tressfx_conformance::suite!(|| Ok::<_, Error>(NullBackend::default()));
}
