//! Hair assets, strands, the backend contract and shader composition of TressFX for Rust.

#![forbid(unsafe_code)]

pub mod asset;
pub mod strands;
