//! Strands of one vertex count, from strands of any.

use glam::DVec3;

/// The vertices of a strand, as positions and inverse masses.
#[derive(Clone, Copy)]
pub(super) struct Strand<'a> {
    pub(super) points: &'a [[f32; 3]],
    pub(super) masses: &'a [f32],
}

/// Appends `vertices` vertices of a strand, evenly spaced by arc length; first and last stay where they are, to the bit.
/// A strand that has the count already is copied to the bit; one of no length is spaced by index.
pub(super) fn resample(strand: Strand<'_>, vertices: usize, out: &mut Vec<glam::Vec4>) {
    let Strand { points, masses } = strand;
    let push = |out: &mut Vec<_>, [x, y, z]: [f32; 3], mass| out.push(glam::Vec4::new(x, y, z, mass));
    if points.len() == vertices {
        points.iter().zip(masses).for_each(|(&point, &mass)| push(out, point, mass));
        return;
    }
    let arc = arc_lengths(points);
    let (start, tip) = (out.len(), points.len() - 1);
    push(out, points[0], masses[0]);
    let mut segment = 0;
    for vertex in 1..vertices - 1 {
        let at = arc[tip] * vertex as f64 / (vertices - 1) as f64;
        while segment + 1 < tip && arc[segment + 1] < at {
            segment += 1;
        }
        let (a, b) = (segment, (segment + 1).min(tip));
        let span = arc[b] - arc[a];
        let t = if span > 0.0 { ((at - arc[a]) / span).clamp(0.0, 1.0) } else { 0.0 };
        push(out, lerp(points[a], points[b], t), mass_between(masses[a], masses[b], t));
    }
    push(out, points[tip], masses[tip]);
    keep_pins(masses, &mut out[start..]);
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

fn lerp(a: [f32; 3], b: [f32; 3], t: f64) -> [f32; 3] {
    let [a, b] = [a, b].map(|p| DVec3::from_array(p.map(f64::from)));
    a.lerp(b, t).as_vec3().to_array()
}

fn mass_between(a: f32, b: f32, t: f64) -> f32 {
    (f64::from(a) + (f64::from(b) - f64::from(a)) * t) as f32
}

/// Pins as many of the first and of the last vertices as the file did, up to two: coarser vertices would otherwise lose
/// the second pin, which holds the direction of the root.
fn keep_pins(masses: &[f32], out: &mut [glam::Vec4]) {
    let most = if out.len() > 2 { 2 } else { 1 };
    let pins = |masses: &mut dyn Iterator<Item = &f32>| masses.take_while(|&&mass| mass == 0.0).count().min(most);
    let (first, last) = (pins(&mut masses.iter()), pins(&mut masses.iter().rev()));
    out.iter_mut().take(first).for_each(|vertex| vertex.w = 0.0);
    out.iter_mut().rev().take(last).for_each(|vertex| vertex.w = 0.0);
}
