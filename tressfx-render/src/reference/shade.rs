//! `hair.render.shade`.

use glam::{DVec2, DVec3, DVec4};

use tressfx_core::hash::hash;
use tressfx_core::view::View;

use super::projection::Projection;
use super::scatter;
use super::{Arriving, Strands, matrix, pair, xyz};
use crate::lights::{Light, LightPlace, Lights};

/// Colour and opacity of a vertex of the buffers.
pub fn shade(view: &View, lights: &Lights, strands: &Strands, strand: u32, vertex: u32) -> DVec4 {
    let of = &strands.uniform;
    let guide = strand % of.guides;
    let index = (vertex * of.strands + strand) as usize;
    let along = f64::from(vertex) / f64::from(of.vertices - 1);
    let tip_share = ((along - f64::from(of.tip_start)) * f64::from(of.tip_scale)).clamp(0.0, 1.0);
    let own = strands.own_colors.map(|own| own[(vertex * of.guides + guide) as usize]);
    let own = own.map_or(DVec4::ONE, |own| DVec4::from_array(own.map(f64::from)));
    let own_share = f64::from(of.own_colors);
    let [base, tip] = [of.base, of.tip].map(|paint| DVec4::from_array(paint.map(f64::from)));
    let color = base.lerp(tip, tip_share).truncate().lerp(own.truncate(), own_share);
    let opacity = base.lerp(tip, along).w * own.w;
    let tangent = matrix(&of.pose).transform_vector3(xyz(&strands.tangents[index]));
    let tilt = f64::from(of.tilt) * (1.0 + f64::from(of.tilt_variation) * strand_random(strand, guide, 1));
    let differs = f64::from(of.variation) * strand_random(strand, guide, 0);
    let hue = f64::from(of.hue_variation) * strand_random(strand, guide, 2);
    let absorption = xyz(&of.absorption).lerp(xyz(&of.tip_absorption), tip_share);
    let own_absorption = f64::from(of.absorption[3]) * own.truncate().map(|part| part.max(1e-30).ln().powi(2));
    let fibre = match strands.fibre {
        Some(table) => Fibre::Glass(scatter::Fibre {
            tangent,
            tilt,
            absorption: absorption.lerp(own_absorption, own_share)
                * (1.0 - differs)
                * DVec3::new(1.0 - hue, 1.0, 1.0 + hue),
            variances: [1.0, 0.25, 4.0, 4.0].map(|factor| factor * f64::from(of.variance)),
            multiple: f64::from(of.multiple),
            table,
        }),
        None => Fibre::Kajiya(Kajiya {
            tangent,
            tilt,
            albedo: color * (1.0 + differs) * DVec3::new(1.0 + hue, 1.0, 1.0 - hue),
            diffuse: f64::from(of.diffuse),
            primary: pair(of.primary),
            secondary: pair(of.secondary),
        }),
    };
    let skin = 1.0 - f64::from(of.root_shade) * (1.0 - smoothstep(along / f64::from(of.root_extent)));
    let point = strands.posed(index);
    let arriving = strands.arriving.map_or(Arriving::ALL, |arriving| arriving[index]);
    let eye = Projection::new(view).towards_eye(point);
    let color = skin * lit(lights, [of.self_shadow, of.shadow_alpha].map(f64::from), point, eye, &fibre, &arriving);
    color.clamp(DVec3::ZERO, DVec3::splat(60_000.0)).extend(opacity)
}

/// How a fibre scatters light.
enum Fibre<'a> {
    Kajiya(Kajiya),
    Glass(scatter::Fibre<'a>),
}

impl Fibre<'_> {
    /// The radiance in light of which the share `share` arrives.
    fn scatter(&self, eye: DVec3, light: DVec3, share: f64, alpha: f64) -> DVec3 {
        match self {
            Self::Kajiya(fibre) => share * fibre.scatter(eye, light),
            Self::Glass(_) if share < DARK => DVec3::ZERO,
            Self::Glass(fibre) => fibre.scatter(eye, light, scatter::fibres(share, alpha)),
        }
    }

    /// What the light of the sky is multiplied with, of which the share `share` has arrived.
    fn under_sky(&self, eye: DVec3, share: f64, alpha: f64) -> DVec3 {
        match self {
            Self::Kajiya(fibre) => fibre.albedo,
            Self::Glass(fibre) => {
                let share = share.clamp(DARKEST_SKY, 1.0);
                fibre.under_sky(eye, scatter::fibres(share, alpha)) / share
            }
        }
    }
}

