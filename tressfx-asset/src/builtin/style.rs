//! The looks of the styles, in numbers. All lengths in metres.

use super::Style;

/// Where roots are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Region {
    /// Behind the hairline: forehead, temples, nape.
    Scalp,
    /// Everywhere.
    Everywhere,
    /// Beard, moustache and brows.
    Face,
}

/// How a style grows, falls and clumps.
pub(super) struct Look {
    pub(super) region: Region,
    /// x of the parting, from which hair is combed to both sides.
    pub(super) parting: f32,
    /// Share of the surface normal in the first direction; the rest is combed along the surface.
    pub(super) lift: f32,
    /// How fast a strand turns towards the ground: per metre.
    pub(super) gravity: f32,
    /// Shortest length of a strand.
    pub(super) length: f32,
    /// The height at which strands that hang end, if they do: the longer ones grow to it.
    pub(super) hem: Option<f32>,
    /// Random part of the length, as a fraction.
    pub(super) length_spread: f32,
    /// Random part of the direction.
    pub(super) direction_spread: f32,
    /// How much higher the topmost hair lies than the lowest, which it covers.
    pub(super) volume: f32,
    /// Roots that share a clump.
    pub(super) clump_size: usize,
    /// More clumps than this would cost time and not be told apart.
    pub(super) most_clumps: usize,
    /// How far a strand is drawn to its clump at the tip, 0 to 1.
    pub(super) clumping: f32,
    /// Share of the strand, from the root, over which it is drawn there.
    pub(super) clump_onset: f32,
    /// Width that a clump keeps at its tip, as a fraction of its width at the roots.
    pub(super) clump_width: f32,
    pub(super) wave: Wave,
}

/// Waves or ringlets around a strand.
pub(super) struct Wave {
    /// Distance from the strand's middle line.
    pub(super) radius: f32,
    /// Length of the middle line for one turn.
    pub(super) pitch: f32,
    /// 0 swings in a plane, 1 winds in a circle.
    pub(super) roundness: f32,
    /// Distance from the root at which it has its full radius.
    pub(super) onset: f32,
    /// How far the strands of a clump are from winding as one, 0 to 1.
    pub(super) looseness: f32,
}

impl Look {
    pub(super) fn of(style: Style) -> Self {
        match style {
            Style::Straight => Self { length: 0.12, hem: Some(-0.15), volume: 0.014, ..Self::long() },
            Style::Wavy => Self {
                parting: 0.022,
                length: 0.16,
                hem: Some(-0.24),
                volume: 0.022,
                wave: Wave { radius: 0.009, pitch: 0.075, roundness: 0.35, onset: 0.16, looseness: 0.7 },
                ..Self::long()
            },
            Style::Curly => Self::curly(),
            Style::Long => Self::long(),
            Style::Fur => Self::fur(),
            Style::Animal => Self {
                lift: 0.14,
                gravity: 4.0,
                length: 0.03,
                length_spread: 0.3,
                direction_spread: 0.2,
                clump_size: 20,
                most_clumps: 4000,
                clumping: 0.4,
                ..Self::fur()
            },
            Style::Ponytail => Self {
                lift: 0.95,
                gravity: 16.0,
                hem: None,
                length: 0.3,
                length_spread: 0.2,
                volume: 0.0,
                clump_size: 60,
                clumping: 0.7,
                wave: Wave { radius: 0.004, pitch: 0.12, roundness: 0.4, onset: 0.08, looseness: 0.8 },
                ..Self::long()
            },
            Style::Beard => Self {
                region: Region::Face,
                lift: 0.4,
                gravity: 10.0,
                length: 0.026,
                direction_spread: 0.3,
                clump_size: 12,
                most_clumps: 1000,
                clumping: 0.5,
                wave: Wave { radius: 0.0012, pitch: 0.014, roundness: 0.5, onset: 0.01, looseness: 0.9 },
                ..Self::fur()
            },
        }
    }

    fn long() -> Self {
        Self {
            region: Region::Scalp,
            parting: 0.0,
            lift: 0.3,
            gravity: 26.0,
            length: 0.3,
            hem: Some(-0.42),
            length_spread: 0.1,
            direction_spread: 0.12,
            volume: 0.026,
            clump_size: 48,
            most_clumps: 600,
            clumping: 0.8,
            clump_onset: 1.0,
            clump_width: 0.45,
            wave: Wave { radius: 0.005, pitch: 0.15, roundness: 0.2, onset: 0.25, looseness: 0.9 },
        }
    }

    fn curly() -> Self {
        Self {
            region: Region::Scalp,
            parting: 0.0,
            lift: 0.9,
            gravity: 13.0,
            length: 0.14,
            hem: None,
            length_spread: 0.25,
            direction_spread: 0.3,
            volume: 0.03,
            clump_size: 40,
            most_clumps: 600,
            clumping: 0.9,
            clump_onset: 0.45,
            clump_width: 0.4,
            wave: Wave { radius: 0.009, pitch: 0.03, roundness: 1.0, onset: 0.035, looseness: 0.35 },
        }
    }

    fn fur() -> Self {
        Self {
            region: Region::Everywhere,
            parting: 0.0,
            lift: 0.75,
            gravity: 18.0,
            length: 0.028,
            hem: None,
            length_spread: 0.35,
            direction_spread: 0.25,
            volume: 0.0,
            clump_size: 24,
            most_clumps: 600,
            clumping: 0.7,
            clump_onset: 1.0,
            clump_width: 0.25,
            wave: Wave { radius: 0.0006, pitch: 0.02, roundness: 0.5, onset: 0.01, looseness: 0.9 },
        }
    }
}
