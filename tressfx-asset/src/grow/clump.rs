//! Clumps: strands whose tips are drawn to the strand in their middle.

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;

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

/// Finds the nearest of some places.
struct Nearest<'a> {
    places: &'a [SkinPlace],
    tree: RTree<GeomWithData<[f64; 3], usize>>,
}

impl<'a> Nearest<'a> {
    fn new(places: &'a [SkinPlace], some: Vec<usize>) -> Self {
        let entry = |place: usize| GeomWithData::new(places[place].position.to_array(), place);
        Self { places, tree: RTree::bulk_load(some.into_iter().map(entry).collect()) }
    }

    /// That on the same side of the skin.
    fn of(&self, place: &SkinPlace) -> Option<usize> {
        let mut by_distance = self.tree.nearest_neighbor_iter(place.position.to_array()).map(|entry| entry.data);
        by_distance.find(|&other| self.places[other].normal.dot(place.normal) > 0.0)
    }
}
