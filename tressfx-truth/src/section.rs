//! Strands as they are handed in.

use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::view::Pose;

use crate::error::TruthError;

/// The strands of a section: what the buffers on the GPU hold, in their order, see [`StrandShape::index`].
#[derive(Clone, Copy, Debug)]
pub struct Section<'a> {
    /// The counts.
    pub shape: StrandShape,
    /// From the positions to the world.
    pub pose: Pose,
    /// Positions in `xyz`, a vertex of every strand. Segments at a vertex that is not finite, or 1e12 and more from 0 along an
    /// axis, are left out.
    pub positions: &'a [[f32; 4]],
    /// Colour (linear RGB) and opacity (clamped to 0..1), a vertex of every strand.
    pub colors: &'a [[f32; 4]],
    /// Share of the full width, a vertex of every guide: `vertex * guides + guide`.
    pub thickness: &'a [f32],
    /// Radius of a fibre of full width, in the unit of the positions.
    pub fibre_radius: f32,
    /// Share of the radius that is left where the thickness is 0.
    pub tip_width: f32,
}

impl Section<'_> {
    /// Checks lengths and numbers; `section` is its place among the others, for messages.
    pub(crate) fn check(&self, section: usize) -> Result<(), TruthError> {
        let length = |what, found: usize, expected: u64| match found as u64 == expected {
            true => Ok(()),
            false => Err(TruthError::Length { section, what, found, expected: expected as usize }),
        };
        let StrandShape { guides, follows, vertices } = self.shape;
        let of_guides = u64::from(guides) * u64::from(vertices);
        let of_all = of_guides.saturating_mul(1 + u64::from(follows));
        length("positions", self.positions.len(), of_all)?;
        length("colours", self.colors.len(), of_all)?;
        length("shares of the width", self.thickness.len(), of_guides)?;
        self.pose.validate().map_err(|error| TruthError::Pose { section, error: error.to_string() })?;
        let number =
            |what, bad: Option<usize>| bad.map_or(Ok(()), |index| Err(TruthError::Number { section, what, index }));
        let is_size = |x: &f32| x.is_finite() && *x >= 0.0;
        number("colour", self.colors.iter().position(|color| !color.iter().all(|x| x.is_finite())))?;
        number("share of the width", self.thickness.iter().position(|share| !is_size(share)))?;
        number("radius or tip width", [self.fibre_radius, self.tip_width].iter().position(|size| !is_size(size)))
    }

    /// The radius of a fibre at a vertex of a strand.
    pub(crate) fn radius(&self, strand: u32, vertex: u32) -> f64 {
        let share = f64::from(self.thickness[(vertex * self.shape.guides + strand % self.shape.guides) as usize]);
        let tip = f64::from(self.tip_width);
        // A share above 1 with a tip width above 1 would go below 0.
        (f64::from(self.fibre_radius) * (tip + (1.0 - tip) * share)).max(0.0)
    }
}
