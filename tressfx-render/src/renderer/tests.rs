//! What all techniques have in common.

use tressfx_core::null::NullBackend;

use super::*;
use crate::occlusion::OcclusionUniform;
use crate::ppll::{K_RANGE, Ppll, PpllDesc};
use crate::segments::Fill;
use crate::shortcut::{ShortCut, ShortCutDesc};
use crate::tiles::{Tiles, TilesDesc, TilesUniform};
use crate::uniforms::{
    LensUniform, LightUniform, MotionUniform, OpaqueScenesUniform, OpaqueUniform, SectionUniform, ShadowFrameUniform,
    ShadowUniform, ViewUniform,
};

fn shortcut(backend: &mut NullBackend, k: u32, ordered: bool) -> ShortCut {
    let desc = ShortCutDesc::default().k(k).ordered(ordered);
    ShortCut::new(backend, &desc, [64, 64], Format::Rgba16F).unwrap()
}

fn tiles(backend: &mut NullBackend) -> Tiles {
    Tiles::new(backend, &TilesDesc::default(), [64, 64], Format::Rgba16F).unwrap()
}

#[test]
fn structs_are_laid_out_as_in_the_wgsl() {
    let mut backend = NullBackend::default();
    let shade = Shade::new(&mut backend, true, true).unwrap();
    let ppll = Ppll::new(&mut backend, &PpllDesc::default(), [64, 64], Format::Rgba16F).unwrap();
    let shortcut = shortcut(&mut backend, 3, false);
    let [fill, resolve, composite] = ppll.shaders();
    let [depths, colors, shortcut_resolve, _] = shortcut.shaders();
    for shader in [&*shade.plain.kajiya.open.shader, fill, resolve, composite, depths, colors, shortcut_resolve] {
        shader.check_layout::<ViewUniform>().unwrap();
        shader.check_layout::<LensUniform>().unwrap();
        shader.check_layout::<LightUniform>().unwrap();
    }
    for shader in [&*shade.plain.kajiya.open.shader, &shade.plain.fibre.open.shader, fill, depths, colors] {
        shader.check_layout::<SectionUniform>().unwrap();
    }
    for shader in [fill, resolve, depths, shortcut_resolve] {
        shader.check_layout::<Counters>().unwrap();
    }
    for shader in [fill, resolve] {
        shader.check_layout::<crate::ppll::PoolUniform>().unwrap();
    }
    let shadows = Shadows::new(&mut backend, &ShadowDesc::default(), true).unwrap();
    let [frames @ .., opaque] = shadows.shaders();
    for shader in frames {
        shader.check_layout::<ShadowUniform>().unwrap();
        shader.check_layout::<ShadowFrameUniform>().unwrap();
    }
    opaque.check_layout::<OpaqueUniform>().unwrap();
    opaque.check_layout::<OpaqueScenesUniform>().unwrap();
    let velocity = Velocity::new(&mut backend, [64, 64], true).unwrap();
    for shader in velocity.shaders() {
        shader.check_layout::<ViewUniform>().unwrap();
        shader.check_layout::<SectionUniform>().unwrap();
    }
    velocity.shaders()[1..].iter().for_each(|shader| shader.check_layout::<MotionUniform>().unwrap());
    let tiles = tiles(&mut backend);
    let [points, depth, bin, alloc, blend, reopen] = tiles.shaders();
    for shader in [points, depth, bin, alloc, blend, reopen] {
        shader.check_layout::<ViewUniform>().unwrap();
        shader.check_layout::<LensUniform>().unwrap();
    }
    points.check_layout::<SectionUniform>().unwrap();
    blend.check_layout::<Counters>().unwrap();
    for shader in [depth, bin, alloc, blend, reopen] {
        shader.check_layout::<TilesUniform>().unwrap();
    }
}

