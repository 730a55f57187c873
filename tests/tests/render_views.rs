//! Views from the matrices of an engine, against the picture in f64 that is projected with the whole matrix, on both backends.

mod support;

use glam::camera::{lh, rh};
use glam::{Mat4, Quat, Vec3};
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_conformance::render::{Difference, Groom, Screen, Setup};
use tressfx_core::backend::{DepthOrder, Format, Run};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::view::{Pose, View, ViewError, Viewport};
use tressfx_render::{DrawError, HairRenderer, Light, Lights, Material, RenderDesc, SectionDraw, TilesDesc, ViewDraw};

use support::{gpu, screen};

const SIZE: [u32; 2] = [96, 64];
const ASPECT: f32 = 1.5;
const STANDARD: DepthOrder = DepthOrder::Standard;
const REVERSE: DepthOrder = DepthOrder::Reverse;

fn groom() -> Groom {
    let material = Material::default().with(|m| {
        m.fibre_radius = Some(0.005);
        (m.opacity, m.tip_opacity) = (0.7, 0.5);
    });
    Groom::wavy(60, 12, 1, material)
}

fn plain() -> Mat4 {
    rh::view::look_at_mat4(Vec3::new(0.6, 0.4, 2.9), Vec3::ZERO, Vec3::Y)
}

/// Name, world to view, view to clip, order of depth.
fn views() -> Vec<(&'static str, Mat4, Mat4, DepthOrder)> {
    use rh::proj::directx::{frustum, orthographic, perspective, perspective_infinite, perspective_infinite_reverse};
    let rolled = Mat4::from_quat(Quat::from_rotation_z(0.7)) * plain();
    let left_handed = Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0)) * plain();
    let reverse = perspective(0.6, ASPECT, 50.0, 0.05);
    let jitter = Mat4::from_translation(Vec3::new(0.37 * 2.0 / 96.0, -0.21 * 2.0 / 64.0, 0.0));
    vec![
        ("rolled", rolled, reverse, REVERSE),
        ("off-axis", plain(), frustum(-0.02, 0.04, -0.03, 0.015, 0.05, 50.0), STANDARD),
        ("orthographic", rolled, orthographic(-1.4, 1.1, -0.9, 0.8, 0.1, 10.0), STANDARD),
        ("orthographic, reverse", plain(), orthographic(-1.2, 1.2, -0.8, 0.8, 10.0, -3.0), REVERSE),
        ("jittered", plain(), jitter * reverse, REVERSE),
        ("infinite", plain(), perspective_infinite(0.6, ASPECT, 0.05), STANDARD),
        ("infinite, reverse", plain(), perspective_infinite_reverse(0.6, ASPECT, 0.05), REVERSE),
        ("wide pixels", plain(), perspective(0.6, 2.5, 50.0, 0.05), REVERSE),
        ("left-handed", left_handed, lh::proj::directx::perspective(0.6, ASPECT, 0.05, 50.0), STANDARD),
        ("mirrored", Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)) * plain(), reverse, REVERSE),
        ("scaled", Mat4::from_scale(Vec3::splat(100.0)) * plain(), perspective(0.6, ASPECT, 5000.0, 5.0), REVERSE),
        ("sheared", plain() * Mat4::from_scale(Vec3::new(1.0, 1.3, 0.8)), reverse, REVERSE),
        (
            "turned by a quarter",
            plain(),
            Mat4::from_rotation_z(1.570_796_4) * perspective(0.9, 0.7, 50.0, 0.05),
            REVERSE,
        ),
        ("through the near plane", plain(), perspective(0.6, ASPECT, 50.0, 2.9), REVERSE),
        ("orthographic, through the near plane", plain(), orthographic(-1.2, 1.2, -0.8, 0.8, 2.9, 20.0), STANDARD),
    ]
}

/// Largest difference of a channel, and PSNR, of what is drawn and what is true.
fn hold(name: &str, screen: &mut Screen, view: View) {
    let groom = groom();
    screen.view = view;
    screen.lights.lights.push(Light::point(Vec3::new(0.4, 0.3, 0.8), 0.7, Vec3::new(2.0, 1.0, 0.5)));
    let picture = screen.hair(&[&groom]);
    let exact = screen.exact(&[&groom]);
    screen.lights.lights.pop();
    let difference = picture.difference(&exact);
    eprintln!("{name}: {difference:?}, {:?}", picture.counters);
    assert!(picture.counters.pixels_with_hair > 400, "{name}: the groom is in the picture, {:?}", picture.counters);
    // Half floats below 1 are 0.0005 apart.
    assert!(difference.max < 0.0008 && difference.psnr > 88.0, "{name}: {difference:?}");
}

