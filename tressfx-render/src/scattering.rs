//! Light in a fibre of hair: a dielectric cylinder with tilted scales and pigment (Marschner et al. 2003).
//!
//! A fibre takes light from the direction `i` and gives it towards the eye `r` by four lobes `p`: mirrored (R), through it (TT), mirrored once within
//! (TRT), and all that is mirrored more often. Directions point away from the fibre; `theta` is how far one leans from the plane across the fibre towards
//! its tip, `phi` the angle between both around it, `theta_d` half of `theta_r - theta_i`. The radiance towards the eye, averaged over the width of the
//! fibre, is the integral over all directions of
//!
//! ```text
//! L(i) cos(theta_i) / (g(theta_i) g(theta_r))  (e(theta_i) e(theta_r) / 2 PI + sum over p of  M_p(theta_i, theta_r) N_p(phi, theta_d))
//! ```
//!
//! `M` is the lobe along the fibre that d'Eon et al. 2011 have derived, `N` the mean over the width of Fresnel's factors and absorption around it, with
//! the logistic detector and the fourth lobe of Chiang et al. 2015. Scales that tilt turn light and eye by half of the shift that Marschner et al.
//! give a lobe (`TURNS`), so that they may change places. `g` is such that a white fibre in white light from everywhere is white from any direction; where
//! scales tilt, it may be less than white, since they move light between directions of which one has more others around it. What is lacking then
//! is the term of `e`: light that is caught between scales leaves evenly, with the pigment that it met in TT. As for rough surfaces (Kulla and Conty 2017), a product
//! of what light and eye lack each makes up for all of it: no energy is lost or made, and light and eye may still change places.

mod azimuthal;
mod dielectric;
mod longitudinal;
mod pigment;
mod table;
#[cfg(test)]
mod traced;

pub(crate) use longitudinal::{lobe, variances};
pub(crate) use pigment::{
    MAX_ABSORPTION, absorption_of_color, absorption_of_melanin, color_of_absorption, pigmentation,
};
pub use table::FibreTable;
pub(crate) use table::{ENTRIES, Shape, TURNS};
