//! The pool of fragments: what it needs, what happens when it is too small, and what costs nothing.

mod support;

use glam::Vec3;
use tressfx_conformance::render::Groom;
use tressfx_core::backend::{Caps, DepthOrder, Format};
use tressfx_core::error::Error;
use tressfx_core::error::Need;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{HairRenderer, Lights, PpllDesc, RenderDesc, SectionDraw, ShadedStrands, Targets, ViewDraw};

use support::hair::material;
use support::screen;

#[test]
fn a_pool_that_has_not_grown_yet_drops_exactly_what_it_has_no_room_for() {
    let groom = Groom::wavy(400, 16, 1, material());
    let Some(mut roomy) = screen(|_| ()) else { return };
    let all = roomy.hair(&[&groom]);
    for capacity in [1, 1000, 6000] {
        let Some(mut screen) = screen(|setup| setup.ppll().max_node_bytes = 16 * capacity) else { return };
        screen.may_grow = false;
        let picture = screen.hair(&[&groom]);
        assert_eq!(u64::from(screen.renderer.capacity()), capacity);
        assert_eq!(picture.counters.fragments, all.counters.fragments, "what is wanted is counted all the same");
        assert_eq!(u64::from(picture.counters.dropped), u64::from(all.counters.fragments) - capacity);
        let covered = picture.pixels().iter().filter(|pixel| pixel.w > 0.0).count() as u32;
        assert!(covered <= picture.counters.pixels_with_hair);
        assert!(u64::from(picture.counters.pixels_with_hair) <= capacity);
        assert!(capacity > 1 || picture.counters.pixels_with_hair == 1, "the fragment that found room is there");
        for (some, every) in picture.pixels().iter().zip(all.pixels()) {
            assert!(some.is_finite() && some.w <= every.w + 0.001, "{some} of {every}");
        }
    }
}

#[test]
fn no_pixel_loses_its_list_when_the_pool_overflows() {
    // First a section that fits, then one over the same pixels that does not: the first must stay as it was.
    let (first, second) = (Groom::wavy(60, 12, 2, material()), Groom::wavy(400, 16, 3, material()));
    let Some(mut roomy) = screen(|_| ()) else { return };
    let alone = roomy.hair(&[&first]);
    let fits = u64::from(alone.counters.fragments);
    let Some(mut tight) = screen(|setup| setup.ppll().max_node_bytes = 16 * fits) else { return };
    tight.may_grow = false;
    let both = tight.hair(&[&first, &second]);
    assert!(both.counters.dropped > 10_000, "{:?}", both.counters);
    assert!(both.bytes == alone.bytes, "the first section is there to the bit");
}

#[test]
fn the_pool_is_predicted_and_then_measured() {
    let Some(mut roomy) = screen(|_| ()) else { return };
    let groom = Groom::wavy(3000, 16, 4, material());
    let picture = roomy.hair(&[&groom]);
    let (needed, capacity) = (f64::from(picture.counters.fragments), f64::from(roomy.renderer.capacity()));
    eprintln!("{needed} fragments, room for {capacity}");
    assert_eq!(picture.counters.dropped, 0);
    assert!(capacity < 1.5 * needed, "the prediction is near: {capacity} for {needed}");

    let Some(mut screen) = screen(|_| ()) else { return };
    screen.may_grow = false;
    let dropping = screen.hair(&[&groom]);
    assert!(dropping.counters.dropped > 0);
    screen.renderer.grow_to_measured(&mut *screen.backend, &dropping.counters).unwrap();
    let complete = screen.hair(&[&groom]);
    assert_eq!(complete.counters.dropped, 0, "one frame is enough to know");
    assert!(complete.bytes == picture.bytes);
    let grown = screen.renderer.capacity();
    screen.renderer.grow_to_measured(&mut *screen.backend, &complete.counters).unwrap();
    assert_eq!(screen.renderer.capacity(), grown, "enough is enough");
}

