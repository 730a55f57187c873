//! The GPU that the tests of this folder run on.
#![allow(dead_code, reason = "each test takes what it needs")]

pub(crate) mod hair;
pub(crate) mod passes;

use tressfx_backend_vulkan::VulkanBackend;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_conformance::faulty::Faulty;
use tressfx_conformance::render::{Screen, Setup};
use tressfx_conformance::sim::Rig;
use tressfx_core::backend::Run;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_sim::SimParams;

/// A wgpu backend, or `None` where there is no adapter and `TRESSFX_NO_GPU` says that this is known.
///
/// # Panics
/// If there is no adapter and nobody said so: a test must not pass because it did not run.
pub(crate) fn gpu() -> Option<Box<WgpuBackend>> {
    // The Vulkan loader does not let a device be made while another thread names an object.
    let _alone = tressfx_backend_vulkan::lock_loader();
    match WgpuBackend::headless() {
        Ok(backend) => Some(Box::new(backend)),
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            tressfx_conformance::suite::say_skipped("a test of the GPU", &error.to_string());
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// The same backend, taken for a CPU or for a GPU, whatever it is: kernels may differ.
pub(crate) fn taken_for<B: Run + 'static>(backend: B, is_cpu: bool) -> Box<dyn Run> {
    let mut caps = backend.caps().clone();
    caps.is_cpu = is_cpu;
    Box::new(Faulty::claiming(backend, caps))
}

/// A backend of each kind, or none where there is no [`gpu`].
pub(crate) fn backends() -> Vec<Box<dyn Run>> {
    let wgpu = gpu().map(|gpu| gpu as Box<dyn Run>);
    wgpu.into_iter().flat_map(|wgpu| [wgpu, Box::new(VulkanBackend::headless().unwrap())]).collect()
}

/// A screen on a [`gpu`].
pub(crate) fn screen(change: impl FnOnce(&mut Setup)) -> Option<Screen> {
    Some(Screen::new(gpu()?, change))
}

/// A simulation of one section on a [`gpu`].
pub(crate) fn rig(strands: Strands, params: SimParams, capsules: &[Capsule]) -> Option<Rig> {
    rig_of_sections(vec![(strands, params)], capsules)
}

/// A simulation of several sections on a [`gpu`].
pub(crate) fn rig_of_sections(sections: Vec<(Strands, SimParams)>, capsules: &[Capsule]) -> Option<Rig> {
    Some(Rig::new(gpu()?, sections, capsules))
}
