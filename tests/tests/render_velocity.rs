//! The motion of hair on the screen: against motion that is known, against the f64 reference, and beside a picture that it does not change.

mod support;

use glam::camera::rh;
use glam::{DVec2, DVec4, Mat4, Quat, Vec2, Vec3};
use tressfx_conformance::render::{Groom, Setup};
use tressfx_core::backend::{DepthOrder, Format, Run, TextureDesc};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Load, PassList, RasterPass};
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    AutoDesc, DrawError, Fill, HairRenderer, Lod, PpllDesc, RenderDesc, SectionDraw, ShadedStrands, ShortCutDesc,
    Targets, Technique, TilesDesc, VELOCITY_FORMAT, ViewDraw, reference,
};

use support::hair::{faint, varied};
use support::{backends, gpu};

const SIZE: [u32; 2] = [96, 64];

/// What pixels without hair are cleared to.
const NO_HAIR: [f32; 2] = [-700.0, 900.0];

/// What the issue allows, pixels.
const ALLOWED: f64 = 0.05;

fn techniques() -> Vec<Technique> {
    let (lists, layers) = (PpllDesc::default(), ShortCutDesc::default());
    vec![
        lists.into(),
        lists.cap(3).fill(Fill::Raster).into(),
        layers.into(),
        layers.ordered(true).into(),
        TilesDesc::default().into(),
        AutoDesc::default().into(),
    ]
}

/// A groom now, and where its vertices were.
struct Moved {
    groom: Groom,
    past: Groom,
}

/// What is drawn to, and with.
struct Stage {
    backend: Box<dyn Run>,
    renderer: HairRenderer,
    targets: Targets,
    color: TextureId,
}

impl Stage {
    fn new(mut backend: Box<dyn Run>, technique: Technique, velocity: bool) -> Self {
        let desc = RenderDesc::new(SIZE, Format::Rgba16F).technique(technique).shadows(None).velocity_output(velocity);
        let renderer = HairRenderer::new(&mut *backend, &desc).unwrap();
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, SIZE, format)).unwrap();
        let color = texture("test.color", Format::Rgba16F);
        let mut targets = Targets::new(color, texture("test.depth", Format::Depth32F));
        if velocity {
            targets = targets.velocity(texture("test.velocity", VELOCITY_FORMAT));
        }
        Self { backend, renderer, targets, color }
    }

    fn section(&mut self, list: &mut PassList, groom: &Groom) -> (StrandBuffers, ShadedStrands) {
        let buffers = StrandBuffers::new(&mut *self.backend, groom.shape, Vec3::ZERO).unwrap();
        list.upload(buffers.tangents, 0, &groom.tangents);
        list.upload(buffers.thickness, 0, &groom.thickness);
        let strands = ShadedStrands::new(&mut *self.backend, buffers, groom.info.clone()).unwrap();
        (buffers, strands.with_past(&mut *self.backend).unwrap())
    }

    /// Motion of the pixels and the picture, where hair was in its past with `has_past`.
    fn draw(&mut self, views: &[View], grooms: &[&Moved], has_past: bool) -> (Vec<[f32; 2]>, Vec<u8>) {
        let mut list = PassList::new();
        let mut sections = Vec::new();
        for moved in grooms {
            let (buffers, mut strands) = self.section(&mut list, &moved.groom);
            if has_past {
                list.upload(buffers.positions, 0, &moved.past.positions);
                strands.keep_past(&mut list, moved.past.pose).unwrap();
            }
            list.upload(buffers.positions, 0, &moved.groom.positions);
            sections.push((buffers, strands));
        }
        let draws: Vec<_> = sections
            .iter()
            .zip(grooms)
            .map(|((_, strands), Moved { groom, .. })| {
                SectionDraw::new(strands, &groom.material, groom.pose).lod(groom.lod)
            })
            .collect();
        let far = views[0].depth().far();
        let clear = RasterPass::new("test.clear").color(self.color, Load::Clear([0.0; 4]));
        list.raster(clear.depth(self.targets.depth, Load::Clear(far)));
        if let Some(velocity) = self.targets.velocity {
            let nothing = [NO_HAIR[0], NO_HAIR[1], 0.0, 0.0];
            list.raster(RasterPass::new("test.clear_velocity").color(velocity, Load::Clear(nothing)));
        }
        let lights = tressfx_conformance::scene::lights();
        let drawn: Vec<_> = views.iter().map(|view| ViewDraw::new(view, &lights, self.targets)).collect();
        for view in views {
            self.renderer.grow_to_predicted(&mut *self.backend, view, &draws).unwrap();
        }
        self.renderer.draw(&mut list, &drawn, &draws).unwrap();
        let picture = list.read_texture(self.color);
        let velocity = self.targets.velocity.map(|velocity| list.read_texture(velocity));
        let picture = tressfx_conformance::run_and_read(&mut *self.backend, &list, picture);
        let velocity = velocity.map(|ticket| self.backend.read(ticket).ready().unwrap());
        for (buffers, strands) in sections {
            strands.destroy(&mut *self.backend);
            buffers.destroy(&mut *self.backend);
        }
        (velocity.map_or_else(Vec::new, |bytes| bytemuck::pod_collect_to_vec(&bytes)), picture)
    }
}

