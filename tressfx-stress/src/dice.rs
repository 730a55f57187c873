//! Random numbers of a case.

use std::ops::RangeInclusive;

use glam::{Quat, Vec3};
use rand::RngExt;
use rand_pcg::Pcg64;

/// The random numbers of a case. Each name has numbers of its own, so that a new parameter does not change the others.
#[derive(Clone, Copy, Debug)]
pub struct Dice {
    seed: u64,
}

impl Dice {
    /// Of a seed; the same seed gives the same numbers.
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// The numbers of a name.
    pub fn of(&self, name: &str) -> Rolls {
        // FNV-1a.
        let hash = name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        let mut random = Pcg64::new((u128::from(self.seed) << 64) | u128::from(hash), u128::from(hash));
        // The first numbers of seeds beside each other are alike.
        let _: [u64; 4] = random.random();
        Rolls { random }
    }

    /// The seed of the `index`th case of a run.
    pub fn case(&self, index: u64) -> u64 {
        // 40 bits: short enough to be typed.
        self.of(&format!("case {index}")).random.random::<u64>() >> 24
    }
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Rolls {
    random: Pcg64,
}

impl Rolls {
    /// From 0 to 1.
    pub fn share(&mut self) -> f64 {
        self.random.random()
    }

    /// `true` so often.
    pub fn chance(&mut self, share: f64) -> bool {
        self.random.random_bool(share)
    }

    /// Evenly from a range.
    pub fn even(&mut self, range: RangeInclusive<f64>) -> f64 {
        range.start() + (range.end() - range.start()) * self.share()
    }

    /// Evenly from a range of whole numbers.
    pub fn whole(&mut self, range: RangeInclusive<u32>) -> u32 {
        self.random.random_range(range)
    }

    /// From a range of positive numbers, each decade as often as another.
    pub fn decades(&mut self, range: RangeInclusive<f64>) -> f64 {
        let number = self.even(range.start().ln()..=range.end().ln()).exp();
        number.clamp(*range.start(), *range.end())
    }

    /// One of these.
    ///
    /// # Panics
    /// If there are none.
    pub fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.random.random_range(0..of.len())]
    }

    /// A direction, evenly over the sphere.
    pub fn direction(&mut self) -> Vec3 {
        let (height, around) = (self.even(-1.0..=1.0) as f32, self.even(0.0..=std::f64::consts::TAU) as f32);
        let ring = (1.0 - height * height).sqrt();
        Vec3::new(ring * around.cos(), height, ring * around.sin())
    }

    /// A rotation by any angle about any axis.
    pub fn rotation(&mut self) -> Quat {
        let axis = self.direction();
        Quat::from_axis_angle(axis, self.even(-std::f64::consts::PI..=std::f64::consts::PI) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_seeds_have_numbers_of_their_own() {
        let dice = Dice::new(7);
        assert_eq!(dice.of("a").share(), dice.of("a").share());
        assert_ne!(dice.of("a").share(), dice.of("b").share());
        assert_ne!(dice.of("a").share(), Dice::new(8).of("a").share());
        assert_ne!(dice.case(0), dice.case(1));
    }

    #[test]
    fn numbers_stay_in_their_ranges_and_fill_them() {
        let mut rolls = Dice::new(1).of("ranges");
        let decades: Vec<f64> = (0..1000).map(|_| rolls.decades(1e-4..=1e2)).collect();
        assert!(decades.iter().all(|number| (1e-4..=1e2).contains(number)));
        let below = decades.iter().filter(|number| **number < 0.1).count();
        assert!((400..600).contains(&below), "{below} of 1000 are in the lower half of the decades");
        let mean = (0..1000).map(|_| rolls.direction()).sum::<Vec3>() / 1000.0;
        assert!(mean.length() < 0.1, "{mean}");
    }
}
