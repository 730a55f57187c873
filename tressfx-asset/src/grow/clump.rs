//! Clumps: strands whose tips are drawn to the strand in their middle.

use glam::DVec3;

use super::eliminate::eliminate;
use super::scatter::Roots;
use super::strand::set_edges;
use super::{Growth, SkinPlace};

/// Draws strands to the nearest of so many strands among them, which are as far from each other as their density lets them be. Says which that is,
/// for each strand; itself where nothing else is on its side of the skin. Edges keep their lengths.
pub(super) fn draw_together(growth: &Growth, roots: &Roots, points: &mut [DVec3]) -> Vec<usize> {
    let Roots { places, radii } = roots;
    let wider = (places.len() as f64 / f64::from(growth.clumps)).sqrt();
    let radii: Vec<f64> = radii.iter().map(|radius| radius * wider).collect();
    let nearest = Nearest::new(places, eliminate(places, &radii, growth.clumps as usize));
    let vertices = growth.vertices as usize;
    let before = points.to_vec();
    let strands = points.chunks_exact_mut(vertices).enumerate();
    let drawn = strands.map(|(strand, points)| {
        let middle = nearest.of(&places[strand]).unwrap_or(strand);
        let edge = points[0].distance(points[1]);
        let others = &before[middle * vertices..];
        for (vertex, (point, other)) in points.iter_mut().zip(others).enumerate() {
            let way = vertex as f64 / f64::from(growth.vertices - 1);
            *point = point.lerp(*other, f64::from(growth.clump) * way * way);
        }
        set_edges(points, edge);
        middle
    });
    drawn.collect()
}

/// Finds the nearest of some places: they are sorted along an axis, and what is further along it than the best so far is not looked at.
struct Nearest<'a> {
    places: &'a [SkinPlace],
    sorted: Vec<usize>,
}

impl<'a> Nearest<'a> {
    fn new(places: &'a [SkinPlace], mut sorted: Vec<usize>) -> Self {
        sorted.sort_by(|&one, &other| places[one].position.x.total_cmp(&places[other].position.x));
        Self { places, sorted }
    }

    /// That on the same side of the skin.
    fn of(&self, place: &SkinPlace) -> Option<usize> {
        let from = self.sorted.partition_point(|&other| self.places[other].position.x < place.position.x);
        let (mut best, mut distance) = (None, f64::INFINITY);
        let mut look = |side: &mut dyn Iterator<Item = &usize>| {
            for &other in side {
                let SkinPlace { position, normal, .. } = self.places[other];
                if (position.x - place.position.x).abs() >= distance {
                    break;
                }
                if normal.dot(place.normal) > 0.0 && position.distance(place.position) < distance {
                    (best, distance) = (Some(other), position.distance(place.position));
                }
            }
        };
        look(&mut self.sorted[from..].iter());
        look(&mut self.sorted[..from].iter().rev());
        best
    }
}