fn camera(depth: DepthOrder) -> Camera {
    Camera { depth, ..Setup::default().camera }
}

/// A projection that moves the picture by so many pixels to the right and down.
fn jittered(projection: Mat4, jitter: Vec2) -> Mat4 {
    let shift = 2.0 * jitter / Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
    Mat4::from_translation(Vec3::new(shift.x, -shift.y, 0.0)) * projection
}

/// The view of `now` with the camera of the frame before, both with a jitter.
fn view(now: &Camera, before: &Camera, jitter: [Vec2; 2]) -> View {
    let [now, before] = [(now, jitter[0]), (before, jitter[1])]
        .map(|(camera, jitter)| (camera.view_matrix(), jittered(camera.projection_matrix(SIZE), jitter)));
    let view = View::new(now.0, now.1, camera(DepthOrder::Reverse).depth, SIZE).unwrap();
    view.with_previous(before.0, before.1).with_jitter(jitter[0], jitter[1])
}

fn still(view: &Camera) -> View {
    view.view(SIZE).unwrap()
}

/// Where a point of the world is, pixels.
fn pixel(camera: &Camera, point: Vec3) -> DVec2 {
    let clip = camera.projection_matrix(SIZE).as_dmat4() * camera.view_matrix().as_dmat4();
    let at = clip.project_point3(point.as_dvec3());
    0.5 * DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1])) * DVec2::new(1.0 + at.x, 1.0 - at.y)
}

/// The pixels with motion, and whether it is there that hair is.
fn with_hair(velocity: &[[f32; 2]]) -> impl Iterator<Item = ([u32; 2], DVec2)> {
    let found = velocity.iter().enumerate().filter(|(_, motion)| **motion != NO_HAIR);
    found.map(|(i, m)| ([i as u32 % SIZE[0], i as u32 / SIZE[0]], DVec2::new(m[0].into(), m[1].into())))
}

/// Strands that face the eye side by side at z 0.
fn upright(offset: Vec3) -> Groom {
    let strand = |i: i32| {
        let root = Vec3::new(0.13 * i as f32, 0.5, 0.0) + offset;
        (0..8).map(|v| root - Vec3::Y * 0.14 * v as f32).collect::<Vec<_>>()
    };
    let material = varied().with(|material| material.fibre_radius = Some(0.02));
    Groom::new(&(-4..5).map(strand).collect::<Vec<_>>(), material)
}

