//! A signed distance field in f64: what the kernels `field_*` make, and how a collider reads it.

use glam::{DQuat, DVec3, UVec3, Vec3};

use crate::collider::CapsuleMotion;

use super::{
    field_bounds::field_bounds, field_crossings::field_crossings, field_flood::field_flood, field_grid::field_grid,
    field_seed::field_seed, field_sign::field_sign, field_splat::field_splat,
};

/// Triangles of which less than this is area, over the square of the square of the longest edge, are as good as segments.
const FLAT: f64 = 1e-10;

/// The way of a point past a field is followed in steps no shorter than this share of a cell,
const SHORTEST: f64 = 0.25;
/// and there are no more than these.
const STEPS: f64 = 32.0;
/// Where the normal has turned by more than what this cosine says since a point touched, it has got to another side.
const SAME_SIDE: f64 = 0.3;

/// Three corners.
pub type Triangle = [DVec3; 3];

/// Where the nodes of a field are: `origin + cell * (x, y, z)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldGrid {
    /// The first node.
    pub origin: DVec3,
    /// From one node to the next.
    pub cell: f64,
    /// Nodes along x, y and z.
    pub nodes: UVec3,
}

impl FieldGrid {
    /// How many nodes there are.
    pub fn count(&self) -> usize {
        self.nodes.element_product() as usize
    }

    /// The index of a node.
    pub fn index(&self, node: UVec3) -> usize {
        ((node.z * self.nodes.y + node.y) * self.nodes.x + node.x) as usize
    }

    /// The node of an index.
    pub fn node(&self, index: usize) -> UVec3 {
        let (index, nodes) = (index as u32, self.nodes);
        UVec3::new(index % nodes.x, index / nodes.x % nodes.y, index / nodes.x / nodes.y)
    }

    /// Triangles of a mesh, in cells from the first node.
    pub fn in_cells(&self, positions: &[Vec3], indices: &[u32]) -> Vec<Triangle> {
        let corner = |index: &u32| (positions[*index as usize].as_dvec3() - self.origin) / self.cell;
        indices.as_chunks::<3>().0.iter().map(|triangle| triangle.each_ref().map(corner)).collect()
    }
}

/// The nearest point of a node, in cells, and its triangle; none where nothing is known yet.
pub type Nearest = Option<(DVec3, u32)>;

/// A field: distances of its nodes, negative inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Where the nodes are.
    pub grid: FieldGrid,
    /// Of each node, along x first.
    pub distances: Vec<f64>,
    /// What is taken off a distance that is asked for.
    pub margin: f64,
}

impl Field {
    /// The field of a mesh with so many nodes: all kernels, one after the other. `open_edges` go from vertex to vertex, so many times.
    pub fn of(positions: &[Vec3], indices: &[u32], nodes: UVec3, open_edges: &[[i32; 3]]) -> Self {
        let grid = field_grid(field_bounds(positions, indices), nodes);
        let triangles = grid.in_cells(positions, indices);
        let mut known = field_seed(&grid, &triangles, &field_splat(&grid, &triangles));
        let half = nodes.max_element().next_power_of_two() / 2;
        for reach in (0..=half.ilog2()).rev().map(|power| 1 << power).chain([1]) {
            known = field_flood(&grid, &triangles, &known, reach);
        }
        let distances = field_sign(&grid, positions, &known, &field_crossings(&grid, &triangles), open_edges);
        Self { grid, distances, margin: 0.0 }
    }

    /// A field that was read back ([`Fields::read`](crate::field::Fields::read)): its header and its distances. `None` where there are too few words.
    pub fn from_words(header: &[u32], distances: &[u32]) -> Option<Self> {
        let header: &[u32; 16] = header.first_chunk()?;
        let number = |word: usize| f64::from(f32::from_bits(header[word]));
        let nodes = UVec3::new(header[4], header[5], header[6]);
        let grid = FieldGrid { origin: DVec3::new(number(0), number(1), number(2)), cell: number(3), nodes };
        let distances = distances.get(..grid.count())?;
        let distances = distances.iter().map(|&word| f64::from(f32::from_bits(word))).collect();
        Some(Self { grid, distances, margin: number(7) })
    }

