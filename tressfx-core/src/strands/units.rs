//! The unit of a groom, guessed from its size.

use super::Bounds;

/// What a groom measures across, in metres, as far as one can guess: a head with its hair, an animal's coat, a tail.
const TYPICAL_SIZE: f64 = 0.5;

/// Metres that a unit of a file stands for, from the box around the groom in that unit: metres, centimetres or
/// millimetres, whichever brings the groom nearest to half a metre. A groom without extent is in metres.
pub fn metres_per_unit(bounds: &Bounds) -> f32 {
    let diagonal = 2.0 * f64::from(bounds.radius());
    if diagonal.is_nan() || diagonal <= 0.0 {
        return 1.0;
    }
    let distance = |unit: f32| (diagonal * f64::from(unit) / TYPICAL_SIZE).ln().abs();
    [1.0, 0.01, 0.001].into_iter().min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn grooms_of_known_size_are_read_in_their_unit() {
        let grooms = [
            ("mane of an animal, exported in metres", 1.1, 1.0),
            ("fur ball in metres", 0.25, 1.0),
            ("human head in centimetres", 44.0, 0.01),
            ("cube with hair in centimetres", 17.0, 0.01),
            ("head in millimetres", 350.0, 0.001),
            ("a single point", 0.0, 1.0),
        ];
        for (what, diagonal, unit) in grooms {
            let bounds = Bounds { min: Vec3::ZERO, max: Vec3::X * diagonal };
            assert_eq!(metres_per_unit(&bounds), unit, "{what}");
        }
    }
}
