//! Sample elimination: of many places those are left that are far from each other.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::SkinPlace;
use super::near::Neighbours;

/// How fast a weight falls with the distance, as in the paper.
const ALPHA: i32 = 8;

/// A weight by whose bits a heap can sort: weights are not negative.
type Key = (u64, usize);

/// Half the distance between neighbours in the densest packing of so many places in a square unit.
pub(super) fn packed_radius(density: f64) -> f64 {
    (1.0 / (2.0 * 3f64.sqrt() * density)).sqrt()
}

/// Takes the place with the largest weight away until `wanted` are left, and says which those are. A weight is a sum over the places within the sum of two
/// radii: at an edge in the density neither side takes much from the other. Places on two sides of a thin part of the mesh, such as an ear, are near each
/// other and yet take no room from each other.
pub(super) fn eliminate(places: &[SkinPlace], radii: &[f64], wanted: usize) -> Vec<usize> {
    let near = Neighbours::new(places, radii);
    let weight = |one: usize, other: usize| {
        let distance = places[one].position.distance(places[other].position);
        (1.0 - (distance / (radii[one] + radii[other])).min(1.0)).powi(ALPHA)
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
    (0..places.len()).filter(|&place| is_left[place]).collect()
}
