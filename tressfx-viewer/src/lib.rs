//! The part of the program `tressfx` that others can use: an opaque scene behind the hair, and studio lights.

#![forbid(unsafe_code)]

pub mod light_depth;
pub mod scene;
