//! Sample elimination: of many places those are left that are far from each other.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use glam::{DVec3, I64Vec3};

use super::SkinPlace;

/// How fast a weight falls with the distance, as in the paper.
const ALPHA: i32 = 8;

/// A weight by whose bits a heap can sort: weights are not negative.
type Key = (u64, usize);

/// Takes the place with the largest weight away until `wanted` are left. A weight is a sum over the places near by. Places on two sides of a thin
/// part of the mesh, such as an ear, are near each other and yet take no room from each other.
pub(super) fn eliminate(places: &[SkinPlace], wanted: usize, area: f64) -> Vec<SkinPlace> {
    // The radius of the densest packing of so many discs in the area.
    let radius = (area / (2.0 * 3f64.sqrt() * wanted as f64)).sqrt();
    let near = Neighbours::new(places, 2.0 * radius);
    let weight = |one: usize, other: usize| {
        let distance = places[one].position.distance(places[other].position);
        (1.0 - (distance / (2.0 * radius)).min(1.0)).powi(ALPHA)
    };
    let mut weights: Vec<f64> =
        (0..places.len()).map(|one| near.of(one).map(|other| weight(one, other)).sum()).collect();
    let key = |weights: &[f64], place: usize| (weights[place].to_bits(), place);
    let mut heap: BinaryHeap<(u64, Reverse<usize>)> = (0..places.len())
        .map(|place| key(&weights, place))
        .map(|(weight, place): Key| (weight, Reverse(place)))
        .collect();
    let mut is_left = vec![true; places.len()];
    let mut left = places.len();
    while left > wanted {
        let Some((bits, Reverse(place))) = heap.pop() else { break };
        // What was pushed before a neighbour went has another weight by now.
        if !is_left[place] || bits != weights[place].to_bits() {
            continue;
        }
        is_left[place] = false;
        left -= 1;
        for other in near.of(place).filter(|&other| is_left[other]) {
            weights[other] = (weights[other] - weight(place, other)).max(0.0);
            heap.push((weights[other].to_bits(), Reverse(other)));
        }
    }
    places.iter().zip(is_left).filter(|(_, is_left)| *is_left).map(|(place, _)| *place).collect()
}

/// Finds the places within a radius: a grid of cells of that size.
struct Neighbours<'a> {
    places: &'a [SkinPlace],
    radius: f64,
    cells: HashMap<I64Vec3, Vec<usize>>,
}

impl<'a> Neighbours<'a> {
    fn new(places: &'a [SkinPlace], radius: f64) -> Self {
        let mut cells: HashMap<I64Vec3, Vec<usize>> = HashMap::new();
        for (index, place) in places.iter().enumerate() {
            cells.entry(cell(place.position, radius)).or_default().push(index);
        }
        Self { places, radius, cells }
    }

    fn of(&self, place: usize) -> impl Iterator<Item = usize> + '_ {
        let SkinPlace { position, normal, .. } = self.places[place];
        let middle = cell(position, self.radius);
        let around = (0..27).map(move |i| middle + I64Vec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        around.filter_map(|cell| self.cells.get(&cell)).flatten().copied().filter(move |&other| {
            let SkinPlace { position: there, normal: across, .. } = self.places[other];
            other != place && position.distance(there) < self.radius && normal.dot(across) > 0.0
        })
    }
}

fn cell(position: DVec3, size: f64) -> I64Vec3 {
    (position / size).floor().as_i64vec3()
}
