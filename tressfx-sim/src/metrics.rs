//! How good a pose is.

use glam::Vec4;
use serde::Serialize;
use tressfx_core::strands::Strands;

/// An edge counts if it is longer than this share of its strand's length: the direction of a shorter one is rounding noise.
pub const SHORTEST_EDGE: f32 = 1e-6;

/// Errors of edge lengths, `|length / rest length - 1|`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EdgeError {
    /// The largest.
    pub max: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// The mean.
    pub mean: f64,
    /// Edges that count.
    pub edges: u64,
}

impl EdgeError {
    /// The error over the edges of both.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let edges = self.edges + other.edges;
        let mean =
            |own: f64, others: f64| (own * self.edges as f64 + others * other.edges as f64) / edges.max(1) as f64;
        Self {
            max: self.max.max(other.max),
            rms: mean(self.rms * self.rms, other.rms * other.rms).sqrt(),
            mean: mean(self.mean, other.mean),
            edges,
        }
    }
}

/// Edge lengths of a pose of the guides against those of the rest pose, over all edges longer than [`SHORTEST_EDGE`] of their
/// strand.
///
/// `positions` are strand-major, at least those of the guides (follow strands behind them are not looked at); `w` is not
/// looked at either.
///
/// # Panics
/// Where there are fewer positions than the guides have vertices.
pub fn edge_error(strands: &Strands, positions: &[Vec4]) -> EdgeError {
    let vertices = strands.vertices as usize;
    assert!(positions.len() >= strands.rest.len(), "{} of {} positions", positions.len(), strands.rest.len());
    let mut error = EdgeError::default();
    for (strand, lengths) in positions.chunks(vertices).zip(strands.rest_lengths.chunks(vertices)) {
        let shortest = SHORTEST_EDGE * lengths.iter().sum::<f32>();
        for (edge, &rest) in strand.windows(2).zip(lengths).filter(|(_, rest)| **rest > shortest) {
            let length = edge[1].truncate().as_dvec3().distance(edge[0].truncate().as_dvec3());
            let deviation = (length / f64::from(rest) - 1.0).abs();
            error.max = error.max.max(deviation);
            error.rms += deviation * deviation;
            error.mean += deviation;
            error.edges += 1;
        }
    }
    let edges = error.edges.max(1) as f64;
    EdgeError { rms: (error.rms / edges).sqrt(), mean: error.mean / edges, ..error }
}

/// How many positions are not finite.
pub fn non_finite(positions: &[Vec4]) -> usize {
    positions.iter().filter(|position| !position.is_finite()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_two_sections_is_that_of_all_their_edges() {
        let few = EdgeError { max: 0.4, rms: 0.2, mean: 0.1, edges: 1 };
        let many = EdgeError { max: 0.3, rms: 0.0, mean: 0.0, edges: 3 };
        let both = few.with(many);
        assert_eq!(both, EdgeError { max: 0.4, rms: 0.1, mean: 0.025, edges: 4 });
        assert_eq!(EdgeError::default().with(many), many);
    }
}