#[test]
fn strands_that_move_across_the_eye_have_that_motion_in_every_pixel() {
    // 3 in front of the eye a unit is so many pixels.
    let scale = f64::from(SIZE[1]) / (2.0 * (0.3f64).tan() * 3.0);
    for (technique, order) in
        techniques().into_iter().flat_map(|t| [DepthOrder::Reverse, DepthOrder::Standard].map(|order| (t, order)))
    {
        for backend in backends() {
            let mut stage = Stage::new(backend, technique, true);
            for shift in [Vec3::new(0.11, -0.07, 0.0), Vec3::new(-1.7, 0.4, 0.0)] {
                let moved = Moved { groom: upright(Vec3::ZERO), past: upright(-shift) };
                let (velocity, _) = stage.draw(&[still(&camera(order))], &[&moved], true);
                let expected = scale * DVec2::new(f64::from(shift.x), -f64::from(shift.y));
                let mut count = 0;
                for (pixel, motion) in with_hair(&velocity) {
                    assert!((motion - expected).length() < 1e-3, "{technique:?} {pixel:?}: {motion}, not {expected}");
                    count += 1;
                }
                assert!(count > 400, "{technique:?}: {count} pixels");
            }
        }
    }
}

#[test]
fn a_head_that_turns_and_moves_is_right_to_a_twentieth_of_a_pixel() {
    // The head before and now; its hair is a plane of strands that the eye sees at an angle.
    let turn = |angle: f32, place: Vec3| Pose { rotation: Quat::from_rotation_y(angle), translation: place };
    let (now, before) = (turn(0.5, Vec3::new(0.1, 0.0, 0.3)), turn(0.3, Vec3::new(0.0, -0.05, 0.1)));
    let groom = Groom { pose: now, ..upright(Vec3::ZERO) };
    let past = Groom { pose: before, ..upright(Vec3::ZERO) };
    let eye = camera(DepthOrder::Reverse);
    let axes = axes(&eye, &now);
    for technique in techniques() {
        for backend in backends() {
            let mut stage = Stage::new(backend, technique, true);
            let moved = Moved { groom: groom.clone(), past: past.clone() };
            let (velocity, _) = stage.draw(&[still(&eye)], &[&moved], true);
            let (mut count, mut worst) = (0, 0.0f64);
            for (at, motion) in with_hair(&velocity) {
                // The point of an axis that is nearest on the screen.
                let middle = DVec2::new(f64::from(at[0]), f64::from(at[1])) + 0.5;
                let distance = |axis: &&(DVec2, Vec3)| axis.0.distance_squared(middle);
                let &(_, point) = axes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
                let expected = pixel(&eye, now.transform(point)) - pixel(&eye, before.transform(point));
                worst = worst.max((motion - expected).length());
                count += 1;
            }
            assert!(count > 400 && worst < ALLOWED, "{technique:?}: {worst} in {count} pixels");
        }
    }
}

/// Points of the axes of all strands of [`upright`], and where they are on the screen.
fn axes(eye: &Camera, pose: &Pose) -> Vec<(DVec2, Vec3)> {
    const STEPS: i32 = 3000;
    let strands = (-4..5).map(|i| 0.13 * i as f32);
    let points =
        strands.flat_map(|x| (0..=STEPS).map(move |i| Vec3::new(x, 0.5 - 0.98 * i as f32 / STEPS as f32, 0.0)));
    points.map(|point| (pixel(eye, pose.transform(point)), point)).collect()
}

