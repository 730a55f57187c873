//! A tree of boxes (a bounding volume hierarchy), for rays that look for all that they meet.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::rays::Ray;

/// The share of all nodes that the optimizer looks at in each of its rounds.
const OPTIMIZED: f32 = 0.05;

/// A direction is never nearer to a right angle with an axis than this: so no product is NaN.
const STEEPEST: f64 = 1e-300;

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

/// The tree.
#[derive(Debug)]
pub(crate) struct Tree {
    nodes: Vec<Bvh2Node>,
    /// Of each leaf, whose box it is.
    owners: Vec<u32>,
}

impl Tree {
    /// The tree over boxes; it is the same in every run.
    pub(crate) fn new(boxes: Boxes) -> Self {
        let Boxes { boxes, owners } = boxes;
        let numbers = (0..boxes.len() as u32).collect();
        let mut builder = PlocBuilder::with_capacity(boxes.len());
        let mut tree = builder.build(PlocSearchDistance::Medium, &boxes, numbers, SortPrecision::U64, 3);
        ReinsertionOptimizer::default().run(&mut tree, OPTIMIZED, None);
        Self { nodes: tree.nodes, owners }
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
        let inverse = ray.direction.to_array().map(|x| 1.0 / if x.abs() < STEEPEST { STEEPEST.copysign(x) } else { x });
        let inverse = DVec3::from_array(inverse);
        let meets = |node: &Bvh2Node| {
            let [a, b] = [node.aabb().min, node.aabb().max].map(|corner| (corner.as_dvec3() - ray.origin) * inverse);
            a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(end)
        };
        stack.clear();
        stack.extend(self.nodes.first().filter(|root| meets(root)).map(|_| 0));
        while let Some(node) = stack.pop() {
            let node = &self.nodes[node as usize];
            if node.is_leaf() {
                visit(self.owners[node.first_index as usize])?;
                continue;
            }
            let children = [node.first_index, node.first_index + 1];
            stack.extend(children.into_iter().filter(|&child| meets(&self.nodes[child as usize])));
        }
        ControlFlow::Continue(())
    }
}