#[test]
fn the_caller_and_the_device_limit_the_pool() {
    let Some(mut screen) = screen(|setup| setup.ppll().max_node_bytes = 16 * 7000) else { return };
    let huge = tressfx_render::Counters { wanted: u32::MAX, ..Default::default() };
    screen.renderer.grow_to_measured(&mut *screen.backend, &huge).unwrap();
    assert_eq!(screen.renderer.capacity(), 7000);
    let mut backend = NullBackend::default();
    let mut renderer = HairRenderer::new(&mut backend, &RenderDesc::new([64, 64], Format::Rgba16F)).unwrap();
    // Two bindings of 128 MiB hold the default budget.
    let most = 2 * Caps::webgpu_default().max_storage_binding_bytes / 16;
    assert_eq!(16 * most, PpllDesc::default().max_node_bytes);
    let many = tressfx_render::Counters { wanted: most as u32, ..huge };
    renderer.grow_to_measured(&mut backend, &many).unwrap();
    assert_eq!(u64::from(renderer.capacity()), most);
    // Kernels with two buffers of nodes have eight in all.
    let mut caps = Caps::webgpu_default();
    caps.max_storage_buffers_per_stage = 7;
    let mut backend = NullBackend::new(caps);
    let mut renderer = HairRenderer::new(&mut backend, &RenderDesc::new([64, 64], Format::Rgba16F)).unwrap();
    renderer.grow_to_measured(&mut backend, &many).unwrap();
    assert_eq!(u64::from(renderer.capacity()), most / 2);
}

#[test]
fn a_screen_beyond_the_device_is_refused_with_the_need() {
    let mut backend = NullBackend::default();
    let refused = |backend: &mut NullBackend, size| {
        HairRenderer::new(backend, &RenderDesc::new(size, Format::Rgba16F)).unwrap_err()
    };
    let error = refused(&mut backend, [9000, 100]);
    assert!(matches!(error, Error::Unsupported { need: Need::TextureEdge(9000), .. }), "{error}");
    let error = refused(&mut backend, [8000, 8000]);
    assert!(matches!(error, Error::Unsupported { need: Need::StorageBindingBytes(512_000_000), .. }), "{error}");
}

#[test]
fn a_new_size_draws_as_a_new_renderer() {
    let groom = Groom::wavy(200, 16, 5, material());
    let Some(mut fresh) = screen(|_| ()) else { return };
    let expected = fresh.hair(&[&groom]);
    let Some(mut screen) = screen(|_| ()) else { return };
    let before = screen.backend_memory();
    screen.renderer.resize(&mut *screen.backend, [300, 17]).unwrap();
    screen.renderer.resize(&mut *screen.backend, [96, 64]).unwrap();
    assert_eq!(screen.backend_memory(), before, "nothing is left behind");
    assert!(screen.hair(&[&groom]).bytes == expected.bytes);
}

#[test]
fn nothing_to_draw_makes_no_pass() {
    let mut backend = NullBackend::default();
    let camera = Camera { depth: DepthOrder::Standard, ..Camera::around(&[Vec3::NEG_ONE, Vec3::ONE], [64, 64]) };
    let view = camera.view([64, 64]).unwrap();
    let mut renderer = HairRenderer::new(&mut backend, &RenderDesc::new([64, 64], Format::Rgba16F)).unwrap();
    let texture = |backend: &mut NullBackend, format| {
        let desc = tressfx_core::backend::TextureDesc::new("test", [64, 64], format);
        tressfx_core::backend::Backend::create_texture(backend, &desc).unwrap()
    };
    let targets = Targets::new(texture(&mut backend, Format::Rgba16F), texture(&mut backend, Format::Depth32F));
    let section = |backend: &mut NullBackend, groom: &Groom| {
        let buffers = StrandBuffers::new(backend, groom.shape, Vec3::ZERO).unwrap();
        ShadedStrands::new(backend, buffers, groom.info.clone()).unwrap()
    };
    let (empty, full) = (Groom::new(&[], material()), Groom::wavy(3, 4, 6, material()));
    let (none, some) = (section(&mut backend, &empty), section(&mut backend, &full));
    let material = material();
    let draw = |section| SectionDraw::new(section, &material, Pose::IDENTITY);
    let mut labels = |draws: &[SectionDraw]| {
        let mut list = PassList::new();
        let lights = Lights::default();
        renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], draws).unwrap();
        list.labels().collect::<Vec<_>>()
    };
    assert!(labels(&[]).is_empty());
    assert!(labels(&[draw(&none)]).is_empty());
    let once = ["hair.render.shade", "hair.render.fill", "hair.render.resolve", "hair.render.composite"];
    assert_eq!(labels(&[draw(&none), draw(&some)]), once);
    let [shade, fill, resolve, composite] = once;
    assert_eq!(labels(&[draw(&some), draw(&some)]), [shade, shade, fill, fill, resolve, composite]);
    let memory = tressfx_core::backend::Backend::memory(&backend).bytes;
    some.destroy(&mut backend);
    renderer.destroy(&mut backend);
    assert!(tressfx_core::backend::Backend::memory(&backend).bytes < memory);
}