#[test]
fn every_kernel_fits_the_limits_of_webgpu() {
    let mut backend = NullBackend::default();
    let shade = Shade::new(&mut backend, true, true).unwrap();
    assert!(shade.plain.kajiya.shadowed.unwrap().shader.storage_buffers() == 4);
    let shade = shade.plain.fibre.shadowed.unwrap();
    let of_one_binding = PpllDesc::default().max_node_bytes(backend.caps().max_storage_binding_bytes);
    let with_more = [(of_one_binding, "shaded", 6), (PpllDesc::default(), "shaded more_nodes", 7)];
    for (k, (desc, features, most)) in K_RANGE.flat_map(|k| with_more.map(|desc| (k, desc))) {
        let ppll = Ppll::new(&mut backend, &desc.k(k), [64, 64], Format::Rgba8Srgb).unwrap();
        let [fill, resolve, composite] = ppll.shaders();
        assert_eq!(resolve.features, format!("{features} K={k}"));
        let counts = [&*shade.shader, fill, resolve, composite].map(|shader| shader.storage_buffers());
        assert_eq!(counts.into_iter().max(), Some(most), "{counts:?}: what `check` asks for");
    }
    for (k, ordered) in ShortCutDesc::K_RANGE.flat_map(|k| [(k, false), (k, true)]) {
        let counts = shortcut(&mut backend, k, ordered).shaders().map(|shader| shader.storage_buffers());
        assert_eq!(counts.into_iter().max(), Some(7), "{counts:?}: what `check` asks for");
    }
    let mut hiding = NullBackend::default();
    for lists in [PpllDesc::default(), PpllDesc::default().cap(8)] {
        let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(lists.skips_hidden(true));
        HairRenderer::new(&mut hiding, &desc.hair_output(true)).unwrap();
    }
    let mut of_occlusion = 0;
    for shader in &hiding.shaders {
        assert!(shader.storage_buffers() <= 8, "{shader:?}: what `check` asks for");
        let is_own = shader.label.starts_with("hair.render.occlusion_");
        of_occlusion += u32::from(is_own);
        if is_own && !shader.label.ends_with("_list") {
            shader.check_layout::<OcclusionUniform>().unwrap();
        }
    }
    assert_eq!(of_occlusion, 2 * 5);
    let shadows = Shadows::new(&mut backend, &ShadowDesc::default(), true).unwrap();
    assert!(shadows.shaders().into_iter().all(|shader| shader.storage_buffers() <= 5));
    let velocity = Velocity::new(&mut backend, [64, 64], true).unwrap();
    assert!(velocity.shaders().iter().all(|shader| shader.storage_buffers() <= 5));
    let counts = tiles(&mut backend).shaders().map(|shader| shader.storage_buffers());
    assert_eq!(counts.into_iter().max(), Some(8), "{counts:?}: what `check` asks for");
    let lists = PpllDesc::default().fill(Fill::Raster);
    let lists = Ppll::new(&mut backend, &lists, [64, 64], Format::Rgba8Srgb).unwrap();
    let layers = ShortCutDesc::default().fill(Fill::Raster);
    let layers = ShortCut::new(&mut backend, &layers, [64, 64], Format::Rgba8Srgb).unwrap();
    for shader in lists.shaders().into_iter().chain(layers.shaders()) {
        assert!(shader.storage_buffers() <= 7, "{shader:?}");
        assert_eq!(shader.writes_in_fragments(), shader.label.ends_with("_raster"), "{shader:?}");
    }
}

#[test]
fn depth_of_hair_takes_no_storage_buffer_of_its_own() {
    let layers = ShortCutDesc::default();
    let techniques: [Technique; 5] = [
        PpllDesc::default().into(),
        PpllDesc::default().cap(8).into(),
        layers.into(),
        layers.ordered(true).into(),
        TilesDesc::default().into(),
    ];
    for technique in techniques {
        let [without, with] = [false, true].map(|hair| {
            let mut backend = NullBackend::default();
            technique.make(&mut backend, [64, 64], Output { hair, copies: true, ..Format::Rgba16F.into() }).unwrap();
            backend.shaders.iter().map(|shader| (shader.label, shader.storage_buffers())).collect::<Vec<_>>()
        });
        assert_eq!(with, without, "{technique:?}");
    }
}

#[test]
fn a_k_out_of_range_is_an_error_that_says_the_range() {
    let mut backend = NullBackend::default();
    let mut refused = |technique: Technique| {
        let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(technique);
        HairRenderer::new(&mut backend, &desc).unwrap_err().to_string()
    };
    let said = "hair.render.ppll: k is 33, it must be from 0 to 32";
    assert_eq!(refused(PpllDesc::default().k(33).into()), said);
    for k in [0, 9] {
        let said = format!("hair.render.shortcut: k is {k}, it must be from 1 to 8");
        assert_eq!(refused(ShortCutDesc::default().k(k).into()), said);
    }
}

#[test]
fn a_technique_knows_what_it_takes() {
    let techniques: [Technique; 4] = [
        PpllDesc::default().into(),
        PpllDesc::default().cap(5).into(),
        ShortCutDesc::default().into(),
        ShortCutDesc::default().ordered(true).k(8).into(),
    ];
    for technique in techniques {
        for (size, hair) in [[96, 64], [1, 1], [0, 7]].into_iter().flat_map(|size| [(size, false), (size, true)]) {
            let output = Output { hair, copies: true, ..Format::Rgba16F.into() };
            let mut backend = NullBackend::default();
            let made = technique.make(&mut backend, size, output).unwrap();
            assert_eq!(made.bytes(), backend.memory().bytes, "{technique:?} at {size:?}");
        }
    }
    let mut backend = NullBackend::default();
    let mut pool = Ppll::new(&mut backend, &PpllDesc::default(), [96, 64], Format::Rgba16F).unwrap();
    pool.reserve(&mut backend, 100_000).unwrap();
    pool.resize(&mut backend, [33, 20]).unwrap();
    pool.reserve(&mut backend, 50_000).unwrap();
    assert_eq!(pool.bytes(), backend.memory().bytes);
}
