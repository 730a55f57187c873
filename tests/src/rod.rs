//! What thin rods are known to do: the outside references that solvers of motion are held against.
//!
//! Nothing here knows the kernels, their f64 functions or their discretisation. Most are ordinary differential equations
//! that are solved by shooting, or closed forms. Tests check each against another derivation.
//!
//! All is in SI units and per mass: forces are divided by the mass of a metre of hair, so that its weight is `g`, its
//! bending stiffness `EI / (density * area)` is `g * bending_length^3`, and no density is needed. The bending length is
//! `(EI / (density * area * g))^(1/3)`.

pub mod balance;
pub mod chain;
pub mod elastica;
pub mod experiment;
pub mod kirchhoff;
pub mod links;
pub mod ode;
pub mod pendulum;
pub mod strand;
pub mod threshold;

/// Acceleration by gravity that bending lengths refer to, m/s^2.
pub const G: f64 = 9.81;
