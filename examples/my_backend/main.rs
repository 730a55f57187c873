//! A backend from outside.
fn main() {}
