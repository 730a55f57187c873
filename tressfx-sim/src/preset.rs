//! Named materials.

use std::str::FromStr;

use crate::params::SimParams;

/// A material for [`Solver::Direct`](crate::Solver::Direct): what hair of some kind is like.
///
/// Bending lengths follow from the diameter of what bends as one ([`of_fibre`](crate::bending_length::of_fibre)): a fibre, or a lock
/// whose fibres are glued to each other. The rate at which air stops it is that of a cylinder at 0.5 m/s (drag coefficient
/// `1 + 10 Re^(-2/3)`: White, Viscous Fluid Flow, 3rd edition, 2006), times 0.7, since neighbours carry the air along, and at most 40/s. Locks lose their swing
/// to what glues them: a loss tangent of 0.2 at the first mode of 10 cm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// By which it is asked for.
    pub name: &'static str,
    /// What hair that is.
    pub what: &'static str,
    /// See [`SimParams::bending_length`], m.
    pub bending_length: f32,
    /// See [`SimParams::internal_damping`], s.
    pub internal_damping: f32,
    /// See [`SimParams::air_drag`], 1/s.
    pub air_drag: f32,
}

impl Preset {
    /// From the softest to the stiffest.
    pub const ALL: [Self; 8] = [
        Self::fibre("baby", "hair of a baby, 25 micrometres thick", 0.023, 40.0),
        Self::fibre("wet", "hair of 70 micrometres that holds as much water as it weighs", 0.027, 10.0),
        Self::fibre("fine", "fine hair, 50 micrometres", 0.037, 33.0),
        Self::fibre("medium", "hair of 70 micrometres", 0.046, 20.0),
        Self::fibre("coarse", "coarse hair, 100 micrometres", 0.058, 11.0),
        Self::lock("sprayed", "hair spray: locks of 0.3 mm", 0.12, 0.0043, 4.3),
        Self::lock("gelled", "gel: locks of 1 mm", 0.27, 0.0013, 0.81),
        Self::lock("mohawk", "a gelled mohawk: spikes of 4 mm", 0.68, 0.000_32, 0.14),
    ];

    const fn fibre(name: &'static str, what: &'static str, bending_length: f32, air_drag: f32) -> Self {
        Self::lock(name, what, bending_length, 0.0, air_drag)
    }

    const fn lock(name: &'static str, what: &'static str, bending_length: f32, lag: f32, air_drag: f32) -> Self {
        Self { name, what, bending_length, internal_damping: lag, air_drag }
    }

    /// The same parameters with this material.
    #[must_use]
    pub fn on(&self, params: SimParams) -> SimParams {
        let Self { bending_length, internal_damping, air_drag, .. } = *self;
        SimParams { bending_length, internal_damping, air_drag, ..params }
    }
}

/// There is no preset of a name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no preset {0:?}: there are {names}", names = Preset::ALL.map(|preset| preset.name).join(", "))]
pub struct NoPreset(
    /// The name.
    pub String,
);

impl FromStr for Preset {
    type Err = NoPreset;

    fn from_str(name: &str) -> Result<Self, NoPreset> {
        Self::ALL.into_iter().find(|preset| preset.name == name).ok_or_else(|| NoPreset(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bending_length::{G, of_fibre};

    /// Modulus in Pa, density in kg/m^3, diameter in m. Wet hair has 0.4 of the modulus of dry hair (Robbins 2012); half of a lock is air.
    const FIBRES: [[f64; 3]; 8] = [
        [4e9, 1300.0, 25e-6],
        [1.6e9, 2600.0, 70e-6],
        [4e9, 1300.0, 50e-6],
        [4e9, 1300.0, 70e-6],
        [4e9, 1300.0, 100e-6],
        [2e9, 650.0, 0.3e-3],
        [2e9, 650.0, 1e-3],
        [2e9, 650.0, 4e-3],
    ];

    fn drag(density: f64, diameter: f64) -> f64 {
        let (speed, viscosity, air) = (0.5, 1.5e-5, 1.2);
        let coefficient = 1.0 + 10.0 * (speed * diameter / viscosity).powf(-2.0 / 3.0);
        let mass = density * std::f64::consts::PI * diameter * diameter / 4.0;
        (0.7 * 0.5 * air * speed * diameter * coefficient / mass).min(40.0)
    }

    #[test]
    fn presets_are_what_their_fibres_are() {
        for (preset, [modulus, density, diameter]) in Preset::ALL.into_iter().zip(FIBRES) {
            let near = |value: f32, expected: f64| {
                assert!((f64::from(value) / expected - 1.0).abs() < 0.03, "{preset:?}: {expected}")
            };
            near(preset.bending_length, of_fibre(modulus, density, diameter));
            near(preset.air_drag, drag(density, diameter));
            if diameter > 1e-4 {
                let stiffness = G * f64::from(preset.bending_length).powi(3);
                near(preset.internal_damping, 0.2 / (3.516 * stiffness.sqrt() / 0.01));
            }
        }
    }

    #[test]
    fn presets_are_valid_and_found_by_their_names() {
        for preset in Preset::ALL {
            preset.on(SimParams::default()).validate().unwrap();
            assert_eq!(preset.name.parse(), Ok(preset));
        }
        assert!(Preset::ALL.is_sorted_by_key(|preset| preset.bending_length));
        assert!("bald".parse::<Preset>().unwrap_err().to_string().contains("\"bald\": there are baby, wet, fine"));
    }
}
