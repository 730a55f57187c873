//! Statics of a Kirchhoff rod in three dimensions: inextensible, with bending and twist, under its own weight.
//!
//! With the frame `R(s)` (`R e3` is the tangent `t`), the Darboux vector `u` in that frame, the inner force `n` and the
//! inner moment `m`, both from the part beyond `s` on the part before it (Antman, Nonlinear Problems of Elasticity,
//! chapter 8):
//!
//! * `x' = t`, `R' = R [u]x`,
//! * `n' = -g`, `m' = -t x n`,
//! * `u = natural + diag(1 / B, 1 / B, 1 / (r B)) R^T m`.
//!
//! A free end has neither force nor moment, so that a clamped rod is shot from its free end with three unknowns, the frame
//! there; its frame at the root has to be that of the clamp.

use glam::{DQuat, DVec3};

use super::ode::{integrate, jacobian, linear, newton};

/// A rod of constant natural curvature.
#[derive(Clone, Copy, Debug)]
pub struct Kirchhoff {
    /// m.
    pub length: f64,
    /// Bending stiffness over the mass of a metre, m^4/s^2.
    pub bending: f64,
    /// Twist stiffness over bending stiffness.
    pub twist_ratio: f64,
    /// The Darboux vector at rest, on the axes of the frame, 1/m.
    pub natural: DVec3,
    /// m/s^2.
    pub gravity: DVec3,
    /// Steps of the integrator.
    pub steps: usize,
}

/// An end of a rod.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// Its frame; the third axis is the tangent.
    pub frame: DQuat,
    /// Where it is.
    pub place: DVec3,
    /// The inner moment.
    pub moment: DVec3,
    /// The inner force.
    pub force: DVec3,
}

impl End {
    /// A free end at the origin.
    pub fn free(frame: DQuat) -> Self {
        Self { frame, place: DVec3::ZERO, moment: DVec3::ZERO, force: DVec3::ZERO }
    }

    fn to_array(self) -> [f64; 13] {
        let (q, x, m, n) = (self.frame, self.place, self.moment, self.force);
        [q.x, q.y, q.z, q.w, x.x, x.y, x.z, m.x, m.y, m.z, n.x, n.y, n.z]
    }

    fn from_array(y: &[f64; 13]) -> Self {
        Self {
            frame: DQuat::from_xyzw(y[0], y[1], y[2], y[3]),
            place: DVec3::new(y[4], y[5], y[6]),
            moment: DVec3::new(y[7], y[8], y[9]),
            force: DVec3::new(y[10], y[11], y[12]),
        }
    }
}

impl Kirchhoff {
    /// A straight rod without twist at rest.
    pub fn straight(length: f64, bending: f64, gravity: DVec3) -> Self {
        Self { length, bending, twist_ratio: 0.77, natural: DVec3::ZERO, gravity, steps: 2000 }
    }

    /// The other end, from one at `from` to one at `to` along the rod.
    pub fn shoot(&self, end: End, [from, to]: [f64; 2]) -> End {
        let slope = |_: f64, y: &[f64; 13]| {
            let end = End::from_array(y);
            let frame = end.frame.normalize();
            let tangent = frame * DVec3::Z;
            let moment = frame.conjugate() * end.moment;
            let darboux = self.natural + moment / self.bending / DVec3::new(1.0, 1.0, self.twist_ratio);
            let turning = end.frame * DQuat::from_xyzw(darboux.x, darboux.y, darboux.z, 0.0) * 0.5;
            let (moment, force) = (end.force.cross(tangent), -self.gravity);
            End { frame: turning, place: tangent, moment, force }.to_array()
        };
        End::from_array(&integrate(slope, end.to_array(), [from, to], self.steps))
    }

    /// The root of a rod whose free tip has this frame.
    pub fn root_of(&self, tip: DQuat) -> End {
        self.shoot(End::free(tip), [self.length, 0.0])
    }

    /// The frame of the tip where nothing bends the rod.
    pub fn unloaded_tip(&self, root: DQuat) -> DQuat {
        root * DQuat::from_scaled_axis(self.natural * self.length)
    }