#[test]
fn a_camera_that_moves_with_jitter_is_as_in_f64() {
    let before =
        Camera { eye: Vec3::new(-0.2, 0.1, 3.2), target: Vec3::new(0.05, 0.0, 0.0), ..camera(DepthOrder::Reverse) };
    let now = Camera { fov: 0.62, ..camera(DepthOrder::Reverse) };
    let jitter = [Vec2::new(0.37, -0.21), Vec2::new(-0.45, 0.13)];
    let view = view(&now, &before, jitter);
    // The first one is drawn with less detail.
    let lod = Lod { share: 0.6, step: 3 };
    let grooms = [Groom { lod, ..Groom::wavy(60, 12, 5, faint()) }, Groom::wavy(120, 16, 3, varied())];
    let moved = grooms.map(|groom| {
        let mut past = groom.clone();
        past.positions.iter_mut().for_each(|p| p[0] += 0.1 * p[1] * p[1] - 0.02);
        past.pose.translation = Vec3::new(0.0, 0.03, -0.2);
        Moved { groom, past }
    });
    for has_past in [true, false] {
        let references: Vec<_> = moved.iter().map(|moved| fragments(&view, moved, has_past)).collect();
        for technique in techniques() {
            let mut both = Vec::new();
            for backend in backends() {
                let mut stage = Stage::new(backend, technique, true);
                let (velocity, _) = stage.draw(&[view], &[&moved[0], &moved[1]], has_past);
                hold(&format!("{technique:?}, past {has_past}"), &velocity, &references);
                both.push(velocity);
            }
            assert!(both.windows(2).all(|pair| pair[0] == pair[1]), "{technique:?}: the backends differ");
        }
    }
}

/// What a fragment of a pixel may move by: its nearness, alpha and motion.
type Motions = Vec<Vec<(f64, f64, DVec2)>>;

/// The fragments of each pixel with their motion.
fn fragments(view: &View, moved: &Moved, has_past: bool) -> Motions {
    let strands = moved.groom.reference();
    let past = if has_past { moved.past.reference() } else { moved.groom.reference() };
    let lights = tressfx_conformance::scene::lights();
    let vertices = (0..strands.uniform.vertices).flat_map(|v| (0..strands.uniform.strands).map(move |s| (s, v)));
    let colors: Vec<DVec4> = vertices.map(|(s, v)| reference::shade(view, &lights, &strands, s, v)).collect();
    let mut pixels = vec![Vec::new(); (SIZE[0] * SIZE[1]) as usize];
    let far = view.depth().far();
    reference::fill(view, &strands, &colors, &|_| far, &mut |fragment| {
        let motion = reference::velocity(view, &strands, &past, fragment.segment, fragment.pixel);
        let place = (fragment.pixel[1] * SIZE[0] + fragment.pixel[0]) as usize;
        pixels[place].push((fragment.nearness, fragment.alpha, motion));
    });
    pixels
}

/// Holds each pixel to the motion of the fragment that it is seen to have; one within rounding of it may be meant.
fn hold(name: &str, velocity: &[[f32; 2]], sections: &[Motions]) {
    const ROUNDING: f64 = 2e-6;
    let (mut count, mut many) = (0, 0);
    for (i, motion) in velocity.iter().enumerate() {
        let all: Vec<_> = sections.iter().flat_map(|section| &section[i]).collect();
        let key = |f: &(f64, f64, DVec2)| (f.1 >= 0.02, f.0);
        let seen = all.iter().map(|f| key(f)).max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Some((_, nearness)) = seen else {
            assert_eq!(*motion, NO_HAIR, "{name}: pixel {i} has no hair");
            continue;
        };
        // What is nearer may count if its alpha is within rounding of being faint.
        let may = |f: &&&(f64, f64, DVec2)| (f.0 - nearness).abs() < ROUNDING || (f.1 - 0.02).abs() < 1e-4;
        if *motion == NO_HAIR {
            assert!(all.iter().all(|f| f.1 < 1e-4), "{name}: pixel {i} has {all:?}");
            continue;
        }
        let found = DVec2::new(motion[0].into(), motion[1].into());
        let error = all.iter().filter(may).map(|f| f.2.distance(found)).fold(f64::INFINITY, f64::min);
        assert!(error < ALLOWED, "{name}: pixel {i} has {found}, {error} off, of {all:?}");
        count += 1;
        many += usize::from(all.len() > 1);
    }
    assert!(count > 1000 && many > 500, "{name}: {count} pixels, {many} with several fragments");
}

