//! The technique that chooses between lists and tiles.

mod support;

use glam::camera::rh;
use glam::{Mat4, Vec3};
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::backend::{Backend, Caps, DepthOrder, Format, TextureDesc};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::view::{Pose, View, Viewport};
use tressfx_render::{
    AutoDesc, Counters, HairRenderer, Lights, PpllDesc, RenderDesc, SectionDraw, ShadedStrands, Targets, Technique,
    TilesDesc, ViewDraw,
};

use support::hair::material;
use support::screen;

/// Tiles from eight fragments a pixel on, on every device.
fn auto() -> AutoDesc {
    AutoDesc::default().dense(8.0).tiles_on_cpu(true)
}

/// Fragments a pixel that dense hair has more of, but not if it filled all tiles of its bounds.
const UNSURE: f32 = 26.0;

fn with(technique: impl Into<Technique>) -> impl FnOnce(&mut Setup) {
    let technique = technique.into();
    move |setup| setup.technique = technique
}

/// A frame whose counters are looked at.
fn frame(screen: &mut Screen, groom: &Groom) -> Picture {
    let picture = screen.hair(&[groom]);
    screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
    picture
}

#[test]
fn it_changes_when_hair_grows_dense_and_back_and_draws_what_the_chosen_one_draws() {
    let (sparse, dense) = (Groom::wavy(60, 12, 1, material()), Groom::wavy(1500, 16, 3, material()));
    let Some(mut lists) = screen(with(PpllDesc::default())) else { return };
    let Some(mut tiles) = screen(with(TilesDesc::default())) else { return };
    let of_lists = [&sparse, &dense].map(|groom| lists.hair(&[groom]));
    let of_tiles = [&sparse, &dense].map(|groom| tiles.hair(&[groom]));
    assert!(of_lists[1].bytes != of_tiles[1].bytes, "they differ, or this test shows nothing");
    let Some(mut screen) = screen(with(auto().dense(UNSURE))) else { return };
    let mut used = Vec::new();
    for (groom, frames) in [(0, 40), (1, 60), (0, 60), (1, 60)] {
        for _ in 0..frames {
            let uses_tiles = screen.renderer.uses_tiles();
            let picture = frame(&mut screen, [&sparse, &dense][groom]);
            let expected = if uses_tiles { &of_tiles[groom] } else { &of_lists[groom] };
            assert!(picture.bytes == expected.bytes, "tiles {uses_tiles}: {:?}", picture.counters);
            assert_eq!(picture.counters.dropped, 0, "nothing is dropped when the technique changes");
            if used.last() != Some(&uses_tiles) {
                used.push(uses_tiles);
            }
        }
    }
    assert_eq!(used, [false, true, false, true]);
}

#[test]
fn the_technique_that_is_not_used_gives_its_memory_back() {
    let dense = Groom::wavy(1500, 16, 3, material());
    let Some(mut tiles) = screen(with(TilesDesc::default())) else { return };
    tiles.hair(&[&dense]);
    let Some(lists) = screen(with(PpllDesc::default())) else { return };
    let Some(mut screen) = screen(with(auto().dense(UNSURE))) else { return };
    let empty = screen.renderer.technique_bytes();
    assert_eq!(empty, lists.renderer.technique_bytes(), "tiles are made when they are first needed");
    frame(&mut screen, &dense);
    let of_lists = screen.renderer.technique_bytes();
    assert!(of_lists > empty + 1_000_000);
    (0..40).for_each(|_| drop(frame(&mut screen, &dense)));
    assert!(screen.renderer.uses_tiles());
    // Lists that are not in use keep what each pixel has, and 1,024 nodes of 16 bytes instead of one a pixel.
    let [width, height] = screen.view.viewport().target().map(u64::from);
    let idle = empty - 16 * (width * height - 1024);
    assert_eq!(screen.renderer.technique_bytes(), idle + tiles.renderer.technique_bytes());
    screen.renderer.resize(&mut *screen.backend, [96, 64]).unwrap();
    assert!(!screen.renderer.uses_tiles(), "after a new size it begins with lists");
    (0..40).for_each(|_| drop(frame(&mut screen, &dense)));
    assert!(screen.renderer.uses_tiles());
}

#[test]
fn a_density_that_flickers_changes_nothing() {
    let (sparse, dense) = (Groom::wavy(60, 12, 1, material()), Groom::wavy(400, 16, 3, material()));
    let Some(mut screen) = screen(with(auto())) else { return };
    for i in 0..120 {
        frame(&mut screen, if i % 20 < 15 { &dense } else { &sparse });
        assert!(!screen.renderer.uses_tiles());
    }
}

/// Holds the first picture of a dense groom against that of tiles or of lists: settings by what lists count of it, and whether they begin with tiles.
fn begins(cases: impl Fn(&Counters) -> [(AutoDesc, bool); 2]) {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut lists) = screen(with(PpllDesc::default())) else { return };
    let Some(mut tiles) = screen(with(TilesDesc::default())) else { return };
    let [of_lists, of_tiles] = [&mut lists, &mut tiles].map(|screen| screen.hair(&[&groom]));
    for (desc, uses_tiles) in cases(&of_lists.counters) {
        let Some(mut screen) = screen(with(desc)) else { return };
        let picture = screen.hair(&[&groom]);
        assert_eq!(screen.renderer.uses_tiles(), uses_tiles, "{desc:?}");
        let expected = if uses_tiles { &of_tiles } else { &of_lists };
        assert!(picture.bytes == expected.bytes && picture.counters.dropped == 0, "{:?}", picture.counters);
    }
}

