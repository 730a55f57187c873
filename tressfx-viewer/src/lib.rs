//! What the program `tressfx` shows beside hair: an opaque scene in the light of a studio.

#![forbid(unsafe_code)]

pub mod scene;