/// Less light than the smallest share that is told from none comes through no hair.
const DARK: f64 = 4e-6;

/// Less light of the sky than this keeps its colour.
const DARKEST_SKY: f64 = 1e-3;

struct Kajiya {
    tangent: DVec3,
    tilt: f64,
    albedo: DVec3,
    diffuse: f64,
    primary: DVec2,
    secondary: DVec2,
}

fn lit(
    lights: &Lights,
    [self_shadow, alpha]: [f64; 2],
    point: DVec3,
    eye: DVec3,
    fibre: &Fibre,
    arriving: &Arriving,
) -> DVec3 {
    let [sky, ground] = [lights.sky, lights.ground].map(|light| light.as_dvec3());
    let (mean, slope) = (0.5 * (sky + ground), 0.5 * (sky - ground));
    let around = mean.lerp(arriving.sky.w * mean + arriving.sky.y / 3.0 * slope, self_shadow).max(DVec3::ZERO);
    let of_sky = around * fibre.under_sky(eye, 1.0 + self_shadow * (arriving.sky.w - 1.0), alpha);
    lights.lights.iter().enumerate().fold(of_sky, |sum, (index, light)| {
        let (towards, strength) = towards(light, point);
        let share = 1.0 + self_shadow * (share_of(arriving, index, light, towards) - 1.0);
        sum + light.color.as_dvec3() * strength * fibre.scatter(eye, towards, share, alpha)
    })
}

/// How much of a light arrives: as it is stored, or of what arrives from everywhere, from its direction.
fn share_of(arriving: &Arriving, index: usize, light: &Light, towards: DVec3) -> f64 {
    match arriving.lights.get(index) {
        Some(&share) => share,
        None if light.casts => (arriving.sky.w + arriving.sky.truncate().dot(towards)).clamp(0.0, 1.0),
        None => 1.0,
    }
}

pub(super) fn towards(light: &Light, point: DVec3) -> (DVec3, f64) {
    match light.place {
        LightPlace::Directional { towards } => (towards.as_dvec3().normalize(), 1.0),
        LightPlace::Point { position, reach, cone } => {
            let offset = position.as_dvec3() - point;
            let reach = f64::from(reach);
            let direction = offset.normalize_or_zero();
            let left = cone.map_or(1.0, |cone| {
                let [inner, outer] = [cone.inner, cone.outer].map(|angle| f64::from(angle).cos());
                let cosine = -direction.dot(cone.along.as_dvec3().normalize());
                ((cosine - outer) / (inner - outer).max(0.001)).clamp(0.0, 1.0).powi(2)
            });
            (direction, left * (reach * reach / offset.length_squared()).min(1.0))
        }
    }
}

impl Kajiya {
    fn scatter(&self, eye: DVec3, light: DVec3) -> DVec3 {
        let (along_light, along_eye) = (self.tangent.dot(light), self.tangent.dot(eye));
        let lobe = |shift, term: DVec2| term.x * highlight(along_light, along_eye, shift).max(1e-6).powf(term.y);
        let primary = lobe(2.0 * self.tilt, self.primary);
        let secondary = lobe(-3.0 * self.tilt, self.secondary);
        self.albedo * (self.diffuse * perpendicular(along_light) + secondary) + primary
    }
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

fn strand_random(strand: u32, guide: u32, stream: u32) -> f64 {
    let seed = |n: u32| n.wrapping_add(stream.wrapping_mul(0x9e37_79b9));
    hash(seed(guide.wrapping_mul(2))) + hash(seed(strand.wrapping_mul(2).wrapping_add(1))) - 1.0
}