#[test]
fn hair_that_is_surely_dense_begins_with_tiles() {
    begins(|counters| {
        assert!(f64::from(counters.fragments / counters.pixels_with_hair) > UNSURE.into(), "{counters:?}");
        [(auto().dense(8.0), true), (auto().dense(UNSURE), false)]
    });
}

#[test]
fn a_view_in_which_hair_is_surely_dense_leaves_room_for_those_before_it() {
    let groom = Groom::wavy(12_000, 4, 3, material());
    let dense = with(auto().dense(250.0));
    let Some(mut screen) = screen(dense) else { return };
    let (camera, depth) = ((screen.view.view_matrix(), screen.view.projection_matrix()), screen.view.depth());
    let of =
        |offset, size| View::new(camera.0, camera.1, depth, Viewport::part(offset, size, [96, 64]).unwrap()).unwrap();
    // No strand is thinner than a pixel: where pixels are larger, each has more of them.
    let views = [of([0, 0], [80, 64]), of([80, 0], [16, 16])];
    screen.views(&views[..1], &[&groom]);
    assert!(!screen.renderer.uses_tiles(), "the first view alone is for lists");
    let picture = screen.views(&views, &[&groom]);
    assert!(screen.renderer.uses_tiles() && picture.counters.dropped == 0, "{:?}", picture.counters);
}

#[test]
fn more_fragments_than_lists_may_hold_are_for_tiles() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let few = PpllDesc::default().max_node_bytes(16 * 20_000);
    let Some(mut screen) = screen(with(auto().dense(1e6).lists(few))) else { return };
    let counters: Vec<Counters> = (0..40).map(|_| frame(&mut screen, &groom).counters).collect();
    assert!(screen.renderer.uses_tiles());
    assert!(counters.iter().all(|counters| counters.dropped == 0));
}

#[test]
fn hair_that_lists_could_not_hold_begins_with_tiles() {
    begins(|counters| {
        let room = |count: u32| PpllDesc::default().max_node_bytes(16 * u64::from(count));
        let cases = [(counters.fragments / 8, true), (2 * counters.fragments, false)];
        cases.map(|(count, uses_tiles)| (auto().dense(1e6).lists(room(count)), uses_tiles))
    });
}

#[test]
fn a_cpu_stays_with_lists() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut screen) = screen(with(auto().tiles_on_cpu(false))) else { return };
    let is_cpu = screen.backend.caps().is_cpu;
    (0..40).for_each(|_| drop(frame(&mut screen, &groom)));
    assert_eq!(screen.renderer.uses_tiles(), !is_cpu, "{}", screen.backend.caps().adapter);
}

#[test]
fn its_settings_change_between_frames() {
    let groom = Groom::wavy(400, 16, 3, material());
    let Some(mut screen) = screen(with(AutoDesc::default())) else { return };
    let three = PpllDesc::default().k(3);
    screen.renderer.retune(&mut *screen.backend, AutoDesc::default().lists(three)).unwrap();
    let Some(mut lists) = support::screen(with(three)) else { return };
    assert!(screen.hair(&[&groom]).bytes == lists.hair(&[&groom]).bytes);
    let refused =
        [Technique::from(three), AutoDesc::default().tiles(TilesDesc::default().max_reference_bytes(4)).into()];
    for technique in refused {
        assert!(screen.renderer.retune(&mut *screen.backend, technique).is_err());
    }
    // Nothing has changed where only a part of it is refused.
    let part = AutoDesc::default().lists(PpllDesc::default()).tiles(TilesDesc::default().places(4));
    assert!(screen.renderer.retune(&mut *screen.backend, part).is_err());
    assert!(screen.hair(&[&groom]).bytes == lists.hair(&[&groom]).bytes);
    let other_places = AutoDesc::default().tiles(TilesDesc::default().places(3));
    let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(other_places);
    let error = HairRenderer::new(&mut NullBackend::default(), &desc).unwrap_err().to_string();
    assert!(error.contains("1, 4, 16 or 64"), "{error}");
}

#[test]
fn more_vertices_than_tiles_can_draw_are_for_lists_at_once() {
    let mut caps = Caps::webgpu_default();
    caps.max_storage_binding_bytes = 1 << 20;
    let mut backend = NullBackend::new(caps);
    let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(auto()).shadows(None);
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    let mut texture = |format| backend.create_texture(&TextureDesc::new("test", [64, 64], format)).unwrap();
    let targets = Targets::new(texture(Format::Rgba16F), texture(Format::Depth32F));
    let groom = Groom::wavy(1500, 16, 3, material());
    let buffers = StrandBuffers::new(&mut backend, groom.shape, Vec3::ZERO).unwrap();
    let section = ShadedStrands::new(&mut backend, buffers, groom.info.clone()).unwrap();
    let draw = SectionDraw::new(&section, &groom.material, Pose::IDENTITY);
    let projection = rh::proj::directx::perspective(0.6, 1.0, 50.0, 0.05);
    let view = View::new(Mat4::from_translation(Vec3::NEG_Z * 3.0), projection, DepthOrder::Reverse, [64, 64]).unwrap();
    let dense = Counters { fragments: 90_000, wanted: 90_000, pixels_with_hair: 2000, ..Counters::default() };
    let mut frame = |sections: usize| {
        let lights = Lights::default();
        let views = [ViewDraw::new(&view, &lights, targets)];
        renderer.draw(&mut PassList::new(), &views, &vec![draw; sections]).unwrap();
        renderer.grow_to_measured(&mut backend, &dense).unwrap();
        renderer.uses_tiles()
    };
    // There is room for 65536 vertices.
    for round in 0..2 {
        let last = (0..60).map(|_| frame(1)).last();
        assert_eq!(last, Some(true), "dense hair is for tiles, round {round}");
        assert!((0..40).all(|_| !frame(3)), "72000 vertices, round {round}");
    }
}
