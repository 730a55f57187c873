//! Strands of one vertex count, from strands of any.

use std::ops::Range;

use glam::DVec3;

/// Where a new vertex is between old ones: behind `vertex`, by a share of the way to the next one.
#[derive(Clone, Copy)]
struct Place {
    vertex: usize,
    share: f64,
}

impl Place {
    /// What is at the place; at a vertex that is the vertex's, to the bit.
    fn at<const N: usize>(self, values: &[[f32; N]]) -> [f32; N] {
        let (a, share) = (values[self.vertex], self.share);
        if share == 0.0 {
            return a;
        }
        let b = values[self.vertex + 1];
        std::array::from_fn(|i| (f64::from(a[i]) + (f64::from(b[i]) - f64::from(a[i])) * share) as f32)
    }
}

/// Strands of any vertex counts as strands of one count: vertices are evenly spaced by arc length; first and last stay where they are, to the bit. A strand
/// that has the count already is copied to the bit; one of no length is spaced by index.
pub(super) struct Resampled {
    places: Vec<Vec<Place>>,
    strands: Vec<Range<usize>>,
}

impl Resampled {
    /// `strands` are the ranges of the old vertices of the strands.
    pub(super) fn new(points: &[[f32; 3]], strands: Vec<Range<usize>>, vertices: u32) -> Self {
        let places = strands.iter().map(|strand| places(&points[strand.clone()], vertices as usize)).collect();
        Self { places, strands }
    }

    /// Values at the new vertices, from those at the old ones.
    pub(super) fn values<const N: usize>(&self, values: &[[f32; N]]) -> Vec<[f32; N]> {
        let mut made = Vec::with_capacity(self.places.iter().map(Vec::len).sum());
        for (places, strand) in self.places.iter().zip(&self.strands) {
            made.extend(places.iter().map(|place| place.at(&values[strand.clone()])));
        }
        made
    }

    /// Inverse masses at the new vertices.
    pub(super) fn masses(&self, masses: &[f32]) -> Vec<f32> {
        let mut made = self.values(masses.as_chunks::<1>().0).into_flattened();
        let mut start = 0;
        for (places, strand) in self.places.iter().zip(&self.strands) {
            if places.len() != strand.len() {
                keep_pins(&masses[strand.clone()], &mut made[start..start + places.len()]);
            }
            start += places.len();
        }
        made
    }
}

fn places(points: &[[f32; 3]], vertices: usize) -> Vec<Place> {
    let at = |vertex| Place { vertex, share: 0.0 };
    if points.len() == vertices {
        return (0..vertices).map(at).collect();
    }
    let arc = arc_lengths(points);
    let (mut made, tip, mut segment) = (vec![at(0)], points.len() - 1, 0);
    for vertex in 1..vertices - 1 {
        let along = arc[tip] * vertex as f64 / (vertices - 1) as f64;
        while segment + 1 < tip && arc[segment + 1] < along {
            segment += 1;
        }
        let span = arc[(segment + 1).min(tip)] - arc[segment];
        let share = if span > 0.0 { ((along - arc[segment]) / span).clamp(0.0, 1.0) } else { 0.0 };
        made.push(Place { vertex: segment, share });
    }
    made.push(at(tip));
    made
}

/// Distance from the root along the strand, or the index where the strand has no length.
fn arc_lengths(points: &[[f32; 3]]) -> Vec<f64> {
    let mut arc = vec![0.0; points.len()];
    for i in 1..points.len() {
        arc[i] = arc[i - 1] + segment_length(points[i - 1], points[i]);
    }
    if arc[arc.len() - 1] == 0.0 {
        arc.iter_mut().enumerate().for_each(|(i, arc)| *arc = i as f64);
    }
    arc
}

/// The distance of two points, computed in f64.
fn segment_length(a: [f32; 3], b: [f32; 3]) -> f64 {
    DVec3::from_array(a.map(f64::from)).distance(DVec3::from_array(b.map(f64::from)))
}

/// Pins as many of the first and of the last vertices as the file did, up to two: coarser vertices would otherwise lose
/// the second pin, which holds the direction of the root.
fn keep_pins(masses: &[f32], out: &mut [f32]) {
    let most = if out.len() > 2 { 2 } else { 1 };
    let pins = |masses: &mut dyn Iterator<Item = &f32>| masses.take_while(|&&mass| mass == 0.0).count().min(most);
    let (first, last) = (pins(&mut masses.iter()), pins(&mut masses.iter().rev()));
    out.iter_mut().take(first).for_each(|mass| *mass = 0.0);
    out.iter_mut().rev().take(last).for_each(|mass| *mass = 0.0);
}
