//! Places of roots, by density.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::eliminate::{eliminate, packed_radius};
use super::skin::Skin;
use super::{Amount, GrowError, Growth, SHORTEST, SkinPlace};

/// Places for each root that is wanted.
const CANDIDATES: f64 = 5.0;
/// Fewer than this are too few to choose from, and more are drawn.
const FEWEST: f64 = 4.0;
/// More strands than this nobody can draw; a density in the wrong unit easily asks for them.
const MOST_STRANDS: f64 = 2e6;
/// Places at which maps are looked at to know how much of the mesh they leave.
const SAMPLES: usize = 1 << 18;
/// More places than this are not looked at to find those with hair.
const MOST_DRAWS: f64 = (1u32 << 28) as f64;

/// Roots, each with half the distance that it keeps from others.
pub(super) struct Roots {
    pub(super) places: Vec<SkinPlace>,
    pub(super) radii: Vec<f64>,
}

/// What share of the density there is at a place.
struct Shares<'a> {
    skin: &'a Skin<'a>,
    growth: &'a Growth,
}

impl Shares<'_> {
    fn at(&self, place: &SkinPlace) -> f64 {
        let Growth { density_map, length_map, .. } = self.growth;
        if density_map.is_none() && length_map.is_none() {
            return 1.0;
        }
        let uv = self.skin.uv(place);
        let is_too_short = length_map.as_ref().is_some_and(|map| map.at::<1>(uv)[0] < SHORTEST);
        if is_too_short { 0.0 } else { density_map.as_ref().map_or(1.0, |map| map.at::<1>(uv)[0]) }
    }

    /// The largest that there can be.
    fn largest(&self) -> f64 {
        self.growth.density_map.as_ref().map_or(1.0, |map| map.largest())
    }

    /// The mean over the area.
    fn mean(&self) -> f64 {
        if self.growth.density_map.is_none() && self.growth.length_map.is_none() {
            return 1.0;
        }
        let mut random = Pcg32::seed_from_u64(self.growth.seed ^ 2);
        let sum: f64 = (0..SAMPLES).map(|index| self.at(&draw(self.skin, index, SAMPLES, &mut random))).sum();
        sum / SAMPLES as f64
    }
}

/// A place by chance in one of `count` equal parts of the area.
fn draw(skin: &Skin<'_>, index: usize, count: usize, random: &mut Pcg32) -> SkinPlace {
    let at = skin.area() * (index as f64 + random.random::<f64>()) / count as f64;
    skin.place(at, [random.random(), random.random()])
}

/// Places as far from each other as their density lets them be.
///
/// # Errors
/// Fewer than one strand or more than can be drawn, and maps that leave no place for hair.
pub(super) fn scatter(skin: &Skin<'_>, growth: &Growth) -> Result<Roots, GrowError> {
    let shares = Shares { skin, growth };
    let (mean, largest) = (shares.mean(), shares.largest());
    let bare = || GrowError::Bare { mesh: skin.mesh.name.clone(), share: mean };
    if mean * skin.area() <= 0.0 {
        return Err(bare());
    }
    let wanted = wanted(growth, skin.area() * mean)?;
    let draws = CANDIDATES * wanted * (largest / mean);
    if draws > MOST_DRAWS {
        return Err(bare());
    }
    let draws = draws.ceil() as usize;
    let mut random = Pcg32::seed_from_u64(growth.seed);
    let (mut candidates, mut radii) = (Vec::new(), Vec::new());
    // Shares are summed up, and where the sum passes a whole number there is a candidate: as many as there must be in any part of the mesh.
    let mut sum = 0.0;
    for round in 1usize.. {
        for index in 0..draws {
            let place = draw(skin, index, draws, &mut random);
            let share = shares.at(&place);
            sum += share / largest;
            if sum >= 1.0 {
                sum -= 1.0;
                candidates.push(place);
                radii.push(packed_radius(wanted * share / (skin.area() * mean)));
            }
        }
        if candidates.len() as f64 >= FEWEST * wanted {
            break;
        }
        if (round * draws) as f64 > MOST_DRAWS {
            return Err(bare());
        }
    }
    let kept = eliminate(&candidates, &radii, wanted as usize);
    let places = kept.iter().map(|&index| candidates[index]).collect();
    Ok(Roots { places, radii: kept.iter().map(|&index| radii[index]).collect() })
}

/// How many strands there are on an area.
fn wanted(growth: &Growth, area: f64) -> Result<f64, GrowError> {
    let (name, value) = match growth.amount {
        Amount::Density(density) => ("density times the area of the mesh", density * area),
        Amount::Count(count) => ("guides", count.into()),
    };
    if !(1.0..=MOST_STRANDS).contains(&value) {
        return Err(GrowError::Number { name, value, expected: "from 1 to 2 million strands" });
    }
    Ok(value.round())
}