#[test]
fn without_a_past_hair_moves_as_the_camera_does_and_jitter_is_no_motion() {
    let eye = camera(DepthOrder::Reverse);
    let groom = Moved { groom: upright(Vec3::ZERO), past: upright(Vec3::ONE) };
    let jitter = [Vec2::new(0.4, 0.3), Vec2::new(-0.2, 0.1)];
    for backend in backends() {
        let mut stage = Stage::new(backend, PpllDesc::default().into(), true);
        for view in [still(&eye), view(&eye, &eye, jitter)] {
            let (velocity, _) = stage.draw(&[view], &[&groom], false);
            let motions: Vec<_> = with_hair(&velocity).collect();
            assert!(motions.len() > 400);
            assert!(motions.iter().all(|(_, motion)| motion.length() < 1e-4), "{motions:?}");
        }
    }
}

#[test]
fn far_from_the_origin_it_is_as_exact() {
    let away = Vec3::new(4096.0, 256.0, -2048.0);
    let shift = Vec3::new(0.11, -0.07, 0.0);
    let moved_by = |camera: &Camera| Camera { eye: camera.eye + away, target: camera.target + away, ..*camera };
    let eye = moved_by(&camera(DepthOrder::Reverse));
    let at = |translation: Vec3| Pose { translation, ..Pose::IDENTITY };
    let groom = Groom { pose: at(away), ..upright(Vec3::ZERO) };
    let moved = Moved { past: Groom { pose: at(away - shift), ..groom.clone() }, groom };
    let before = away - shift;
    let real = (away - before).as_dvec3();
    let expected = f64::from(SIZE[1]) / (6.0 * (0.3f64).tan()) * DVec2::new(real.x, -real.y);
    for backend in backends() {
        let mut stage = Stage::new(backend, TilesDesc::default().into(), true);
        let (velocity, _) = stage.draw(&[still(&eye)], &[&moved], true);
        let worst = with_hair(&velocity).map(|(_, motion)| (motion - expected).length()).fold(0.0, f64::max);
        assert!(with_hair(&velocity).count() > 400 && worst < ALLOWED, "{worst}");
    }
}

#[test]
fn what_was_behind_the_eye_has_no_motion() {
    let moved = Moved { groom: upright(Vec3::ZERO), past: upright(Vec3::Z * 5.0) };
    for backend in backends() {
        let mut stage = Stage::new(backend, PpllDesc::default().into(), true);
        let (velocity, _) = stage.draw(&[still(&camera(DepthOrder::Reverse))], &[&moved], true);
        assert!(with_hair(&velocity).count() > 400 && with_hair(&velocity).all(|(_, motion)| motion == DVec2::ZERO));
    }
}

#[test]
fn the_picture_is_the_same_and_who_does_not_ask_pays_nothing() {
    let groom = Groom::wavy(200, 16, 3, varied());
    let moved = Moved { past: groom.clone(), groom };
    let eye = still(&camera(DepthOrder::Reverse));
    for technique in techniques() {
        for (asks, plain) in backends().into_iter().zip(backends()) {
            let [mut asks, mut plain] = [(asks, true), (plain, false)].map(|(b, asks)| Stage::new(b, technique, asks));
            let pictures = [&mut asks, &mut plain].map(|stage| stage.draw(&[eye], &[&moved], false).1);
            assert!(pictures[0] == pictures[1], "{technique:?}");
            assert_eq!([&asks, &plain].map(|stage| stage.renderer.velocity_bytes()), [8 * 96 * 64, 0]);
            assert_eq!(asks.renderer.technique_bytes(), plain.renderer.technique_bytes());
            let labels = [asks, plain].map(|mut stage| labels(&mut stage, &moved.groom));
            let more: Vec<_> = labels[0].iter().filter(|label| !labels[1].contains(label)).copied().collect();
            assert_eq!(more, ["hair.render.seen_keys", "hair.render.seen_segments", "hair.render.velocity"]);
            assert_eq!(labels[0].len(), labels[1].len() + 3);
        }
    }
}

