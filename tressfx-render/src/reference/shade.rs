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
    let skin = 1.0 - f64::from(of.root_shade) * (1.0 - smoothstep(along / f64::from(of.root_extent)));
    let point = section.posed(index);
    let open = open_towards(section, strand, vertex, fibre.tangent);
    let color = skin * lit(frame, f64::from(of.form), point, &fibre, open);
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

/// The light that comes through the groom, as a vector and a constant.
fn open_towards(section: &Section, strand: u32, vertex: u32, tangent: DVec3) -> DVec4 {
    let of = &section.uniform;
    let local = section.openness[(vertex * of.guides + strand % of.guides) as usize].map(f64::from);
    let growth = section.posed(section.index(strand, 1)) - section.posed(section.index(strand, 0));
    let growth = growth.normalize_or_zero();
    let side = growth - tangent * growth.dot(tangent);
    let across = side * side.length().recip().min(5.0);
    (local[0] * tangent + local[1] * across + local[2] * tangent.cross(across)).extend(local[3])
}

fn lit(frame: &Frame, form: f64, point: DVec3, fibre: &Fibre, open: DVec4) -> DVec3 {
    let eye = (xyz(&frame.eye) - point).normalize_or_zero();
    let seen = |open: f64| 1.0 + form * (open.clamp(0.0, 1.0) - 1.0);
    let above = 0.5 + 0.5 * open.truncate().normalize_or_zero().y;
    let ambient = seen(open.w) * xyz(&frame.ground).lerp(xyz(&frame.sky), above) * fibre.albedo;
    let lights = &frame.lights[..frame.light_count as usize];
    lights.iter().fold(ambient, |sum, light| {
        let (towards, arriving) = towards(light, point);
        let arriving = arriving * seen(open.w + open.truncate().dot(towards));
        sum + xyz(&light.color) * arriving * scatter(fibre, eye, towards)
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
