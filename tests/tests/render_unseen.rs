//! Sections that no view can see are left out: the picture is the same, and they have no passes.

mod support;

use glam::{Quat, Vec3};
use tressfx_conformance::render::{Groom, Random, Screen};
use tressfx_conformance::sim::random_strands;
use tressfx_core::backend::{Backend, DepthOrder, Run};
use tressfx_core::pass::{Command, Grid, Groups, PassList};
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{
    Fill, Light, LightPlace, Lights, PpllDesc, SectionDraw, ShadedStrands, ShadowDesc, ShortCutDesc, StrandInfo,
    Technique, TilesDesc, ViewDraw,
};
use tressfx_sim::{HairSim, SectionDesc, SimParams, Solver, StepInput, Wind};

use support::hair::varied;
use support::{gpu, screen};

/// A groom that stays within 1.2 of its centre, or that nobody knows that of.
fn groom(seed: u32, place: Vec3, is_known: bool) -> Groom {
    let mut groom = Groom::wavy(40, 10, seed, varied());
    let far = groom.positions.iter().map(|p| Vec3::from_slice(p).length()).fold(0.0, f32::max);
    groom.info.reach = (Vec3::ZERO, if is_known { far } else { f32::INFINITY });
    groom.pose.translation = place;
    groom
}

/// A tenth as large.
fn small(seed: u32, place: Vec3, is_known: bool) -> Groom {
    let mut groom = groom(seed, place, is_known);
    groom.positions.iter_mut().flat_map(|position| &mut position[..3]).for_each(|x| *x *= 0.1);
    groom.info.reach.1 *= 0.1;
    groom
}

/// Groups of the passes with this label in what a frame of the grooms writes, and bytes that it clears.
fn resolved_and_cleared(screen: &mut Screen, label: &str, grooms: &[&Groom]) -> (u64, u64) {
    let mut list = PassList::new();
    let sections: Vec<_> = grooms.iter().map(|groom| screen.section(&mut list, groom)).collect();
    let pairs = sections.iter().zip(grooms);
    let draws: Vec<_> = pairs.map(|(strands, groom)| SectionDraw::new(strands, &groom.material, groom.pose)).collect();
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &draws).unwrap();
    let of = |command: &Command| match command {
        Command::Compute(pass) if pass.kernel.label() == label => match pass.groups {
            Groups::Grid(Grid(groups)) => (groups.map(u64::from).iter().product(), 0),
            Groups::Indirect { .. } => (0, 0),
        },
        Command::Clear { bytes, .. } => (0, *bytes),
        _ => (0, 0),
    };
    list.commands().iter().map(of).fold((0, 0), |sum, (groups, bytes)| (sum.0 + groups, sum.1 + bytes))
}

#[test]
fn pixels_that_no_groom_reaches_are_left_out_and_the_picture_is_the_same_to_the_bit() {
    let lists = PpllDesc::default();
    let raster = lists.fill(Fill::Raster);
    let layers = ShortCutDesc::default();
    let techniques: [(Technique, &str); 5] = [
        (lists.into(), "hair.render.resolve"),
        (lists.cap(2).into(), "hair.render.resolve"),
        (raster.into(), "hair.render.resolve"),
        (layers.into(), "hair.render.shortcut_resolve"),
        (layers.ordered(true).into(), "hair.render.shortcut_resolve"),
    ];
    for (technique, label) in techniques {
        // Tiles at the right and at the bottom are cut.
        let made = || screen(|setup| (setup.technique, setup.size) = (technique, [205, 131]));
        let (Some(mut all), Some(mut some)) = (made(), made()) else { return };
        let mut random = Random(7);
        let mut signed = |reach: f32| reach * (2.0 * random.unit() - 1.0);
        for seed in 0..12 {
            let places = [0, 1].map(|_| Vec3::new(signed(1.5), signed(0.9), signed(1.0)));
            let draw = |screen: &mut Screen, is_known: bool| {
                screen.hair(&[&small(1, places[0], is_known), &small(seed, places[1], is_known)])
            };
            let (expected, found) = (draw(&mut all, false), draw(&mut some, true));
            assert!(expected.counters.fragments > 0 && found.counters == expected.counters);
            assert!(found.bytes == expected.bytes, "{technique:?}: grooms at {places:?}");
        }
        let [expected, found] = [(&mut all, false), (&mut some, true)]
            .map(|(screen, is_known)| resolved_and_cleared(screen, label, &[&small(1, Vec3::ZERO, is_known)]));
        assert_eq!(expected.0, 26 * 17, "a group for each tile");
        assert!(found.0 < expected.0 / 20, "{technique:?}: {found:?} of {expected:?}");
        assert!(found.1 < expected.1 / 3, "{technique:?}: {found:?} of {expected:?}");
    }
}

