//! What a rod is at rest.

use glam::{DQuat, DVec3};
use tressfx_core::strands::shortest_turn;

const MASS_CORRECTION: f64 = 5.0 / 6.0;

/// The rest pose of a rod and what its joints want.
#[derive(Clone, Debug, PartialEq)]
pub struct RodRest {
    /// Vertices from the root, as the root's frame sees them.
    pub positions: Vec<DVec3>,
    /// Lengths of the edges.
    pub lengths: Vec<f64>,
    /// Frames of the edges in the pose of the file, as the root's frame sees them; the third axis points along the edge.
    pub frames: Vec<DQuat>,
    /// Half of the rotation that the joint before each edge wants.
    pub joints: Vec<DQuat>,
    /// The length of hair that bends at the joint before each edge.
    pub spans: Vec<f64>,
    /// Masses of the vertices: half of that of the edges beside them.
    pub masses: Vec<f64>,
    /// How many edges, from the root, are held by it.
    pub held: usize,
    /// What the strand's bending stiffness is multiplied by.
    pub stiffening: f64,
}

impl RodRest {
    /// A strand of these vertices, the first `held + 1` of which are pinned. Its joints want the pose that it has.
    pub fn new(points: &[DVec3], held: usize) -> Self {
        let positions: Vec<_> = points.iter().map(|point| *point - points[0]).collect();
        let lengths: Vec<_> = points.windows(2).map(|edge| edge[1].distance(edge[0])).collect();
        let total: f64 = lengths.iter().sum();
        // Where there is no length, nothing moves.
        let held = if total > 0.0 { held.min(lengths.len()) } else { lengths.len() };
        let frames = transported(points, total * super::NO_EDGE);
        let parent = |edge: usize| if edge == 0 { DQuat::IDENTITY } else { frames[edge - 1] };
        let joints = (0..frames.len()).map(|edge| half(parent(edge).conjugate() * frames[edge])).collect();
        let span = |edge: usize| {
            let before = if edge > held { lengths[edge - 1] } else { 0.0 };
            ((before + lengths[edge]) / 2.0).max(total * 1e-6)
        };
        let at = |edge: Option<usize>| edge.and_then(|edge| lengths.get(edge)).map_or(0.0, |length| length / 2.0);
        Self {
            spans: (0..lengths.len()).map(span).collect(),
            masses: (0..points.len()).map(|vertex| at(vertex.checked_sub(1)) + at(Some(vertex))).collect(),
            positions,
            lengths,
            frames,
            joints,
            held,
            stiffening: 1.0,
        }
    }

    /// The mass that hangs on a held tip: that of the tip were all edges as long as the longest. With the tip's own, a spring behind a last
    /// edge that is much shorter than others is soft beside what pulls at it, and the force that it comes to swings to and fro, more and more.
    #[must_use]
    pub fn tip_mass(&self) -> f64 {
        self.lengths.iter().copied().fold(0.0, f64::max) / 2.0
    }

    /// The share of the difference between masses at vertices and masses along edges that is made good. With all of it (1)
    /// short waves run too fast, with none too slow; the formula in time makes them slower too. Of the shares that were tried this
    /// one has the smallest error in the first three modes of a hanging strand, for 8 to 64 vertices at 1/120 s. A single edge is
    /// a rigid rod, exactly.
    pub fn mass_correction(&self) -> f64 {
        if self.lengths.len() == 1 { 1.0 } else { MASS_CORRECTION }
    }
}

/// Frames along a line of points without twist: each is turned from the one before it the shortest way.
fn transported(points: &[DVec3], shortest: f64) -> Vec<DQuat> {
    let mut frame = DQuat::IDENTITY;
    let mut next = |edge: &[DVec3]| {
        let direction = edge[1] - edge[0];
        if direction.length() > shortest {
            frame = (shortest_turn(frame * DVec3::Z, direction.normalize()) * frame).normalize();
        }
        frame
    };
    points.windows(2).map(&mut next).collect()
}

/// The rotation that is this one if done twice.
pub(super) fn half(rotation: DQuat) -> DQuat {
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    (rotation + DQuat::IDENTITY).normalize()
}
