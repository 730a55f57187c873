//! Contacts of a rod with capsules, and friction, inside the solve.
//!
//! A contact is a spring across the surface that only pushes, and friction one along it that yields at Coulomb's limit
//! (the elastic-plastic springs of Cundall, Strack 1979). Both are implicit, so that strands rest and stick without drift.
//!
//! An edge touches a capsule with its end, and between its ends where it comes nearer there. What moves fast is held against
//! the way that it took in the sub-step, from the side that it came from.

use glam::{DMat3, DQuat, DVec3};
use tressfx_core::shape::Capsule;

use super::{Motion, Rod, outer};
use crate::reference::field::PlacedField;

/// The stiffness of a contact times the square of the sub-step, over the mass of the vertex.
const CONTACT: f64 = 100.0;
/// The stiffness of friction until it yields, as a share of that. With more, what the springs along a strand do to each other
/// needs many more rounds.
const GRIP: f64 = 0.01;
/// There is another round where an edge is deeper than this share of the radius,
const DEEP: f64 = 0.1;
/// or, in a field, deeper than so many cells.
const DEEP_CELLS: f64 = 0.1;
/// From there on the push grows so much faster with the depth. A taut strand pulls as hard as a push at a depth of some millimetres; with a push that is as stiff near the
/// surface strands at rest would tremble.
const STEEPER: f64 = 10.0;
/// An edge touches between its ends where it is nearer to the axis there than at its ends; in full from this share of the
/// radius on.
const NEARER: f64 = 0.1;
/// The way of an edge is followed in so many steps, each as long as nothing can be touched,
const ADVANCES: u32 = 12;
/// until it is nearer to the surface than this share of the radius.
const REACHED: f64 = 0.02;
/// Where the normal has turned by more than what this cosine says since the edge touched, it has got to the other side.
const SAME_SIDE: f64 = 0.3;

/// A capsule as a rod meets it in a sub-step. All from the root, on the axes of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Centres of its ends, at the end of the sub-step.
    pub ends: [DVec3; 2],
    /// Radii there.
    pub radii: [f64; 2],
    /// Its points were turned during the sub-step,
    pub rotation: DQuat,
    /// then moved.
    pub translation: DVec3,
}

impl Obstacle {
    /// A capsule that stays where it is.
    pub fn still(capsule: &Capsule) -> Self {
        Self {
            ends: [capsule.a.as_dvec3(), capsule.b.as_dvec3()],
            radii: [capsule.radius_a.into(), capsule.radius_b.into()],
            rotation: DQuat::IDENTITY,
            translation: DVec3::ZERO,
        }
    }

    /// Where a point that moves with the capsule is at the end of the sub-step.
    fn carried(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    fn radius(&self, t: f64) -> f64 {
        self.radii[0] + t * (self.radii[1] - self.radii[0])
    }

    /// The nearest points of an edge from `u` to `v` and of the axis (Ericson 2005, 5.1.9).
    fn nearest(&self, u: DVec3, v: DVec3) -> Near {
        let (edge, axis, apart) = (v - u, self.ends[1] - self.ends[0], u - self.ends[0]);
        let (ee, aa, ea) = (edge.length_squared(), axis.length_squared(), edge.dot(axis));
        let (e, a) = (edge.dot(apart), axis.dot(apart));
        let share = |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
        let mut s = share(ea * a - e * aa, ee * aa - ea * ea);
        let t = share(ea * s + a, aa);
        s = share(ea * t - e, ee);
        self.near(u, v, s, t)
    }

    /// The point at `s` of an edge and the point of the axis that is nearest to it.
    fn nearest_to(&self, u: DVec3, v: DVec3, s: f64) -> Near {
        let axis = self.ends[1] - self.ends[0];
        let squared = axis.length_squared();
        let along = (u.lerp(v, s) - self.ends[0]).dot(axis);
        let t = if squared > 0.0 { (along / squared).clamp(0.0, 1.0) } else { 0.0 };
        self.near(u, v, s, t)
    }

    fn near(&self, u: DVec3, v: DVec3, s: f64, t: f64) -> Near {
        let from_axis = u.lerp(v, s) - self.ends[0].lerp(self.ends[1], t);
        let distance = from_axis.length();
        let normal = if distance > 0.0 { from_axis / distance } else { DVec3::ZERO };
        Near { s, t, normal, gap: distance - self.radius(t) }
    }
}

/// A signed distance field as a rod meets it in a sub-step. All from the root, on the axes of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldObstacle<'a> {
    /// The field, at the end of the sub-step.
    pub placed: PlacedField<'a>,
    /// Its points were turned during the sub-step,
    pub rotation: DQuat,
    /// then moved.
    pub translation: DVec3,
}

