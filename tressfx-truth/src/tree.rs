//! A tree of boxes (a bounding volume hierarchy), for rays that look for all that they meet.
//!
//! It is built by `obvhs`, of pairs, and made wide: four boxes are looked at together.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3, Vec4};
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::rays::Ray;

/// The share of all nodes that the optimizer looks at in each of its rounds.
const OPTIMIZED: f32 = 0.05;

/// A direction is never nearer to a right angle with an axis than this: so no product is NaN.
const STEEPEST: f32 = 1e-30;

/// What rounding to f32 may do to a parameter on a ray, as a share: that of the direction, its inverse, a difference, a product.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Boxes, and of each the number of what is in it.
#[derive(Debug)]
pub(crate) struct Boxes {
    boxes: Vec<Aabb>,
    owners: Vec<u32>,
}

impl Boxes {
    pub(crate) fn with_capacity(count: usize) -> Self {
        Self { boxes: Vec::with_capacity(count), owners: Vec::with_capacity(count) }
    }

    /// Adds the box between two corners, for what has the number `owner`. It is made larger by what rounding to f32 takes.
    pub(crate) fn push(&mut self, low: DVec3, high: DVec3, owner: u32) {
        let low = low.to_array().map(|x| (x as f32).next_down());
        let high = high.to_array().map(|x| (x as f32).next_up());
        self.boxes.push(Aabb::new(Vec3::from_array(low).into(), Vec3::from_array(high).into()));
        self.owners.push(owner);
    }
}

/// Up to four boxes.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Of each axis, the corners of all of them.
    low: [Vec4; 3],
    high: [Vec4; 3],
    /// The node that is in each box, or the number of its owner.
    inside: [u32; 4],
    /// A bit for each box that there is, and for each that has an owner.
    used: u32,
    owned: u32,
}

/// The tree.
#[derive(Debug)]
pub(crate) struct Tree {
    /// The first is the root.
    nodes: Vec<Node>,
}

/// A ray in f32, and what it is off by.
struct Line {
    /// The origin is not above the first, nor below the second.
    origin: [Vec3; 2],
    inverse: Vec3,
    end: f32,
}

impl Line {
    fn new(ray: &Ray, end: f64) -> Self {
        let origin = ray.origin.to_array();
        let (up, down) = (origin.map(|x| (x as f32).next_up()), origin.map(|x| (x as f32).next_down()));
        let steep = |x: f32| if x.abs() < STEEPEST { STEEPEST.copysign(x) } else { x };
        let inverse = ray.direction.to_array().map(|x| 1.0 / steep(x as f32));
        let origin = [Vec3::from_array(up), Vec3::from_array(down)];
        Self { origin, inverse: Vec3::from_array(inverse), end: (end as f32).next_up() }
    }

    /// A bit for each box of a node that is met.
    fn meets(&self, node: &Node) -> u32 {
        let (mut enter, mut exit) = (Vec4::ZERO, Vec4::splat(self.end));
        for axis in 0..3 {
            let a = (node.low[axis] - self.origin[0][axis]) * self.inverse[axis];
            let b = (node.high[axis] - self.origin[1][axis]) * self.inverse[axis];
            (enter, exit) = (enter.max(a.min(b)), exit.min(a.max(b)));
        }
        (enter * (1.0 - ROUNDING)).cmple(exit * (1.0 + ROUNDING)).bitmask() & node.used
    }
}

impl Tree {
    /// The tree over boxes; it is the same in every run.
    pub(crate) fn new(boxes: Boxes) -> Self {
        let Boxes { boxes, owners } = boxes;
        let numbers = (0..boxes.len() as u32).collect();
        let mut builder = PlocBuilder::with_capacity(boxes.len());
        let mut pairs = builder.build(PlocSearchDistance::Medium, &boxes, numbers, SortPrecision::U64, 3);
        ReinsertionOptimizer::default().run(&mut pairs, OPTIMIZED, None);
        let mut nodes = Vec::with_capacity(pairs.nodes.len() / 4 + 1);
        let mut waiting: Vec<(u32, Option<(usize, usize)>)> =
            pairs.nodes.first().map(|_| (0, None)).into_iter().collect();
        while let Some((pair, parent)) = waiting.pop() {
            let number = nodes.len();
            if let Some((node, slot)) = parent {
                let node: &mut Node = &mut nodes[node];
                node.inside[slot] = number as u32;
            }
            let inside = widened(&pairs.nodes, pair);
            nodes.push(Node::new(&pairs.nodes, &inside, &owners));
            let inner = inside.iter().enumerate().filter(|(_, inside)| !pairs.nodes[**inside as usize].is_leaf());
            waiting.extend(inner.map(|(slot, &inside)| (inside, Some((number, slot)))));
        }
        Self { nodes }
    }

