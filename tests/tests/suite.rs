//! The suite on every backend that there is.

/// On wgpu.
mod wgpu {
    use tressfx_backend_wgpu::{WgpuBackend, WgpuOptions};

    tressfx_conformance::suite!(|| {
        let _alone = tressfx_backend_vulkan::lock_loader();
        WgpuBackend::headless()
    });

    #[test]
    fn an_adapter_that_is_not_there_is_named() {
        let missing = WgpuOptions { adapter: Some(String::from("no such adapter")) };
        let missing = WgpuBackend::headless_with(&missing).unwrap_err().to_string();
        let listed = missing.contains("no adapter is named `no such adapter`; there are: ");
        assert!(listed || missing.contains("no graphics adapter was found"), "{missing}");
    }
}

/// On raw Vulkan, under the eyes of the validation layer: whatever it says fails a case.
mod vulkan {
    use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};

    tressfx_conformance::suite!(|| VulkanBackend::headless_with(&VulkanOptions {
        validation: true,
        ..Default::default()
    }));

    #[test]
    fn an_adapter_that_is_not_there_is_named() {
        let missing = VulkanOptions { adapter: Some(String::from("no such adapter")), ..Default::default() };
        let missing = VulkanBackend::headless_with(&missing).unwrap_err().to_string();
        let listed = missing.contains("no adapter is named `no such adapter`; there are: ");
        assert!(listed || missing.contains("no graphics adapter with Vulkan 1.3 was found"), "{missing}");
    }
}

/// On the backend that runs nothing: what it can be asked without results.
mod null {
    use tressfx_core::backend::Caps;
    use tressfx_core::error::Error;
    use tressfx_core::null::NullBackend;

    tressfx_conformance::suite!(|| Ok::<_, Error>(null()), lacks: [ReadBack]);

    fn null() -> NullBackend {
        let mut caps = Caps::webgpu_default();
        caps.read_back = false;
        NullBackend::new(caps)
    }
}

/// On the CPU, without passes.
#[path = "suite/copies.rs"]
mod copies;

/// The suite on [`copies`].
mod cpu {
    use tressfx_core::error::Error;

    use crate::copies::Copies;

    tressfx_conformance::suite!(|| Ok::<_, Error>(Copies::new()), lacks: [Compute, Raster]);
}

/// What a backend lacks is skipped by name, and the rest is asked for all the same.
mod lacking {
    use tressfx_conformance::suite::{CASES, Outcome, promises, report, test};
    use tressfx_core::backend::Caps;
    use tressfx_core::error::{Error, Need};
    use tressfx_core::null::NullBackend;

    /// Needs of the cases that are skipped on a backend of these caps; none fails.
    fn skipped(caps: &Caps) -> Vec<Need> {
        let outcomes = report(|| Ok::<_, Error>(NullBackend::new(caps.clone())));
        assert_eq!(outcomes.len(), CASES.len());
        let need = |(name, outcome): (&str, Outcome)| match outcome {
            Outcome::Passed => None,
            Outcome::Skipped(need) => Some(need),
            Outcome::Failed(why) => panic!("{name}: {why}"),
        };
        outcomes.into_iter().filter_map(need).collect()
    }

    /// A backend that denies everything passes nothing.
    #[test]
    #[should_panic(expected = "nobody said that the backend lacks that")]
    fn what_is_denied_in_silence_fails() {
        let mut caps = Caps::webgpu_default();
        caps.compute = false;
        test("hazards::compute_writes_twice", || Ok::<_, Error>(NullBackend::new(caps.clone())), &[Need::ReadBack]);
    }

    #[test]
    fn what_was_skipped_for_something_that_is_there_is_told() {
        let outcomes = [("one", Outcome::Skipped(Need::Compute)), ("two", Outcome::Skipped(Need::ReadBack))];
        let mut caps = Caps::webgpu_default();
        caps.read_back = false;
        let told = promises(&NullBackend::new(caps), &outcomes).unwrap_err();
        assert!(told.contains("one: skipped") && !told.contains("two"), "{told}");
    }

    #[test]
    fn what_is_skipped_is_counted() {
        let mut caps = Caps::webgpu_default();
        caps.read_back = false;
        let without_results = skipped(&caps);
        assert!(without_results.iter().all(|&need| need == Need::ReadBack));
        let expected = CASES.iter().filter(|case| case.needs.contains(&Need::ReadBack)).count();
        assert_eq!(without_results.len(), expected);
        (caps.compute, caps.raster) = (false, false);
        let without_passes = skipped(&caps);
        for need in [Need::Compute, Need::Raster, Need::ReadBack] {
            assert!(without_passes.contains(&need), "{need}");
        }
        let passed = CASES.len() - without_passes.len();
        assert!(passed >= 10, "{passed} cases need neither passes nor results");
    }
}
