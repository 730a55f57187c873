//! Light that is empty, odd or wrong.

mod support;

use glam::{Quat, Vec3};
use support::light::{Lamps, LitHair, lit, render_lit};
use support::{Hair, orthographic, samples};
use tressfx_core::view::Pose;
use tressfx_truth::{Illumination, Light, OpaqueMesh, ShadowMethod, Truth, TruthError};

const LINE: [Vec3; 3] = [Vec3::new(-3.0, 0.0, 0.0), Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)];

fn hair() -> LitHair {
    LitHair::new(Hair::new(0.4, &[(&LINE, [0.5; 4])]), &[[0.5; 3]], [0.5; 3], 0.3)
}

fn lamps() -> Lamps {
    Lamps { sky: Vec3::ONE, ..Lamps::from(Light::Directional { towards: Vec3::Y }) }
}

fn error(hair: &LitHair, lamps: &Lamps) -> String {
    lit(&orthographic([8, 8]), &[hair], lamps).unwrap_err().to_string()
}

#[test]
fn arrays_of_another_length_are_named() {
    let short = LitHair { sky: vec![[0.0; 3]; 2], ..hair() };
    assert_eq!(error(&short, &lamps()), "section 0: 2 colours in a light, its counts ask for 3");
    let short = LitHair { lights: vec![vec![[0.0; 3]; 4]], ..hair() };
    assert_eq!(error(&short, &lamps()), "section 0: 4 colours in a light, its counts ask for 3");
    let dark = LitHair { lights: Vec::new(), ..hair() };
    assert_eq!(error(&dark, &lamps()), "section 0: 0 lights, its counts ask for 1");
    let light = Illumination {
        lights: &[],
        sky: Vec3::ONE,
        ground: Vec3::ONE,
        sections: &[],
        meshes: &[],
        shadows: ShadowMethod::Traced,
    };
    let hair = hair().hair;
    let truth = Truth::new(&orthographic([8, 8]), &[hair.section()], None).unwrap();
    assert_eq!(truth.lit_by(&light).unwrap_err(), TruthError::Sections { found: 0, expected: 1 });
}

#[test]
fn numbers_that_cannot_be_are_named() {
    let mut odd = hair();
    odd.lights[0][1][2] = f32::NAN;
    assert_eq!(error(&odd, &lamps()), "section 0: colour in a light 1 is not finite, or negative");
    for share in [-0.1, 1.1, f32::NAN] {
        let odd = LitHair { shadow_alpha: share, ..hair() };
        assert_eq!(error(&odd, &lamps()), "section 0: shadow_alpha is not from 0 to 1");
        let odd = LitHair { self_shadow: share, ..hair() };
        assert_eq!(error(&odd, &lamps()), "section 0: self_shadow is not from 0 to 1");
    }
    for towards in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let found = error(&hair(), &Lamps::from(Light::Directional { towards }));
        assert_eq!(found, "light 0: its direction is 0, or a number is not finite");
    }
    assert!(error(&hair(), &Lamps::from(Light::Point { position: Vec3::NAN })).starts_with("light 0"));
    assert!(error(&hair(), &Lamps { ground: Vec3::NEG_X, ..lamps() }).starts_with("the light of the sky"));
}

#[test]
fn meshes_without_sense_are_named() {
    let triangles = vec![Vec3::X, Vec3::Y, Vec3::Z];
    let with = |triangles: Vec<Vec3>| error(&hair(), &Lamps { triangles, ..lamps() });
    assert_eq!(with(triangles[..2].to_vec()), "mesh 0: 2 indices are no whole triangles");
    assert_eq!(with(vec![Vec3::X, Vec3::NAN, Vec3::Z]), "mesh 0: vertex 1 is not finite");
    let pose = Pose { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..Pose::IDENTITY };
    let found = error(&hair(), &Lamps { triangles: triangles.clone(), pose, ..lamps() });
    assert!(found.starts_with("mesh 0: pose:"), "{found}");
    let mesh = OpaqueMesh { positions: &triangles, indices: &[0, 1, 3], pose: Pose::IDENTITY };
    let light = Illumination {
        lights: &[],
        sky: Vec3::ONE,
        ground: Vec3::ONE,
        sections: &[],
        meshes: &[mesh],
        shadows: ShadowMethod::Traced,
    };
    let found = Truth::new(&orthographic([8, 8]), &[], None).unwrap().lit_by(&light).unwrap_err();
    assert_eq!(found.to_string(), "mesh 0: vertex 3 of 3");
}

#[test]
fn fibres_that_are_no_distance_apart_are_an_error() {
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = error(&hair(), &Lamps { shadows: ShadowMethod::NearestFibre { spacing }, ..lamps() });
        assert_eq!(found, TruthError::Spacing.to_string());
    }
}

#[test]
fn odd_places_give_a_picture_of_finite_numbers() {
    let flat = vec![Vec3::X, Vec3::X, Vec3::X, Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0];
    let lights = [
        Light::Point { position: Vec3::ZERO },
        Light::Point { position: Vec3::splat(1e30) },
        Light::Directional { towards: Vec3::splat(1e-40) },
        Light::Directional { towards: Vec3::splat(3e38) },
    ];
    let mut hair = LitHair { lights: vec![vec![[0.5; 3]; 3]; 4], ..hair() };
    for bad in [0.0, f32::NAN, 9e11] {
        hair.hair.positions[2][1] = bad;
        let lamps = Lamps { lights: lights.to_vec(), triangles: flat.clone(), ..lamps() };
        let picture = render_lit(&orthographic([8, 8]), &[&hair], &lamps, 4);
        assert!(picture.pixels().iter().all(|pixel| pixel.is_finite()), "{bad}");
        assert!(picture.pixels()[8 * 4 + 1].x > 0.0 && picture.shadow_rays() > 0, "{bad}");
    }
}

#[test]
fn without_strands_there_is_nothing_to_light() {
    let none = LitHair::new(Hair::new(0.1, &[]), &[[0.5; 3]], [0.5; 3], 0.3);
    let truth = lit(&orthographic([8, 8]), &[&none], &lamps()).unwrap();
    let picture = truth.render(samples(4), &|_| ());
    assert!(picture.pixels().iter().all(|pixel| *pixel == glam::DVec4::ZERO) && picture.shadow_rays() == 0);
}

#[test]
fn a_thousand_strands_in_one_place_shade_each_other() {
    let strands = vec![(&LINE[..], [0.5, 0.5, 0.5, 1.0]); 1000];
    let heap = LitHair::new(Hair::new(0.4, &strands), &[[0.5; 3]], [0.5; 3], 0.001);
    let lamps = Lamps::from(Light::Directional { towards: Vec3::Y });
    let picture = render_lit(&orthographic([8, 8]), &[&heap], &lamps, 4);
    let expected = 0.5 * (1.0 - f64::from(0.001f32)).powi(999);
    assert!((picture.pixels()[8 * 4 + 1].x - expected).abs() < 1e-9);
}