fn hold_all(mut backend: impl FnMut() -> Option<Box<dyn Run>>) {
    let Some(first) = backend() else { return };
    let setup = |setup: &mut Setup| (setup.ppll().k, setup.size) = (16, SIZE);
    let mut screen = Screen::new(first, setup);
    for (name, view, projection, depth) in views() {
        hold(name, &mut screen, View::new(view, projection, depth, SIZE).unwrap());
    }
}

#[test]
fn any_view_is_as_in_f64_on_wgpu() {
    hold_all(|| Some(gpu()? as Box<dyn Run>));
}

#[test]
fn any_view_is_as_in_f64_on_vulkan() {
    hold_all(|| Some(Box::new(VulkanBackend::headless().unwrap())));
}

/// A part of a picture.
fn cut(pixels: &[glam::DVec4], width: u32, viewport: Viewport) -> Vec<glam::DVec4> {
    let ([x, y], [across, down]) = (viewport.offset(), viewport.size());
    (y..y + down)
        .flat_map(|row| (x..x + across).map(move |column| (row * width + column) as usize))
        .map(|i| pixels[i])
        .collect()
}

#[test]
fn views_of_one_frame_fill_their_parts_of_the_target() {
    for backend in [gpu().map(|gpu| gpu as Box<dyn Run>), VulkanBackend::headless().ok().map(|gpu| Box::new(gpu) as _)]
    {
        let Some(backend) = backend else { return };
        let mut screen = Screen::new(backend, |setup| setup.ppll().k = 16);
        let groom = groom();
        // Neither begins nor ends on a tile of 8 x 8.
        let parts = [([0, 0], [45, 64]), ([45, 3], [51, 37])];
        let viewports = parts.map(|(offset, size)| Viewport::part(offset, size, SIZE).unwrap());
        let projection = rh::proj::directx::perspective(0.6, 0.8, 50.0, 0.05);
        let side = rh::view::look_at_mat4(Vec3::new(2.5, 0.4, 1.0), Vec3::ZERO, Vec3::Y);
        let views = [
            View::new(plain(), projection, REVERSE, viewports[0]).unwrap(),
            View::new(side, projection, REVERSE, viewports[1]).unwrap(),
        ];
        let picture = screen.views(&views, &[&groom]).pixels();
        for (view, viewport) in views.iter().zip(viewports) {
            screen.view = *view;
            let exact = screen.exact(&[&groom]);
            let difference = Difference::between(&cut(&picture, SIZE[0], viewport), &exact);
            eprintln!("{viewport:?}: {difference:?}");
            assert!(exact.iter().filter(|pixel| pixel.w > 0.1).count() > 200);
            assert!(difference.max < 0.0008 && difference.psnr > 87.0, "{difference:?}");
        }
        let outside = Viewport::part([45, 40], [51, 24], SIZE).unwrap();
        assert!(cut(&picture, SIZE[0], outside).iter().all(|pixel| pixel.w == 0.0), "nothing leaves its viewport");
    }
}