#[test]
fn a_counter_that_is_full_stays_full_and_says_so() {
    let groom = Groom::wavy(400, 16, 1, material());
    let Some(mut roomy) = screen(|_| ()) else { return };
    let all = roomy.hair(&[&groom]).counters;
    assert_eq!(all.saturated, 0);
    // From a counter that a few requests fill, over one that groups get to at the same time, to one that just holds all.
    for limit in [1, 64, 4096, all.fragments / 2, all.fragments, all.fragments + 1] {
        let Some(mut screen) = screen(|setup| setup.ppll().count_limit = limit) else { return };
        screen.may_grow = false;
        let many = tressfx_render::Counters { wanted: limit, ..Default::default() };
        screen.renderer.grow_to_measured(&mut *screen.backend, &many).unwrap();
        assert_eq!(screen.renderer.capacity(), limit, "there is no node that cannot be counted");
        let picture = screen.hair(&[&groom]);
        let counters = picture.counters;
        eprintln!("{limit}: {counters:?}");
        assert!(counters.fragments < 2 * limit, "so that 2^31 - 1 keeps it from wrapping: {counters:?}");
        assert_eq!(counters.saturated, u32::from(all.fragments >= limit), "{counters:?}");
        assert_eq!(counters.dropped, counters.fragments.saturating_sub(limit), "{counters:?}");
        if all.fragments <= limit {
            assert_eq!(counters.fragments, all.fragments);
        }
        // A node in two lists would be seen twice: no pixel is more opaque than it is with all of them.
        assert!(picture.pixels().iter().zip(roomy.hair(&[&groom]).pixels()).all(|(a, b)| a.w <= b.w + 0.001));
    }
}

#[test]
fn a_pool_that_grows_between_frames_in_flight_leaves_them_whole() {
    let Some(mut screen) = screen(|_| ()) else { return };
    screen.may_grow = false;
    let groom = Groom::wavy(3000, 16, 4, material());
    let (small, capacity) = (screen.hair(&[&groom]).counters, screen.renderer.capacity());
    assert_eq!(small.dropped, small.fragments - capacity);
    let before = screen.backend_memory();
    screen.renderer.grow_to_measured(&mut *screen.backend, &small).unwrap();
    let grown = screen.renderer.capacity();
    assert!(grown > small.fragments);
    assert_eq!(screen.backend_memory() - before, 16 * u64::from(grown - capacity), "the old nodes are gone");
    assert_eq!(screen.hair(&[&groom]).counters.dropped, 0);
}

#[test]
fn a_minimised_screen_costs_nothing() {
    let mut backend = NullBackend::default();
    let memory = |backend: &NullBackend| tressfx_core::backend::Backend::memory(backend).bytes;
    let desc = RenderDesc::new([640, 480], Format::Rgba16F).shadows(None);
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    let whole = memory(&backend);
    renderer.resize(&mut backend, [0, 480]).unwrap();
    assert!(memory(&backend) < whole / 100, "{} of {whole}", memory(&backend));
    renderer.resize(&mut backend, [640, 480]).unwrap();
    assert_eq!(memory(&backend), whole);
    let mut caps = Caps::webgpu_default();
    (caps.max_storage_binding_bytes, caps.max_buffer_bytes) = (u64::MAX, u64::MAX);
    let mut large = NullBackend::new(caps);
    let huge = HairRenderer::new(&mut large, &RenderDesc::new([8192, 8192], Format::Rgba16F)).unwrap_err();
    assert!(huge.to_string().contains("8192 x 8192"), "{huge}");
}