    /// Calls `visit` with the owner of each box that a ray meets between its origin and the parameter `end`, in no order, until
    /// it breaks. An owner of several boxes may come several times.
    pub(crate) fn visit(
        &self,
        stack: &mut Vec<u32>,
        ray: &Ray,
        end: f64,
        mut visit: impl FnMut(u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let line = Line::new(ray, end);
        stack.clear();
        stack.extend(self.nodes.first().map(|_| 0));
        while let Some(node) = stack.pop() {
            let node = &self.nodes[node as usize];
            let mut met = line.meets(node);
            while met != 0 {
                let slot = met.trailing_zeros();
                met &= met - 1;
                let inside = node.inside[slot as usize];
                if node.owned >> slot & 1 == 0 {
                    stack.push(inside);
                } else {
                    visit(inside)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Up to four nodes of pairs that a node holds: the largest is opened first.
fn widened(pairs: &[Bvh2Node], node: u32) -> Vec<u32> {
    let mut inside = vec![node];
    while inside.len() < 4 {
        let inner = (0..inside.len()).filter(|&i| !pairs[inside[i] as usize].is_leaf());
        let area = |i: usize| pairs[inside[i] as usize].aabb().half_area();
        let Some(largest) = inner.max_by(|&a, &b| area(a).total_cmp(&area(b))) else { break };
        let first = pairs[inside[largest] as usize].first_index;
        inside[largest] = first;
        inside.push(first + 1);
    }
    inside
}

impl Node {
    /// Boxes around nodes of pairs. What is in those that are no leaves, is not known yet.
    fn new(pairs: &[Bvh2Node], inside: &[u32], owners: &[u32]) -> Self {
        let mut node = Self { low: [Vec4::ZERO; 3], high: [Vec4::ZERO; 3], inside: [0; 4], used: 0, owned: 0 };
        for (slot, pair) in inside.iter().map(|&pair| &pairs[pair as usize]).enumerate() {
            for axis in 0..3 {
                node.low[axis][slot] = pair.aabb().min[axis];
                node.high[axis][slot] = pair.aabb().max[axis];
            }
            node.used |= 1 << slot;
            if pair.is_leaf() {
                node.owned |= 1 << slot;
                node.inside[slot] = owners[pair.first_index as usize];
            }
        }
        node
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [0, 1) that are the same everywhere.
    struct Random(u32);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            f64::from(self.0 >> 8) / f64::from(1 << 24)
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
    }

    #[test]
    fn every_ball_that_a_ray_meets_is_visited() {
        let mut random = Random(11);
        // Near to and far from where numbers are finest, and one that is far from all others.
        for (place, count) in [(DVec3::ZERO, 500), (DVec3::new(1e3, -1e5, 10.0), 500), (DVec3::ONE, 1), (DVec3::ONE, 3)]
        {
            let mut balls: Vec<_> =
                (0..count).map(|_| (place + random.vector(), 0.1 * random.unit().powi(4))).collect();
            balls.push((DVec3::splat(1e12), 1.0));
            let mut boxes = Boxes::with_capacity(count);
            for (&(center, radius), owner) in balls.iter().zip(0..) {
                boxes.push(center - radius, center + radius, owner);
            }
            let (tree, mut stack) = (Tree::new(boxes), Vec::new());
            let (mut met, mut visited) = (0, 0);
            for i in 0..2000 {
                let (target, radius) = balls[(random.unit() * count as f64) as usize];
                let towards = [random.vector(), DVec3::X, DVec3::new(1.0, 1e-40, -0.0)][[0, 0, 1, 2][i % 4]];
                let direction = towards.normalize();
                let origin = target + random.vector() * radius - direction * 2.0 * random.unit();
                let (ray, end) = (Ray { origin, direction }, if i % 2 == 0 { f64::INFINITY } else { random.unit() });
                let mut found = vec![false; balls.len()];
                let all = tree.visit(&mut stack, &ray, end, |owner| {
                    found[owner as usize] = true;
                    ControlFlow::Continue(())
                });
                assert!(all.is_continue());
                for ((center, radius), found) in balls.iter().zip(&found) {
                    let s = (*center - origin).dot(direction).clamp(0.0, end);
                    let is_met = ray.at(s).distance(*center) < *radius;
                    assert!(*found || !is_met, "{i}: {ray:?} to {end} meets {center} {radius}");
                    met += u32::from(is_met);
                }
                visited += found.into_iter().map(u32::from).sum::<u32>();
            }
            assert!(met > 500 && visited < 40 * met, "{met} of {visited}");
        }
    }

    #[test]
    fn a_visit_ends_where_it_is_told_to() {
        let mut boxes = Boxes::with_capacity(9);
        (0..9).for_each(|owner| boxes.push(DVec3::NEG_ONE, DVec3::ONE, owner));
        let (tree, mut count) = (Tree::new(boxes), 0);
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
        let end = tree.visit(&mut Vec::new(), &ray, 1.0, |_| {
            count += 1;
            if count == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(end.is_break() && count == 4);
        assert!(Tree::new(Boxes::with_capacity(0)).visit(&mut Vec::new(), &ray, 1.0, |_| unreachable!()).is_continue());
    }
}