/// Labels of the passes of a frame.
fn labels(stage: &mut Stage, groom: &Groom) -> Vec<&'static str> {
    let mut list = PassList::new();
    let (_, strands) = stage.section(&mut list, groom);
    let (lights, eye) = (tressfx_conformance::scene::lights(), still(&camera(DepthOrder::Reverse)));
    let draw = SectionDraw::new(&strands, &groom.material, groom.pose);
    stage.renderer.grow_to_predicted(&mut *stage.backend, &eye, &[draw]).unwrap();
    stage.renderer.draw(&mut list, &[ViewDraw::new(&eye, &lights, stage.targets)], &[draw]).unwrap();
    list.labels().collect()
}

#[test]
fn mistakes_are_errors_that_say_what_is_missing() {
    let groom = upright(Vec3::ZERO);
    let lights = tressfx_conformance::scene::lights();
    let eye = still(&camera(DepthOrder::Reverse));
    let Some(backend) = gpu() else { return };
    let mut stage = Stage::new(backend, PpllDesc::default().into(), true);
    let mut list = PassList::new();
    let (buffers, strands) = stage.section(&mut list, &groom);
    let mut bare = ShadedStrands::new(&mut *stage.backend, buffers, groom.info.clone()).unwrap();
    let without = Targets::new(stage.targets.color, stage.targets.depth);
    let mut says = |view: &View, targets: Targets, strands: &ShadedStrands| {
        let draw = SectionDraw::new(strands, &groom.material, groom.pose);
        stage.renderer.draw(&mut list, &[ViewDraw::new(view, &lights, targets)], &[draw])
    };
    let targets = stage.targets;
    assert_eq!(says(&eye, without, &strands), Err(DrawError::NoVelocityTarget));
    assert_eq!(says(&eye, targets, &bare), Err(DrawError::NoPast));
    let broken = eye.with_previous(Mat4::NAN, Mat4::IDENTITY);
    assert_eq!(says(&broken, targets, &strands), Err(DrawError::PreviousView));
    assert_eq!(says(&eye.with_jitter(Vec2::NAN, Vec2::ZERO), targets, &strands), Err(DrawError::PreviousView));
    assert_eq!(bare.keep_past(&mut PassList::new(), Pose::IDENTITY), Err(DrawError::NoPast));
    let Some(backend) = gpu() else { return };
    let mut plain = Stage::new(backend, PpllDesc::default().into(), false);
    let (_, strands) = plain.section(&mut PassList::new(), &groom);
    let draw = SectionDraw::new(&strands, &groom.material, groom.pose);
    let drawn = [ViewDraw::new(&eye, &lights, targets)];
    assert_eq!(plain.renderer.draw(&mut PassList::new(), &drawn, &[draw]), Err(DrawError::UnusedVelocityTarget));
}

#[test]
fn views_of_one_frame_have_cameras_of_their_own() {
    use tressfx_core::view::Viewport;
    let projection = rh::proj::directx::perspective(0.6, 0.75, 50.0, 0.05);
    let eye = |x: f32| rh::view::look_at_mat4(Vec3::new(x, 0.0, 3.0), Vec3::new(x, 0.0, 0.0), Vec3::Y);
    let part = |offset: u32, moved: f32| {
        let viewport = Viewport::part([offset, 0], [48, 64], SIZE).unwrap();
        let view = View::new(eye(0.0), projection, DepthOrder::Reverse, viewport).unwrap();
        view.with_previous(eye(moved), projection)
    };
    let groom = Moved { groom: upright(Vec3::ZERO), past: upright(Vec3::ZERO) };
    let scale = f64::from(SIZE[1]) / (6.0 * (0.3f64).tan());
    for backend in backends() {
        let mut stage = Stage::new(backend, TilesDesc::default().into(), true);
        let (velocity, _) = stage.draw(&[part(0, 0.1), part(48, -0.2)], &[&groom], true);
        let mut counts = [0, 0];
        for (at, motion) in with_hair(&velocity) {
            let second = at[0] >= 48;
            let expected = DVec2::X * scale * if second { -0.2 } else { 0.1 };
            assert!((motion - expected).length() < 1e-3, "{at:?}: {motion}");
            counts[usize::from(second)] += 1;
        }
        assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
    }
}