#[test]
fn the_picture_is_the_same_to_the_bit_wherever_a_groom_is() {
    let techniques: [Technique; 2] = [PpllDesc::default().into(), TilesDesc::default().into()];
    for (technique, order) in techniques.into_iter().zip([DepthOrder::Reverse, DepthOrder::Standard]) {
        let made = || {
            screen(|setup| {
                setup.technique = technique;
                setup.camera.depth = order;
            })
        };
        let (Some(mut all), Some(mut some)) = (made(), made()) else { return };
        let mut random = Random(7);
        let mut signed = |reach: f32| reach * (2.0 * random.unit() - 1.0);
        let middle = Vec3::new(0.0, 0.0, 0.0);
        let (mut unseen, mut at_edges) = (0, 0);
        for seed in 0..60 {
            let place = Vec3::new(signed(3.0), signed(2.5), signed(3.0) + 0.5);
            let draw = |screen: &mut Screen, is_known: bool| {
                screen.hair(&[&groom(1, middle, true), &groom(seed, place, is_known)])
            };
            let (expected, found) = (draw(&mut all, false), draw(&mut some, true));
            assert!(found.bytes == expected.bytes, "{technique:?}: a groom at {place}");
            assert_eq!(all.renderer.drawn().sections, 2);
            let drawn = some.renderer.drawn();
            assert_eq!(drawn.sections + drawn.unseen, 2);
            unseen += drawn.unseen;
            at_edges += usize::from(drawn.unseen == 0 && place.truncate().abs().max_element() > 1.0);
        }
        assert!(unseen > 15 && at_edges > 10, "{unseen} of 60 were left out, {at_edges} were at the edge");
    }
}

/// A light from the side, with or without the sky.
fn lights(sky: f32) -> Lights {
    let light = Light::directional(Vec3::new(1.0, 0.0, 0.0), Vec3::ONE);
    Lights { sky: Vec3::splat(sky), ground: Vec3::splat(sky), lights: vec![light] }
}

#[test]
fn an_unseen_groom_throws_its_shadow_and_one_that_throws_none_changes_nothing() {
    let made = || screen(|setup| setup.shadows = Some(ShadowDesc::default()));
    let (Some(mut all), Some(mut some), Some(mut alone)) = (made(), made(), made()) else { return };
    [&mut all, &mut some, &mut alone].into_iter().for_each(|screen| screen.lights = lights(0.2));
    let seen = groom(1, Vec3::ZERO, true);
    let draw =
        |screen: &mut Screen, place: Vec3, is_known: bool| screen.hair(&[&seen, &groom(2, place, is_known)]).bytes;
    // Between the light and the hair that is seen, beyond the edge of the picture.
    let beside = Vec3::new(6.0, 0.0, 0.0);
    assert!(draw(&mut some, beside, true) == draw(&mut all, beside, false));
    assert_eq!([some.renderer.drawn().unseen, some.renderer.drawn().shading], [1, 1]);
    let lit = alone.hair(&[&seen]).bytes;
    assert!(draw(&mut some, beside, true) != lit, "it takes light");
    // On the other side nobody is in its shadow: it is as if it were not there.
    let behind = Vec3::new(-30.0, 0.0, 0.0);
    assert!(draw(&mut some, behind, true) == lit);
    assert_eq!([some.renderer.drawn().unseen, some.renderer.drawn().shading], [1, 0]);
    // A point light that stands between them.
    let point =
        Light { place: LightPlace::Point { position: Vec3::X * 3.0, reach: 4.0, cone: None }, ..lights(0.0).lights[0] };
    some.lights.lights = vec![point];
    draw(&mut some, beside, true);
    assert_eq!(some.renderer.drawn().shading, 0);
}

