//! The unit of a groom, guessed from the length of its strands.

/// Metres that a unit stands for, from the median strand length in that unit.
///
/// Hair is between about 1 cm and 2 m long: a median below 2 is read as metres, below 200 as centimetres, anything longer
/// as millimetres.
pub fn metres_per_unit(median_length: f64) -> f32 {
    match median_length {
        length if length < 2.0 => 1.0,
        length if length < 200.0 => 0.01,
        _ => 0.001,
    }
}
