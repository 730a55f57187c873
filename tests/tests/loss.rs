//! A device that is lost while hair lives on it: errors that say so, whatever is asked for, and nothing that crashes or hangs.

mod support;

use tressfx_backend_vulkan::ash::vk;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::show::{Scene, Show};
use tressfx_core::backend::{BufferDesc, Format, ReadBack, Run, TextureDesc};
use tressfx_core::error::{Error, Result};
use tressfx_core::pass::PassList;

/// Holds that an answer is the loss of the device.
#[track_caller]
fn assert_lost<T: std::fmt::Debug>(answer: Result<T>) {
    assert!(matches!(answer, Err(Error::DeviceLost { .. })), "{answer:?}");
}

/// Has the device of a show be lost between two frames.
fn hold<B: Run>(backend: B, lose: impl FnOnce(&mut B)) {
    let mut show = Show::new(backend, &Scene::builtin("wavy:40:8", [64, 36]));
    show.play(2);
    let buffer = show.backend.create_buffer(&BufferDesc::storage("test.before", 64)).unwrap();
    let bytes = show.backend.memory().bytes;
    lose(&mut show.backend);
    let mut list = PassList::new();
    show.record(&mut list);
    let ticket = list.read_buffer(buffer, 0, 64);
    assert_lost(show.backend.run(&list));
    assert!(matches!(show.backend.read(ticket), ReadBack::Failed | ReadBack::Unknown));
    for _ in 0..2 {
        assert_lost(show.backend.run(&list));
        assert_lost(show.backend.create_buffer(&BufferDesc::storage("test.after", 64)));
        assert_lost(show.backend.create_texture(&TextureDesc::new("test.after", [4, 4], Format::Rgba8)));
    }
    assert_eq!(show.backend.memory().bytes, bytes, "what was not made does not count");
    // The rules hold as before.
    list.clear(buffer, 0, 65);
    assert!(matches!(show.backend.run(&list), Err(Error::Rule { .. } | Error::DeviceLost { .. })));
    show.backend.cancel_read(ticket);
    show.backend.timings();
    show.backend.destroy(buffer.into());
    assert_eq!(show.backend.memory().bytes, bytes - 64);
}

#[test]
fn of_wgpu() {
    let Some(backend) = support::gpu() else { return };
    hold(*backend, |backend| backend.device().destroy());
}

#[test]
fn of_raw_vulkan() {
    if support::gpu().is_none() {
        return;
    }
    let options = VulkanOptions { validation: true, ..Default::default() };
    hold(VulkanBackend::headless_with(&options).unwrap(), |backend| {
        backend.plant_failure(0, vk::Result::ERROR_DEVICE_LOST)
    });
}
