// Walking along a strand.

/// Vertices that a walk loads at once, into registers. One at a time, each would be waited for: a load cannot be moved up
/// across the stores of the vertices before it.
const CHUNK: u32 = 8u;
