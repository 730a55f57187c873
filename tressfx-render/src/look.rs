//! Named colours of hair.

use std::str::FromStr;

use glam::Vec3;

use crate::fibre::{FibreScattering, Pigment};
use crate::material::Material;

/// What hair of some colour looks like, as fibres that scatter as glass.
///
/// What a part of melanin absorbs is as d'Eon et al. 2011 give it; how much of it there is, how much strands differ, and how far light gets between them was
/// set by eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// By which it is asked for.
    pub name: &'static str,
    /// What hair that is.
    pub what: &'static str,
    /// What takes light within a fibre.
    pub pigment: Pigment,
    /// Colours at root and tip, linear RGB, where the pigment follows them.
    pub colors: Option<[Vec3; 2]>,
    /// See [`FibreScattering::roughness`].
    pub roughness: f32,
    /// See [`Material::variation`].
    pub variation: f32,
    /// See [`Material::shadow_alpha`].
    pub shadow_alpha: f32,
}

const fn melanin(eumelanin: f32, pheomelanin: f32) -> Pigment {
    Pigment::Melanin { eumelanin, pheomelanin }
}

impl Look {
    /// Natural colours from the brightest to the darkest, and what is none.
    pub const ALL: [Self; 6] = [
        Self::natural("blond", "golden blond", melanin(0.06, 0.1), [0.3, 0.3, 0.12]),
        Self::natural("red", "copper red", melanin(0.05, 1.4), [0.3, 0.3, 0.15]),
        Self::natural("brown", "chestnut brown", melanin(1.1, 0.2), [0.28, 0.35, 0.2]),
        Self::natural("black", "black", melanin(8.0, 0.0), [0.25, 0.3, 0.3]),
        Self::natural(
            "grey",
            "grey: white hair among dark",
            Pigment::Absorption(Vec3::new(0.16, 0.17, 0.18)),
            [0.32, 1.0, 0.12],
        ),
        Self {
            colors: Some([Vec3::new(0.02, 0.1, 0.4), Vec3::new(0.04, 0.35, 0.5)]),
            ..Self::natural("dyed", "dyed blue, turquoise at the tips", Pigment::Color, [0.3, 0.25, 0.15])
        },
    ];

    const fn natural(
        name: &'static str,
        what: &'static str,
        pigment: Pigment,
        [roughness, variation, shadow_alpha]: [f32; 3],
    ) -> Self {
        Self { name, what, pigment, colors: None, roughness, variation, shadow_alpha }
    }

    /// The same material with this look.
    #[must_use]
    pub fn on(&self, material: Material) -> Material {
        let fibre = FibreScattering { pigment: self.pigment, roughness: self.roughness, ..FibreScattering::default() };
        let Self { variation, shadow_alpha, .. } = *self;
        let [base_color, tip_color] = self.colors.unwrap_or([material.base_color, material.tip_color]);
        let made = Material { fibre: Some(fibre), base_color, tip_color, variation, shadow_alpha, ..material };
        let [base_color, tip_color] = made.colors();
        Material { base_color, tip_color, ..made }
    }
}

/// There is no look of a name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no look {0:?}: there are {names}", names = Look::ALL.map(|look| look.name).join(", "))]
pub struct NoLook(
    /// The name.
    pub String,
);

impl FromStr for Look {
    type Err = NoLook;

    fn from_str(name: &str) -> Result<Self, NoLook> {
        Self::ALL.into_iter().find(|look| look.name == name).ok_or_else(|| NoLook(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_are_valid_and_found_by_their_names() {
        for look in Look::ALL {
            look.on(Material::default()).validate().unwrap();
            assert_eq!(look.name.parse(), Ok(look));
        }
        let error = "green".parse::<Look>().unwrap_err();
        assert_eq!(error.to_string(), "no look \"green\": there are blond, red, brown, black, grey, dyed");
    }

    #[test]
    fn looks_have_the_colors_that_they_are_named_for() {
        let [blond, red, brown, black, grey, dyed] = Look::ALL.map(|look| look.on(Material::default()).colors()[0]);
        let luminance = |c: Vec3| c.dot(Vec3::new(0.2126, 0.7152, 0.0722));
        assert!(luminance(blond) > 2.0 * luminance(brown) && luminance(brown) > 4.0 * luminance(black));
        assert!(red.x > 2.0 * red.y && red.x > 5.0 * red.z && blond.x > blond.z);
        assert!(grey.max_element() < 2.0 * grey.min_element() && dyed.z > 2.0 * dyed.x, "{grey} {dyed}");
    }
}
