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
use tressfx_core::view::{Pose, View};
use tressfx_render::{HairRenderer, Lights, Material, RenderDesc, Section, SectionDraw, Targets};

use support::stage;

fn material() -> Material {
    Material { fibre_radius: Some(0.005), opacity: 0.7, tip_opacity: 0.5, ..Material::default() }
}

#[test]
fn a_full_pool_drops_exactly_what_it_has_no_room_for() {
    let groom = Groom::wavy(400, 16, 1, material());
    let Some(mut roomy) = stage(|_, _| ()) else { return };
    let all = roomy.hair(&[&groom]);
    for capacity in [1, 1000, 6000] {
        let Some(mut stage) = stage(|desc, _| desc.max_node_bytes = 16 * capacity) else { return };
        let picture = stage.hair(&[&groom]);
        assert_eq!(u64::from(stage.renderer.capacity()), capacity);
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
    let Some(mut roomy) = stage(|_, _| ()) else { return };
    let alone = roomy.hair(&[&first]);
    let fits = u64::from(alone.counters.fragments);
    let Some(mut tight) = stage(|desc, _| desc.max_node_bytes = 16 * fits) else { return };
    let both = tight.hair(&[&first, &second]);
    assert!(both.counters.dropped > 10_000, "{:?}", both.counters);
    assert!(both.bytes == alone.bytes, "the first section is there to the bit");
}

#[test]
fn the_pool_is_predicted_and_then_measured() {
    let Some(mut roomy) = stage(|_, _| ()) else { return };
    let groom = Groom::wavy(3000, 16, 4, material());
    let picture = roomy.hair(&[&groom]);
    let (needed, capacity) = (f64::from(picture.counters.fragments), f64::from(roomy.renderer.capacity()));
    eprintln!("{needed} fragments, room for {capacity}");
    assert_eq!(picture.counters.dropped, 0);
    assert!(capacity < 1.5 * needed, "the prediction is near: {capacity} for {needed}");

    let Some(mut stage) = stage(|_, _| ()) else { return };
    stage.may_grow = false;
    let dropping = stage.hair(&[&groom]);
    assert!(dropping.counters.dropped > 0);
    stage.renderer.observe(&mut *stage.backend, &dropping.counters).unwrap();
    let complete = stage.hair(&[&groom]);
    assert_eq!(complete.counters.dropped, 0, "one frame is enough to know");
    assert!(complete.bytes == picture.bytes);
    let grown = stage.renderer.capacity();
    stage.renderer.observe(&mut *stage.backend, &complete.counters).unwrap();
    assert_eq!(stage.renderer.capacity(), grown, "enough is enough");
}

#[test]
fn the_caller_and_the_device_limit_the_pool() {
    let Some(mut stage) = stage(|desc, _| desc.max_node_bytes = 16 * 7000) else { return };
    let huge = tressfx_render::Counters { fragments: u32::MAX, ..Default::default() };
    stage.renderer.observe(&mut *stage.backend, &huge).unwrap();
    assert_eq!(stage.renderer.capacity(), 7000);
    let mut backend = NullBackend::default();
    let mut renderer = HairRenderer::new(&mut backend, &RenderDesc::new([64, 64], Format::Rgba16F)).unwrap();
    renderer.observe(&mut backend, &huge).unwrap();
    assert_eq!(u64::from(renderer.capacity()) * 16, Caps::webgpu_default().max_storage_binding_bytes);
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
    let Some(mut fresh) = stage(|_, _| ()) else { return };
    let expected = fresh.hair(&[&groom]);
    let Some(mut stage) = stage(|_, _| ()) else { return };
    let before = stage.backend_memory();
    stage.renderer.resize(&mut *stage.backend, [300, 17]).unwrap();
    stage.renderer.resize(&mut *stage.backend, [96, 64]).unwrap();
    assert_eq!(stage.backend_memory(), before, "nothing is left behind");
    assert!(stage.hair(&[&groom]).bytes == expected.bytes);
}

#[test]
fn nothing_to_draw_makes_no_pass() {
    let mut backend = NullBackend::default();
    let view = View { depth: DepthOrder::Standard, ..View::around(&[Vec3::NEG_ONE, Vec3::ONE], [64, 64]) };
    let renderer = HairRenderer::new(&mut backend, &RenderDesc::new([64, 64], Format::Rgba16F)).unwrap();
    let texture = |backend: &mut NullBackend, format| {
        let desc = tressfx_core::backend::TextureDesc::new("test", [64, 64], format);
        tressfx_core::backend::Backend::create_texture(backend, &desc).unwrap()
    };
    let targets =
        Targets { color: texture(&mut backend, Format::Rgba16F), depth: texture(&mut backend, Format::Depth32F) };
    let section = |backend: &mut NullBackend, groom: &Groom| {
        let buffers = StrandBuffers::new(backend, groom.shape, Vec3::ZERO).unwrap();
        Section::new(backend, &mut PassList::new(), buffers, groom.info.clone()).unwrap()
    };
    let (empty, full) = (Groom::new(&[], material()), Groom::wavy(3, 4, 6, material()));
    let (none, some) = (section(&mut backend, &empty), section(&mut backend, &full));
    let material = material();
    let draw = |section| SectionDraw { section, material: &material, pose: Pose::IDENTITY };
    let labels = |draws: &[SectionDraw]| {
        let mut list = PassList::new();
        renderer.draw(&mut list, &view, &Lights::default(), &targets, draws);
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