/// Where an edge is nearest to the axis of a capsule.
#[derive(Clone, Copy, Debug)]
struct Near {
    /// The point's share of the edge.
    s: f64,
    /// The share of the axis.
    t: f64,
    /// From the axis to the edge.
    normal: DVec3,
    /// The distance from the surface; negative inside.
    gap: f64,
}

/// What the rod remembers of a contact of an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// The capsule's index and 1; 0 where nothing was touched.
    pub obstacle: usize,
    /// The normal, which says on which side the edge is.
    pub normal: DVec3,
    /// How far the spring of friction is stretched.
    pub stretch: DVec3,
    /// Whether the edge did not touch it one sub-step before.
    pub is_new: bool,
    /// Whether it is so deep inside that another round is called for.
    pub is_deep: bool,
}

/// What contacts do to an edge: half of a quadratic function of the displacement of its points, by the displacement of the vertex
/// before it and by the rotation of its arm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contacts {
    pub(super) place: DMat3,
    pub(super) mixed: DMat3,
    pub(super) turn: DMat3,
    pub(super) force: DVec3,
    pub(super) torque: DVec3,
    /// The force across the surface alone, which tension knows of.
    pub(super) pull: DVec3,
    /// Whether there are any.
    pub(super) touches: bool,
}

impl Contacts {
    const NONE: Self = Self {
        place: DMat3::ZERO,
        mixed: DMat3::ZERO,
        turn: DMat3::ZERO,
        force: DVec3::ZERO,
        torque: DVec3::ZERO,
        pull: DVec3::ZERO,
        touches: false,
    };

    fn add(&mut self, s: f64, stiffness: DMat3, force: DVec3) {
        self.place += stiffness;
        self.mixed += stiffness * s;
        self.turn += stiffness * (s * s);
        self.force += force;
        self.torque += force * s;
    }
}

/// The way of an edge past a capsule during a sub-step, as the capsule sees it.
struct Way {
    from: [DVec3; 2],
    to: [DVec3; 2],
    /// The furthest that a point of it moves.
    longest: f64,
}

impl Way {
    fn at(&self, time: f64) -> [DVec3; 2] {
        [0, 1].map(|end| self.from[end].lerp(self.to[end], time))
    }

    /// Where the edge first comes to the surface on its way (conservative advancement).
    fn first_touch(&self, obstacle: &Obstacle) -> Option<Near> {
        let reached = REACHED * obstacle.radii[0].min(obstacle.radii[1]);
        let mut time = 0.0;
        let mut near = obstacle.nearest(self.from[0], self.from[1]);
        for _ in 0..ADVANCES {
            if near.gap <= reached {
                break;
            }
            time += near.gap / self.longest;
            if time >= 1.0 {
                return None;
            }
            let [u, v] = self.at(time);
            near = obstacle.nearest(u, v);
        }
        Some(near)
    }
}

/// A point of an edge at a capsule.
struct Point {
    near: Near,
    /// How much it counts, 0 to 1.
    weight: f64,
}

/// The points of an edge that touch a capsule, or come near it.
fn points(obstacle: &Obstacle, way: &Way, last: &Touch) -> Vec<Point> {
    let [u, v] = way.to;
    let near = obstacle.nearest(u, v);
    // Nothing of the way was nearer than this.
    if near.gap > way.longest {
        return Vec::new();
    }
    let start = obstacle.nearest(way.from[0], way.from[1]);
    let first = if start.gap > 0.0 { way.first_touch(obstacle) } else { Some(start) };
    let Some(first) = first else { return Vec::new() };
    let side = if last.normal != DVec3::ZERO && start.gap <= 0.0 { last.normal } else { first.normal };
    if near.normal.dot(side) < SAME_SIDE {
        // It has got to the other side of the axis: it is held at the side that it came from.
        let center = obstacle.ends[0].lerp(obstacle.ends[1], first.t);
        let gap = (u.lerp(v, first.s) - center).dot(side) - obstacle.radius(first.t);
        return vec![Point { near: Near { normal: side, gap, ..first }, weight: 1.0 }];
    }
    let [before, end] = [0.0, 1.0].map(|s| obstacle.nearest_to(u, v, s));
    let nearer = (before.gap.min(end.gap) - near.gap) / (NEARER * obstacle.radius(near.t));
    let mut points = vec![Point { near, weight: nearer.clamp(0.0, 1.0) }];
    if end.normal.dot(side) >= SAME_SIDE {
        points.push(Point { near: end, weight: 1.0 });
    }
    points
}

/// A contact of an edge with a capsule.
struct Contact {
    obstacle: usize,
    point: Point,
    /// How far the spring of friction is stretched, if it does not yield.
    stretch: DVec3,
    /// Beyond this the edge is deep.
    deep: f64,
}

