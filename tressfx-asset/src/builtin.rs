//! Built-in grooms: made from a seed, in metres, y up, the face towards +z.
//!
//! They need no files and no licence: the demo, the tests and the documentation's pictures use them. All but the fur and the animal grow
//! on the head of a bust, which [`Builtin::mesh`] and [`Builtin::capsules`] give in the same space.

mod animal;
mod body;
mod clumps;
mod growth;
mod ponytail;
mod roots;
mod style;

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use thiserror::Error;

use crate::mesh::Mesh;
use body::Body;
use ponytail::Tie;
use style::Look;
use tressfx_core::asset::{AssetFormat, HairAsset, MAX_VERTICES, MIN_VERTICES};
use tressfx_core::shape::{Capsule, Ellipsoid};

/// The most strands of a built-in groom.
pub const MAX_STRANDS: u32 = 4_000_000;

/// What a built-in groom looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A sleek bob to the chin, parted in the middle.
    Straight,
    /// Waves to the shoulders, parted at the side.
    Wavy,
    /// A round head of ringlets.
    Curly,
    /// Long hair over shoulders and back, with a parting; the face is free.
    Long,
    /// Short fur on a sphere.
    Fur,
    /// An animal with fur that flows from nose to tail: short on face and feet, long on chest and tail.
    Animal,
    /// A beard with moustache and brows.
    Beard,
    /// Hair that is drawn back into a tie, where its tips are held, and a tail that hangs from there.
    Ponytail,
}

impl Style {
    /// Every style.
    pub const ALL: [Self; 8] =
        [Self::Straight, Self::Wavy, Self::Curly, Self::Long, Self::Fur, Self::Animal, Self::Beard, Self::Ponytail];

    /// The name by which [`Builtin`] parses it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Wavy => "wavy",
            Self::Curly => "curly",
            Self::Long => "long",
            Self::Fur => "fur",
            Self::Animal => "animal",
            Self::Beard => "beard",
            Self::Ponytail => "ponytail",
        }
    }

    /// Strands, and vertices of each, where they are not given.
    fn default_counts(self) -> (u32, u32) {
        match self {
            Self::Straight => (12_000, 24),
            Self::Wavy => (12_000, 32),
            Self::Curly => (10_000, 64),
            Self::Long => (16_384, 32),
            Self::Fur => (40_000, 8),
            Self::Animal => (60_000, 6),
            Self::Beard => (9_000, 12),
            Self::Ponytail => (12_000, 32),
        }
    }
}

/// A built-in groom: a style and its counts. Written `NAME[:strands[:vertices]]`, like `long:16384:32`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// What it looks like.
    pub style: Style,
    /// Number of strands, 1 to [`MAX_STRANDS`].
    pub strands: u32,
    /// Vertices of each strand, 2 to 256.
    pub vertices: u32,
    /// Of everything random. The same seed gives the same groom.
    pub seed: u64,
}

/// Why a text names no built-in groom.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BuiltinError {
    /// There is no such style.
    #[error("no built-in groom {0:?}: there are straight, wavy, curly, long, fur, animal, beard and ponytail")]
    Name(String),
    /// A count is no number, or out of range.
    #[error("built-in groom {groom:?}: {field} {value:?} must be a number from {min} to {max}")]
    Count {
        /// The whole text.
        groom: String,
        /// "strands" or "vertices".
        field: &'static str,
        /// What was written.
        value: String,
        /// Smallest number allowed.
        min: u32,
        /// Largest number allowed.
        max: u32,
    },
    /// There is more behind the vertices.
    #[error("built-in groom {0:?}: nothing may follow NAME:strands:vertices")]
    Trailing(String),
}

impl From<Style> for Builtin {
    fn from(style: Style) -> Self {
        let (strands, vertices) = style.default_counts();
        Self { style, strands, vertices, seed: 0 }
    }
}

impl FromStr for Builtin {
    type Err = BuiltinError;

