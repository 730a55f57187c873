//! `hair.sim.field_crossings` in f64.

use super::field::{FieldGrid, Triangle};

/// Parts of all nodes together.
const PARTS: u32 = 1 << 14;

/// The place of a point across the lines along z, in parts of a cell.
pub(super) fn part_of(point: glam::DVec3, parts: i32) -> [i64; 2] {
    // The exact tie is the kernel's: half to even.
    [point.x, point.y].map(|place| (place * f64::from(parts)).round_ties_even() as i64)
}

/// Parts of a cell.
pub(super) fn parts(grid: &FieldGrid) -> i32 {
    (PARTS / grid.nodes.max_element().next_power_of_two()) as i32
}

fn minus(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn twice_area(a: [i64; 2], b: [i64; 2]) -> i64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Whether a line at 0 is to the left of an edge; one through the edge counts as if it were a little further along y, and less along -x.
pub(super) fn is_left(a: [i64; 2], b: [i64; 2]) -> bool {
    match twice_area(a, b) {
        0 => b > a,
        area => area > 0,
    }
}

/// The sum over all nodes from one on is how often the way from there along z leaves the mesh more than it enters it.
pub fn field_crossings(grid: &FieldGrid, triangles: &[Triangle]) -> Vec<i32> {
    let (mut crossings, parts) = (vec![0; grid.count()], parts(grid));
    for corners in triangles.iter().filter(|corners| corners.iter().all(|corner| corner.is_finite())) {
        let places = corners.map(|corner| part_of(corner, parts));
        let area = twice_area(minus(places[1], places[0]), minus(places[2], places[0]));
        let range = |axis: usize| {
            let [least, most] =
                [i64::min, i64::max].map(|of| places.iter().map(|place| place[axis]).reduce(of).unwrap_or(0));
            let cell = i64::from(parts);
            (least + cell - 1) / cell..=most / cell
        };
        for (x, y) in range(1).flat_map(|y| range(0).map(move |x| (x, y))) {
            let [a, b, c] = places.map(|place| minus(place, [x * i64::from(parts), y * i64::from(parts)]));
            let is_crossed = [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| is_left(from, to) == (area > 0));
            if area == 0 || !is_crossed {
                continue;
            }
            let shares = [twice_area(b, c), twice_area(c, a), twice_area(a, b)];
            let height: f64 = shares.iter().zip(corners).map(|(&share, corner)| share as f64 * corner.z).sum();
            let node = ((height / area as f64).ceil() as i64).min(grid.nodes.z.into()) - 1;
            if node >= 0 {
                let node = glam::UVec3::new(x as u32, y as u32, node as u32);
                crossings[grid.index(node)] += area.signum() as i32;
            }
        }
    }
    crossings
}