    /// The equilibrium of the rod, clamped at a root with this frame, that it reaches when its weight is brought on in
    /// `loads` equal parts: the frame of its tip, and the tip's place from the root. `None` where the path turns back.
    pub fn loaded(&self, root: DQuat, loads: usize) -> Option<(DQuat, DVec3)> {
        let mut tip = self.unloaded_tip(root);
        for load in 1..=loads {
            let part = Self { gravity: self.gravity * load as f64 / loads as f64, ..*self };
            let turned = |by: &[f64; 3]| DQuat::from_scaled_axis(DVec3::from(*by)) * tip;
            let miss = |by: &[f64; 3]| rotation_vector(root.conjugate() * part.root_of(turned(by)).frame).to_array();
            tip = turned(&newton(miss, [0.0; 3], 1e-9)?);
        }
        Some((tip, -self.root_of(tip).place))
    }

    /// For a rod that lies in the plane of x and z, clamped at a root with this frame, under gravity in that plane: the
    /// determinant that is 0 where the rod can leave the plane without a force, times a positive number. `loads` as in
    /// [`Kirchhoff::loaded`]; `None` where the planar rod is not found.
    ///
    /// The frame of the tip is turned a little out of the plane, about x and about z; the frame at the root then turns out
    /// of it too. Where a turn of the tip leaves the clamp as it is, there is an equilibrium beside the planar one.
    pub fn planar_stability(&self, root: DQuat, loads: usize) -> Option<f64> {
        let mut angle = 0.0;
        for load in 1..=loads {
            let part = Self { gravity: self.gravity * load as f64 / loads as f64, ..*self };
            let miss = |angle: &[f64; 1]| [part.miss(root, DVec3::new(0.0, angle[0], 0.0)).y];
            [angle] = newton(miss, [angle], 1e-9)?;
        }
        let out = |by: &[f64; 2]| {
            let turned = DQuat::from_scaled_axis(DVec3::new(by[0], 0.0, by[1])) * DQuat::from_rotation_y(angle);
            let miss = self.miss(root, rotation_vector(turned));
            [miss.x, miss.z]
        };
        Some(linear(jacobian(&out, &[0.0; 2], 1e-5), [0.0; 2]).1)
    }

    /// What the frame at the root misses the clamp by, where the unloaded tip is turned.
    fn miss(&self, root: DQuat, by: DVec3) -> DVec3 {
        let tip = DQuat::from_scaled_axis(by) * self.unloaded_tip(root);
        rotation_vector(root.conjugate() * self.root_of(tip).frame)
    }

    /// The determinant that is 0 where a rod without weight, bent to a closed ring and twisted by `turn` radians from end to
    /// end, has an equilibrium beside the ring; both ends are held.
    ///
    /// In the ring the moment is `B k b + C u t` with the curvature `k`, the twist `u` a metre and the axis `b` of the ring; its
    /// derivative asks for the force `C u k b`. Six unknowns, moment and force at the root, are to close the ring. A ring
    /// may lie in any plane through the tangent at its root, so that one turn about it costs nothing: the moment that makes
    /// it and the angle that answers to that moment are left out.
    pub fn ring_stability(&self, turn: f64) -> f64 {
        let (curvature, twist) = (std::f64::consts::TAU / self.length, turn / self.length);
        let stiffness = self.twist_ratio * self.bending;
        // The ring lies in the plane of x and z and begins at the origin along z; its axis is y.
        let moment = DVec3::new(0.0, self.bending * curvature, stiffness * twist);
        let force = DVec3::Y * (stiffness * twist * curvature);
        let unit = self.bending / self.length;
        let close = |by: &[f64; 5]| {
            let start = End {
                frame: DQuat::IDENTITY,
                place: DVec3::ZERO,
                moment: moment + DVec3::new(0.0, by[0], by[1]) * unit,
                force: force + DVec3::new(by[2], by[3], by[4]) * unit / self.length,
            };
            let end = self.shoot(start, [0.0, self.length]);
            let turned = rotation_vector(end.frame * DQuat::from_rotation_z(-turn));
            let place = end.place / self.length;
            [turned.y, turned.z, place.x, place.y, place.z]
        };
        linear(jacobian(&close, &[0.0; 5], 1e-5), [0.0; 5]).1
    }
}

/// Axis times angle, exact for the smallest angles too.
fn rotation_vector(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    let sin = rotation.xyz().length();
    if sin == 0.0 { DVec3::ZERO } else { rotation.xyz() * (2.0 * sin.atan2(rotation.w) / sin) }
}