    /// The distance of a point less the margin, interpolated between the eight nodes around it, and the direction away from the surface; beyond the outermost
    /// nodes no more than the distance is.
    pub fn sample(&self, point: DVec3) -> (f64, DVec3) {
        let FieldGrid { origin, cell, nodes } = self.grid;
        let (asked, end) = ((point - origin) / cell, nodes.as_dvec3() - 1.0);
        let within = asked.clamp(DVec3::ZERO, end);
        let low = within.floor().min(end - 1.0);
        let share = within - low;
        let (mut distance, mut gradient) = (0.0, DVec3::ZERO);
        for corner in 0..8 {
            let side = UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let at = self.distances[self.grid.index(low.as_uvec3() + side)];
            let weights = DVec3::select(side.cmpeq(UVec3::ONE), share, 1.0 - share);
            let slopes = DVec3::select(side.cmpeq(UVec3::ONE), DVec3::ONE, DVec3::NEG_ONE);
            distance += at * weights.element_product();
            gradient += at
                * DVec3::new(
                    slopes.x * weights.y * weights.z,
                    slopes.y * weights.x * weights.z,
                    slopes.z * weights.x * weights.y,
                );
        }
        let beyond = cell * (asked - within).length();
        // The mesh is within the box: seen from its side, what is beyond and what is within are at a right angle or more.
        let distance = if beyond > 0.0 { distance.hypot(beyond) } else { distance };
        (distance - self.margin, gradient.normalize_or_zero())
    }
}

/// A field that strands collide with in a sub-step, in the space of the head, relative to the centre of the groom: points of its mesh are rotated, then
/// moved by the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedField<'a> {
    /// The field.
    pub field: &'a Field,
    /// The rotation.
    pub rotation: DQuat,
    /// The translation.
    pub translation: DVec3,
    /// How it has moved during the sub-step.
    pub motion: CapsuleMotion,
}

impl PlacedField<'_> {
    /// [`Field::sample`] of a point in the space of the head.
    pub fn sample(&self, point: DVec3) -> (f64, DVec3) {
        let (distance, normal) = self.field.sample(self.rotation.inverse() * (point - self.translation));
        (distance, self.rotation * normal)
    }

    /// Where a point that goes along `way` to `point`, as the field sees it, first touches: the share of the way, and what is sampled there. What begins inside
    /// touches at the beginning.
    pub(super) fn first_touch(&self, point: DVec3, way: DVec3) -> Option<(f64, f64, DVec3)> {
        let length = way.length();
        let shortest = (SHORTEST * self.field.grid.cell).max(length / STEPS);
        let mut gone = 0.0;
        while gone < length {
            let (distance, normal) = self.sample(point - way * (1.0 - gone / length));
            if distance <= 0.0 {
                return Some((gone / length, distance, normal));
            }
            gone += distance.max(shortest);
        }
        None
    }

    /// The plane that holds a point which has gone along `way` to where it is: the distance from it and its normal. That of the surface where the point is; or
    /// where it has got to another side, that of the surface where it has touched first.
    pub(super) fn met_by(&self, point: DVec3, way: DVec3) -> (f64, DVec3) {
        let found = self.sample(point);
        if found.0 > way.length() {
            return found;
        }
        match self.first_touch(point, way) {
            Some((share, distance, normal)) if found.1.dot(normal) < SAME_SIDE => {
                (distance + (1.0 - share) * way.dot(normal), normal)
            }
            _ => found,
        }
    }
}

/// The point of a triangle that is nearest to a point.
pub fn nearest_on(triangle: &Triangle, point: DVec3) -> DVec3 {
    let [a, b, c] = *triangle;
    let normal = (b - a).cross(c - a);
    let squared = normal.length_squared();
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    if squared > FLAT * longest * longest {
        let foot = point - normal * ((point - a).dot(normal) / squared);
        let is_left = |from: DVec3, to: DVec3| (to - from).cross(foot - from).dot(normal) >= 0.0;
        if is_left(a, b) && is_left(b, c) && is_left(c, a) {
            return foot;
        }
    }
    let on_edge = |from: DVec3, to: DVec3| {
        let (edge, squared) = (to - from, (to - from).length_squared());
        let share = if squared > 0.0 { ((point - from).dot(edge) / squared).clamp(0.0, 1.0) } else { 0.0 };
        from + share * edge
    };
    let nearer = |one: DVec3, other: DVec3| {
        if other.distance_squared(point) < one.distance_squared(point) { other } else { one }
    };
    nearer(nearer(on_edge(a, b), on_edge(b, c)), on_edge(c, a))
}
