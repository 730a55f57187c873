//! The triangle nearest to a point: a tree of boxes, in f64. The tree of `obvhs`, which the reference renderer traces rays in, has no such question.

use glam::DVec3;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// The nearest point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    pub(super) triangle: usize,
    pub(super) point: DVec3,
    pub(super) squared: f64,
}

/// A tree over triangles that have an area.
#[derive(Debug)]
pub(super) struct Tree<'a> {
    triangles: &'a [[DVec3; 3]],
    /// Triangles in the order of the leaves.
    order: Vec<usize>,
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Of the order.
    first: usize,
    count: usize,
    /// The second child; the first is the next node. 0 for a leaf.
    second: usize,
}

impl<'a> Tree<'a> {
    /// Of these of the triangles.
    pub(super) fn new(triangles: &'a [[DVec3; 3]], order: Vec<usize>) -> Self {
        let mut tree = Self { triangles, order, nodes: Vec::new() };
        if !tree.order.is_empty() {
            tree.build(0, tree.order.len());
        }
        tree
    }

    /// Halves the triangles along the longest side of the box around their middles.
    fn build(&mut self, first: usize, count: usize) {
        let triangles = self.triangles;
        let of = &mut self.order[first..first + count];
        let corners = || of.iter().flat_map(|&triangle| triangles[triangle]);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let node = self.nodes.len();
        self.nodes.push(Node { low, high, first, count, second: 0 });
        if count <= LEAF {
            return;
        }
        let axis = (high - low).max_position();
        let middle = |triangle: usize| triangles[triangle].iter().map(|corner| corner[axis]).sum::<f64>();
        // By number where middles are equal, so that the tree is the same everywhere.
        of.select_nth_unstable_by(count / 2, |&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
        self.build(first, count / 2);
        self.nodes[node].second = self.nodes.len();
        self.build(first + count / 2, count - count / 2);
    }

    /// The nearest triangle, of equally near ones that of the smallest number; `None` where there are none.
    pub(super) fn nearest(&self, point: DVec3) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        let mut left: Vec<usize> = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(index) = left.pop() {
            let node = &self.nodes[index];
            let away = (node.low - point).max(point - node.high).max(DVec3::ZERO).length_squared();
            if best.is_some_and(|best| away > best.squared) {
                continue;
            }
            if node.second > 0 {
                left.extend([node.second, index + 1]);
                continue;
            }
            for &triangle in &self.order[node.first..node.first + node.count] {
                let found = closest_point(point, self.triangles[triangle]);
                let found = Nearest { triangle, point: found, squared: found.distance_squared(point) };
                let key = |nearest: &Nearest| (nearest.squared, nearest.triangle);
                if best.is_none_or(|best| key(&found) < key(&best)) {
                    best = Some(found);
                }
            }
        }
        best
    }
}

/// The point of a triangle nearest to another point (Ericson, Real-Time Collision Detection, 5.1.5).
pub(super) fn closest_point(point: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_a_search_through_all_finds() {
        let mut seed = 1u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut point = || DVec3::new(next(), next(), next());
        let triangles: Vec<_> = (0..500).map(|_| [point(), point(), point()].map(|p| p * 0.2)).collect();
        let triangles: Vec<_> = triangles.iter().map(|t| t.map(|p| p + point())).collect();
        let tree = Tree::new(&triangles, (0..triangles.len()).collect());
        for _ in 0..500 {
            let asked = point() * 3.0 - 1.0;
            let all = triangles.iter().map(|&triangle| closest_point(asked, triangle).distance_squared(asked));
            let found = tree.nearest(asked).unwrap();
            assert_eq!(found.squared, all.fold(f64::INFINITY, f64::min));
        }
        assert_eq!(Tree::new(&triangles, Vec::new()).nearest(DVec3::ZERO), None);
    }

    #[test]
    fn the_closest_point_is_not_beaten_by_any_other() {
        let triangle = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.5, 1.0, 0.3)];
        for i in 0..1000 {
            let t = f64::from(i);
            let asked = DVec3::new((t * 0.7).sin(), (t * 1.3).cos(), (t * 2.1).sin()) * 3.0;
            let found = closest_point(asked, triangle).distance(asked);
            for j in 0..=20 {
                for k in 0..=20 - j {
                    let (u, v) = (f64::from(j) / 20.0, f64::from(k) / 20.0);
                    let other = triangle[0] * (1.0 - u - v) + triangle[1] * u + triangle[2] * v;
                    assert!(found <= other.distance(asked) + 1e-12, "{asked}");
                }
            }
        }
    }
}
