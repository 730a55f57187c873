//! `hair.render.shade`.

use glam::{DVec2, DVec3, DVec4};

use super::{Section, matrix, pair, xyz};
use crate::gpu::{Frame, Light};

/// Colour and opacity of a strand vertex.
pub fn shade(frame: &Frame, section: &Section, strand: u32, vertex: u32) -> DVec4 {
    let of = &section.uniform;
    let guide = strand % of.guides;
    let index = section.index(strand, vertex);
    let along = f64::from(vertex) / f64::from(of.vertices - 1);
    let paint = DVec4::from_array(of.base.map(f64::from)).lerp(DVec4::from_array(of.tip.map(f64::from)), along);
    let fibre = Fibre {
        tangent: matrix(&of.pose).transform_vector3(xyz(&section.tangents[index])),
        tilt: f64::from(of.tilt) * (1.0 + f64::from(of.tilt_variation) * strand_random(strand, guide, 1)),
        albedo: paint.truncate() * (1.0 + f64::from(of.variation) * strand_random(strand, guide, 0)),
        diffuse: f64::from(of.diffuse),
        primary: pair(of.primary),
        secondary: pair(of.secondary),
    };
    let open = 1.0 - f64::from(of.root_shade) * (1.0 - smoothstep(along / f64::from(of.root_extent)));
    let point = section.posed(index);
    let normal = outwards(section, point, fibre.tangent, strand);
    let color = open * lit(frame, f64::from(of.form), point, normal, &fibre);
    color.clamp(DVec3::ZERO, DVec3::splat(60_000.0)).extend(paint.w)
}

struct Fibre {
    tangent: DVec3,
    tilt: f64,
    albedo: DVec3,
    diffuse: f64,
    primary: DVec2,
    secondary: DVec2,
}

fn outwards(section: &Section, point: DVec3, tangent: DVec3, strand: u32) -> DVec3 {
    let center = matrix(&section.uniform.pose).transform_point3(xyz(&section.uniform.center));
    let growth = section.posed(section.index(strand, 1)) - section.posed(section.index(strand, 0));
    let out = (point - center).normalize_or_zero() + growth.normalize_or_zero();
    (out - tangent * out.dot(tangent)).normalize_or_zero()
}

fn lit(frame: &Frame, form: f64, point: DVec3, normal: DVec3, fibre: &Fibre) -> DVec3 {
    let eye = (xyz(&frame.eye) - point).normalize_or_zero();
    let ambient = xyz(&frame.ground).lerp(xyz(&frame.sky), 0.5 + 0.5 * normal.y) * fibre.albedo;
    let lights = &frame.lights[..frame.light_count as usize];
    lights.iter().fold(ambient, |sum, light| {
        let (towards, arriving) = towards(light, point);
        let wrapped = ((normal.dot(towards) + 0.4) / 1.4).clamp(0.0, 1.0);
        let facing = 1.0 + form * (wrapped - 1.0);
        sum + xyz(&light.color) * arriving * facing * scatter(fibre, eye, towards)
    })
}

fn towards(light: &Light, point: DVec3) -> (DVec3, f64) {
    let place = xyz(&light.place);
    if light.place[3] == 0.0 {
        return (place, 1.0);
    }
    let offset = place - point;
    let reach = f64::from(light.color[3]);
    (offset.normalize_or_zero(), (reach * reach / offset.length_squared()).min(1.0))
}

fn scatter(fibre: &Fibre, eye: DVec3, light: DVec3) -> DVec3 {
    let (along_light, along_eye) = (fibre.tangent.dot(light), fibre.tangent.dot(eye));
    let lobe = |shift, term: DVec2| term.x * highlight(along_light, along_eye, shift).max(1e-6).powf(term.y);
    let primary = lobe(2.0 * fibre.tilt, fibre.primary);
    let secondary = lobe(-3.0 * fibre.tilt, fibre.secondary);
    fibre.albedo * (fibre.diffuse * perpendicular(along_light) + secondary) + primary
}

fn highlight(along_light: f64, along_eye: f64, shift: f64) -> f64 {
    let c = -along_light * shift.cos() - perpendicular(along_light) * shift.sin();
    (c * along_eye + perpendicular(c) * perpendicular(along_eye)).max(0.0)
}

fn perpendicular(cosine: f64) -> f64 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}

fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

fn hash(seed: u32) -> f64 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    f64::from(((word >> 22) ^ word) >> 8) / f64::from(1 << 24)
}

fn strand_random(strand: u32, guide: u32, stream: u32) -> f64 {
    let seed = |n: u32| n.wrapping_add(stream.wrapping_mul(0x9e37_79b9));
    hash(seed(guide.wrapping_mul(2))) + hash(seed(strand.wrapping_mul(2).wrapping_add(1))) - 1.0
}