impl Contact {
    /// The push over the stiffness that it has near the surface, and how much more it grows with the depth than there.
    fn push(&self) -> (f64, f64) {
        let depth = -self.point.near.gap;
        if depth > self.deep { (self.deep + STEEPER * (depth - self.deep), STEEPER) } else { (depth, 1.0) }
    }

    /// Friction yields where it is stretched by more than this.
    fn most_stretch(&self, friction: f64) -> f64 {
        friction * self.push().0 / GRIP
    }
}

impl Motion<'_> {
    fn way(&self, rod: &Rod, obstacle: &Obstacle, edge: usize) -> Way {
        let from = [edge, edge + 1].map(|vertex| obstacle.carried(self.before[vertex]));
        let to = [rod.positions[edge], rod.positions[edge + 1]];
        let longest = from[0].distance(to[0]).max(from[1].distance(to[1]));
        Way { from, to, longest }
    }

    fn touches(&self, rod: &Rod, edge: usize) -> Vec<Contact> {
        let mut contacts = Vec::new();
        for (index, obstacle) in self.step.obstacles.iter().enumerate() {
            let way = self.way(rod, obstacle, edge);
            let last = Some(rod.touches[edge]).filter(|last| last.obstacle == index + 1).unwrap_or_default();
            for point in points(obstacle, &way, &last).into_iter().filter(|point| point.near.gap < 0.0) {
                let Near { s, normal, .. } = point.near;
                let moved = way.to[0].lerp(way.to[1], s) - way.from[0].lerp(way.from[1], s);
                let stretch = (last.stretch + moved).reject_from_normalized(normal);
                let deep = DEEP * obstacle.radius(point.near.t);
                contacts.push(Contact { obstacle: index, point, stretch, deep });
            }
        }
        for (index, field) in self.step.fields.iter().enumerate() {
            contacts.extend(self.field_touch(rod, edge, self.step.obstacles.len() + index, field));
        }
        contacts
    }

    /// The contact of the end of an edge with a field.
    fn field_touch(&self, rod: &Rod, edge: usize, index: usize, field: &FieldObstacle) -> Option<Contact> {
        let moved = rod.positions[edge + 1] - (field.rotation * self.before[edge + 1] + field.translation);
        let last = Some(rod.touches[edge]).filter(|last| last.obstacle == index + 1).unwrap_or_default();
        let (gap, normal) = field.placed.met_by(rod.positions[edge + 1], moved);
        let stretched = last.stretch + moved;
        let stretch = stretched - stretched.dot(normal) * normal;
        let point = Point { near: Near { s: 1.0, t: 0.0, normal, gap }, weight: 1.0 };
        let deep = DEEP_CELLS * field.placed.field.grid.cell;
        (gap < 0.0).then_some(Contact { obstacle: index, point, stretch, deep })
    }

    /// What contacts do to an edge.
    pub(super) fn contacts(&self, rod: &Rod, edge: usize) -> Contacts {
        let mut contacts = Contacts::NONE;
        for contact in self.touches(rod, edge) {
            let Near { s, normal, .. } = contact.point.near;
            let (push, grows) = contact.push();
            let stiffness = contact.point.weight * CONTACT * self.rest.masses[edge + 1];
            let (across, most) = (outer(normal, normal), contact.most_stretch(self.step.friction));
            let (stretch, length) = (contact.stretch, contact.stretch.length());
            let mut grip = GRIP * (DMat3::IDENTITY - across);
            if length > most {
                // It yields: only the direction of the force changes.
                grip = (grip - GRIP * outer(stretch, stretch) / (length * length)) * (most / length);
            }
            let force = push * normal - GRIP * stretch.clamp_length_max(most);
            contacts.add(s, stiffness * (grows * across + grip), stiffness * force);
            contacts.pull += stiffness * push * normal;
            contacts.touches = true;
        }
        contacts
    }

    /// What the rod remembers of the contacts of an edge: the deepest.
    pub(super) fn touch(&self, rod: &Rod, edge: usize) -> Touch {
        let contacts = self.touches(rod, edge);
        let gap = |contact: &&Contact| contact.point.near.gap;
        let Some(contact) = contacts.iter().min_by(|one, other| gap(one).total_cmp(&gap(other))) else {
            return Touch::default();
        };
        let obstacle = contact.obstacle + 1;
        let near = contact.point.near;
        Touch {
            obstacle,
            normal: near.normal,
            stretch: contact.stretch.clamp_length_max(contact.most_stretch(self.step.friction)),
            is_new: rod.touches[edge].obstacle != obstacle,
            is_deep: near.gap < -contact.deep,
        }
    }
}