    fn from_str(text: &str) -> Result<Self, BuiltinError> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let style = Style::ALL.into_iter().find(|style| style.name() == name);
        let defaults = Self::from(style.ok_or_else(|| BuiltinError::Name(name.to_owned()))?);
        let mut count = |field, default, min, max| match parts.next() {
            None => Ok(default),
            Some(value) => value.parse().ok().filter(|count| (min..=max).contains(count)).ok_or_else(|| {
                BuiltinError::Count { groom: text.to_owned(), field, value: value.to_owned(), min, max }
            }),
        };
        let strands = count("strands", defaults.strands, 1, MAX_STRANDS)?;
        let vertices = count("vertices", defaults.vertices, MIN_VERTICES, MAX_VERTICES)?;
        match parts.next() {
            None => Ok(Self { strands, vertices, ..defaults }),
            Some(_) => Err(BuiltinError::Trailing(text.to_owned())),
        }
    }
}

impl fmt::Display for Builtin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.style.name(), self.strands, self.vertices)
    }
}

impl Builtin {
    /// Reads `NAME[:strands[:vertices]]`.
    ///
    /// # Errors
    /// Where there is no such name, or a count is no number or out of range.
    pub fn parse(text: &str) -> Result<Self, BuiltinError> {
        text.parse()
    }

    /// Grows the groom. Every vertex is outside of the body. A pure function of the fields.
    pub fn asset(&self) -> HairAsset {
        let (vertices, body) = (self.vertices.clamp(MIN_VERTICES, MAX_VERTICES), self.body());
        let (look, strands) = (Look::of(self.style), self.strands.clamp(1, MAX_STRANDS) as usize);
        let (roots, points, inverse_mass) = match tie(self.style, &body) {
            Some(tie) => {
                let tail = ponytail::grow(&look, &body, &tie, strands, vertices as usize, self.seed);
                (tail.roots, tail.points, Some(tail.inverse_mass))
            }
            None => {
                let roots = roots::roots(&look, &body, strands, self.seed);
                let points = clumps::grow(&look, &body, &roots, vertices as usize, self.seed);
                (roots, points, None)
            }
        };
        let uv = |root: &roots::Root| {
            let around = root.direction.x.atan2(root.direction.z) / std::f32::consts::TAU;
            [around + 0.5, 0.5 - 0.5 * root.direction.y]
        };
        HairAsset {
            strand_uvs: Some(roots.iter().map(uv).collect()),
            inverse_mass,
            ..HairAsset::new(self.to_string(), AssetFormat::Builtin, points, vec![vertices; roots.len()])
        }
    }

    /// What the roots are on: the skull, or the sphere of the fur. None for the animal, whose roots are on the parts of [`Builtin::mesh`].
    pub fn head(&self) -> Option<Ellipsoid> {
        self.body().head
    }

    /// What the strands collide with: the head, filled with capsules that leave the roots outside, the neck and the
    /// shoulders; or the parts of the animal, a little below their skin.
    pub fn capsules(&self) -> Vec<Capsule> {
        self.body().capsules()
    }

    /// The head, neck and shoulders, with the tie of a pony tail; or the animal; to be drawn under the hair.
    pub fn mesh(&self) -> Mesh {
        let body = self.body();
        let mut mesh = Mesh::default();
        body.head.iter().for_each(|head| mesh.append(&Mesh::ellipsoid(head, 48)));
        body.solids().for_each(|capsule| mesh.append(&Mesh::capsule(capsule, 48)));
        let ring = tie(self.style, &body).map_or_else(Vec::new, |tie| tie.ring());
        ring.iter().for_each(|capsule| mesh.append(&Mesh::capsule(capsule, 16)));
        mesh
    }

    fn body(&self) -> Body {
        match self.style {
            Style::Fur => Body::sphere(Vec3::ZERO, 0.1),
            Style::Animal => Body::animal(),
            _ => Body::bust(),
        }
    }
}

/// What the hair of a pony tail is drawn into.
fn tie(style: Style, body: &Body) -> Option<Tie> {
    body.head.as_ref().filter(|_| style == Style::Ponytail).map(Tie::on)
}
