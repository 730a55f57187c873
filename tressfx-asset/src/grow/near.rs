//! Which places are near each other.

use std::collections::HashMap;

use glam::{DVec3, I64Vec3};

use super::SkinPlace;

/// For every place those that take room from it: within the sum of the radii of both, and on the same side of the skin.
pub(super) struct Neighbours {
    /// Where the neighbours of each place begin, and the end.
    starts: Vec<usize>,
    others: Vec<u32>,
}

/// The places whose radii have one power of two, in cells that are twice as large as the largest radius of them.
#[derive(Default)]
struct Level {
    size: f64,
    cells: HashMap<I64Vec3, Vec<u32>>,
}

impl Neighbours {
    /// Each place looks among those of its own level and of the levels above it, of which there are few, so one with a large radius need not look at
    /// all that are near it.
    pub(super) fn new(places: &[SkinPlace], radii: &[f64]) -> Self {
        let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
        let level = |place: usize| (radii[place] / least).log2() as usize;
        let levels = levels(places, radii, level);
        // Pairs are found twice, so that they need not be kept: to count them, and to store them.
        let each_pair = |pair: &mut dyn FnMut(usize, usize)| {
            for one in 0..places.len() {
                for (above, of) in levels.iter().enumerate().skip(level(one)) {
                    for other in of.around(places[one].position) {
                        let is_once = above > level(one) || other > one;
                        if is_once && are_near(&places[one], &places[other], radii[one] + radii[other]) {
                            pair(one, other);
                        }
                    }
                }
            }
        };
        let mut starts = vec![0; places.len() + 1];
        each_pair(&mut |one, other| {
            starts[one + 1] += 1;
            starts[other + 1] += 1;
        });
        for place in 0..places.len() {
            starts[place + 1] += starts[place];
        }
        let mut ends = starts.clone();
        let mut others = vec![0; starts[places.len()]];
        each_pair(&mut |one, other| {
            for (place, neighbour) in [(one, other), (other, one)] {
                others[ends[place]] = neighbour as u32;
                ends[place] += 1;
            }
        });
        Self { starts, others }
    }

    pub(super) fn of(&self, place: usize) -> impl Iterator<Item = usize> + '_ {
        self.others[self.starts[place]..self.starts[place + 1]].iter().map(|&other| other as usize)
    }
}

fn levels(places: &[SkinPlace], radii: &[f64], level: impl Fn(usize) -> usize) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for (place, radius) in radii.iter().enumerate() {
        levels.resize_with(levels.len().max(level(place) + 1), Level::default);
        let size = &mut levels[level(place)].size;
        *size = size.max(2.0 * radius);
    }
    for (index, place) in places.iter().enumerate() {
        let Level { size, cells } = &mut levels[level(index)];
        cells.entry(cell(place.position, *size)).or_default().push(index as u32);
    }
    levels
}

impl Level {
    fn around(&self, position: DVec3) -> impl Iterator<Item = usize> + '_ {
        let middle = cell(position, self.size);
        let cells = (0..27).map(move |i| middle + I64Vec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        cells.filter_map(|cell| self.cells.get(&cell)).flatten().map(|&other| other as usize)
    }
}

fn are_near(one: &SkinPlace, other: &SkinPlace, within: f64) -> bool {
    one.position.distance(other.position) < within && one.normal.dot(other.normal) > 0.0
}

fn cell(position: DVec3, size: f64) -> I64Vec3 {
    (position / size).floor().as_i64vec3()
}