#[test]
fn views_of_one_frame_have_their_own_counters() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = groom();
    let (view, empty) = (screen.view, View::new(plain(), Mat4::ZERO, REVERSE, [0, 7]).unwrap());
    let alone = screen.hair(&[&groom]);
    let mut list = PassList::new();
    let strands = screen.section(&mut list, &groom);
    let draw = SectionDraw::new(&strands, &groom.material, Pose::IDENTITY);
    let away = rh::view::look_at_mat4(Vec3::Z * 9.0, Vec3::Z * 10.0, Vec3::Y);
    let away = View::new(away, view.projection_matrix(), REVERSE, SIZE).unwrap();
    let (targets, lights) = (screen.targets(), screen.lights.clone());
    let views = [&away, &empty, &view].map(|view| ViewDraw::new(view, &lights, targets));
    screen.renderer.draw(&mut list, &views, &[draw]).unwrap();
    let tickets = [0, 1, 2].map(|view| screen.renderer.request_counters(&mut list, view));
    screen.backend.run(&list).unwrap();
    let counters = tickets
        .map(|ticket| tressfx_render::Counters::from_bytes(&screen.backend.read(ticket).ready().expect("it has run")));
    assert_eq!(counters, [tressfx_render::Counters::default(), tressfx_render::Counters::default(), alone.counters]);
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let mut backend = NullBackend::default();
    let mut renderer = HairRenderer::new(&mut backend, &RenderDesc::new(SIZE, Format::Rgba16F)).unwrap();
    let Some(screen) = screen(|_| ()) else { return };
    let (targets, view) = (screen.targets(), screen.view);
    let mut refused = |views: &[(View, Lights)]| {
        let views: Vec<_> = views.iter().map(|(view, lights)| ViewDraw::new(view, lights, targets)).collect();
        renderer.draw(&mut PassList::new(), &views, &[]).unwrap_err()
    };
    let none = Lights::default();
    assert_eq!(refused(&vec![(view, none.clone()); 9]), DrawError::Views { given: 9, most: 8 });
    let many = Lights { lights: vec![Light::directional(Vec3::Y, Vec3::ONE); 17], ..Lights::default() };
    assert_eq!(refused(&[(view, many)]), DrawError::Lights(17));
    let large = View::new(view.view_matrix(), view.projection_matrix(), REVERSE, [96, 65]).unwrap();
    assert_eq!(refused(&[(large, none)]), DrawError::Size { view: [96, 65], renderer: SIZE });
    let leaves = Viewport::part([50, 0], [47, 64], SIZE).unwrap_err();
    assert_eq!(leaves, ViewError::Viewport { offset: [50, 0], size: [47, 64], target: SIZE });
    assert!(Viewport::part([u32::MAX, 0], [2, 2], SIZE).is_err());
}

#[test]
fn fewer_views_take_less_memory() {
    let mut backend = NullBackend::default();
    let mut made = |views| {
        let desc = RenderDesc::new(SIZE, Format::Rgba16F).technique(TilesDesc::default()).views(views);
        HairRenderer::new(&mut backend, &desc)
    };
    for none in [0, 9] {
        let error = made(none).unwrap_err().to_string();
        assert!(error.contains(&format!("{none} views")) && error.contains("1 to 8"), "{error}");
    }
    let [one, all] = [1, 8].map(|views| made(views).unwrap().technique_bytes());
    // Counters, and what is kept of each view and of each tile.
    assert_eq!(all - one, 7 * (32 + 4 + 20 * 12 * 8));
    let mut renderer = made(2).unwrap();
    let Some(screen) = screen(|_| ()) else { return };
    let (targets, none) = (screen.targets(), Lights::default());
    let three = vec![ViewDraw::new(&screen.view, &none, targets); 3];
    let error = renderer.draw(&mut PassList::new(), &three, &[]).unwrap_err();
    assert_eq!(error, DrawError::Views { given: 3, most: 2 });
    assert!(renderer.draw(&mut PassList::new(), &three[..2], &[]).is_ok());
}

#[test]
fn an_orthographic_fibre_is_as_wide_near_as_far() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let material = Material::default().with(|m| {
        (m.fibre_radius, m.tip_width) = (Some(0.05), 1.0);
        (m.opacity, m.tip_opacity) = (1.0, 1.0);
    });
    // From the far left to the near right.
    let groom = Groom::new(&[vec![Vec3::new(-1.0, 0.0, -4.0), Vec3::new(1.0, 0.0, 2.5)]], material);
    let projection = rh::proj::directx::orthographic(-1.2, 1.2, -0.8, 0.8, 10.0, 0.1);
    let view = rh::view::look_at_mat4(Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y);
    screen.view = View::new(view, projection, REVERSE, SIZE).unwrap();
    let pixels = screen.hair(&[&groom]).pixels();
    let height = |x: usize| (0..64).map(|y| pixels[y * 96 + x].w).sum::<f64>();
    for column in [20, 48, 75] {
        assert!((height(column) - 4.0).abs() < 0.002, "{} pixels in column {column}", height(column));
    }
}
