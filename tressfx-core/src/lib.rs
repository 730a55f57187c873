//! Hair assets, strands, the backend contract and shader composition of TressFX for Rust.

#![forbid(unsafe_code)]

pub mod asset;
pub mod builtin;
pub mod mesh;
pub mod shape;
pub mod strands;