#[test]
fn of_many_characters_only_those_in_view_have_passes() {
    let Some(mut screen) = screen(|setup| setup.shadows = Some(ShadowDesc::default())) else { return };
    screen.lights = lights(0.2);
    let mut list = PassList::new();
    // Two in view, and 60 behind the eye, in two rows along the light's way to nobody.
    let places = [Vec3::ZERO, Vec3::new(0.4, 0.2, -1.0)].into_iter();
    let places: Vec<Vec3> = places.chain((0..60).map(|i| Vec3::new(i as f32, 0.0, 40.0 + (i % 2) as f32))).collect();
    let grooms: Vec<Groom> = places.iter().map(|&place| groom(3, place, true)).collect();
    let sections: Vec<ShadedStrands> = grooms.iter().map(|groom| screen.section(&mut list, groom)).collect();
    let draws: Vec<SectionDraw> = sections
        .iter()
        .zip(&grooms)
        .map(|(section, groom)| SectionDraw::new(section, &groom.material, groom.pose))
        .collect();
    let views = [ViewDraw::new(&screen.view, &screen.lights, screen.targets())];
    let read = screen.renderer.reads(&views, &draws);
    assert!(read[..2] == [true; 2] && read[2..] == [false; 60], "{read:?}");
    let mut commands = |draws: &[SectionDraw]| {
        let mut list = PassList::new();
        let (targets, view) = (screen.targets(), screen.view);
        screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &screen.lights, targets)], draws).unwrap();
        (list.labels().collect::<Vec<_>>(), list.commands().len(), screen.renderer.drawn())
    };
    let (few, all) = (commands(&draws[..2]), commands(&draws));
    assert_eq!((&all.0, all.1), (&few.0, few.1));
    assert_eq!([all.2.sections, all.2.unseen, all.2.shading], [2, 60, 0]);
    let nobody = commands(&draws[2..]);
    assert!(nobody.0.is_empty(), "{:?}", nobody.0);
    assert_eq!([nobody.2.sections, nobody.2.unseen], [0, 60]);
}

#[test]
fn no_strand_leaves_its_reach() {
    for solver in [Solver::TressFx, Solver::Direct] {
        let Some(mut backend) = gpu() else { return };
        let strands = random_strands(60, 12, 2, 9);
        let mut list = PassList::new();
        let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(solver);
        let mut sim = HairSim::new(&mut *backend, &mut list, &[desc], 0).unwrap();
        let info = StrandInfo::new(&strands);
        let reach = info.reach.0.distance(sim.center()) + info.reach.1;
        let wind = Wind::new(Vec3::new(12.0, 3.0, -7.0));
        for frame in 0..60 {
            let angle = (frame as f32 * 0.3).sin();
            let head = Pose { rotation: Quat::from_rotation_y(angle), translation: Vec3::X * 0.1 * angle };
            sim.step(&mut list, &StepInput::new(1.0 / 60.0, head).with_wind(wind)).unwrap();
            let ticket = sim.read_positions(&mut list)[0];
            backend.run(&list).unwrap();
            list.clear_commands();
            let positions: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&backend.read(ticket).ready().unwrap());
            let far = positions.iter().map(|p| Vec3::from_slice(p).length()).fold(0.0, f32::max);
            assert!(far < reach && reach < 4.0 * far, "{solver:?}, frame {frame}: {far} of {reach}");
        }
    }
}

#[test]
fn planes_are_those_of_any_view() {
    // What is far before the eye or beside it, in an orthographic view too.
    use glam::camera::rh;
    use tressfx_core::view::View;
    let Some(mut screen) = screen(|_| ()) else { return };
    let eye =
        Camera { eye: Vec3::Z * 3.0, target: Vec3::ZERO, fov: 0.6, near: 0.1, far: 50.0, depth: DepthOrder::Standard };
    let flat = rh::proj::directx::orthographic(-1.5, 1.5, -1.0, 1.0, 0.1, 50.0);
    screen.view = View::new(eye.view_matrix(), flat, DepthOrder::Standard, [96, 64]).unwrap();
    for (place, sections) in
        [(Vec3::ZERO, 1), (Vec3::X * 4.0, 0), (Vec3::Y * -3.0, 0), (Vec3::Z * 6.0, 0), (-Vec3::Z * 20.0, 1)]
    {
        screen.hair(&[&groom(1, place, true)]);
        assert_eq!(screen.renderer.drawn().sections, sections, "{place}");
    }
}
