//! Places in a pixel where light passes hair for itself.

use tressfx_core::error::{Error, Label, Result};
use tressfx_core::shader::Specialization;

/// How many places a pixel may have.
///
/// With one, what a strand covers of a pixel hides that share of all that is behind it. With more, strands that run behind each other are
/// seen beside each other.
pub const PLACES: [u32; 4] = [1, 4, 16, 64];

/// Whether there can be so many.
pub(crate) fn check_places(label: Label, places: u32) -> Result<()> {
    if PLACES.contains(&places) {
        return Ok(());
    }
    Err(Error::rule(label, format!("{places} places in a pixel, there can be 1, 4, 16 or 64")))
}

/// A kernel for so many places of a pixel, shared by so many lanes.
pub(crate) fn at_places(specialization: Specialization, places: u32, lanes: u32) -> Specialization {
    let specialization = specialization.feature("places", places > 1);
    if places == 1 {
        return specialization;
    }
    specialization.constant("PLACES", places).constant("LANES_OF_A_PIXEL", lanes)
}
