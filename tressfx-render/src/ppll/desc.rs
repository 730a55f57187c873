//! What lists are asked to be.

use super::Tail;
use super::nodes::NodeLimits;
use super::resolve::Variant;
use crate::output::Output;
use crate::segments::Fill;

/// Lists of fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PpllDesc {
    /// How many of the nearest fragments of a pixel are put in order exactly; the rest is blended without order. In
    /// [`K_RANGE`](crate::K_RANGE).
    pub k: u32,
    /// What is seen of the rest.
    pub tail: Tail,
    /// How many fragments of a pixel may take memory; `None` for all. The nearest do, the others are merged as they come: the
    /// opacity of the pixel is the same, and from `k` on the whole picture. The memory is bounded then, and takes 24 bytes and
    /// 4 for each of the nearest a pixel, and a third walk over the strands. Lists become so by themselves where there would be
    /// more fragments than there may be room for.
    pub cap: Option<u32>,
    /// Memory that the lists of fragments may take, 16 bytes a fragment, 20 with several places. They lie in one binding or in two, of what the device
    /// allows each to hold.
    pub max_node_bytes: u64,
    /// Where the counter of fragments stops, at most [`PpllDesc::COUNT_LIMIT`]; no more find room.
    pub count_limit: u32,
    /// What fills the lists.
    pub fill: Fill,
    /// Places in a pixel where light passes hair for itself, one of [`PLACES`](crate::PLACES). The fragments behind the `k` nearest
    /// cover all of them alike.
    pub places: u32,
    /// Whether hair is left out that is behind hair which lets less than a thousandth through: it takes neither memory nor part in the colour
    /// of a tail. None: where hair is predicted to be dense. Not with several places in a pixel: what covers one of them hides nothing in the others.
    pub skips_hidden: Option<bool>,
}

impl PpllDesc {
    /// The same with `k` sorted fragments a pixel.
    #[must_use]
    pub fn k(self, k: u32) -> Self {
        Self { k, ..self }
    }

    /// The same with something else to be seen of the rest.
    #[must_use]
    pub fn tail(self, tail: Tail) -> Self {
        Self { tail, ..self }
    }

    /// The same with memory for so many fragments of a pixel.
    #[must_use]
    pub fn cap(self, cap: impl Into<Option<u32>>) -> Self {
        Self { cap: cap.into(), ..self }
    }

    /// The same with room for at most so many bytes of fragments.
    #[must_use]
    pub fn max_node_bytes(self, max_node_bytes: u64) -> Self {
        Self { max_node_bytes, ..self }
    }

    /// The same with another end of counting.
    #[must_use]
    pub fn count_limit(self, count_limit: u32) -> Self {
        Self { count_limit, ..self }
    }

    /// The same, filled in another way.
    #[must_use]
    pub fn fill(self, fill: Fill) -> Self {
        Self { fill, ..self }
    }

    /// The same with another number of places in a pixel.
    #[must_use]
    pub fn places(self, places: u32) -> Self {
        Self { places, ..self }
    }

    /// The same, always with or always without hair that other hair hides.
    #[must_use]
    pub fn skips_hidden(self, skips_hidden: impl Into<Option<bool>>) -> Self {
        Self { skips_hidden: skips_hidden.into(), ..self }
    }

    /// The largest [`PpllDesc::count_limit`]. Up to twice as many can be asked for before the counter is seen to be full, and
    /// that still has to fit into 32 bits.
    pub const COUNT_LIMIT: u32 = i32::MAX as u32;

    /// How many fragments of a pixel have nodes where lists are bounded: more would not change the picture.
    pub(super) fn asked(&self) -> u32 {
        self.cap.unwrap_or(self.k).min(self.k)
    }

    /// Whether hidden hair is always or never looked for.
    pub(super) fn looks_for_hidden(&self) -> Option<bool> {
        if self.places > 1 { Some(false) } else { self.skips_hidden }
    }

    pub(super) fn variant(&self, bounded: bool, limits: &NodeLimits, output: Output) -> Variant {
        let more_nodes = limits.has_more(bounded);
        Variant { k: self.k, tail: self.tail, places: self.places, bounded, more_nodes, output }
    }
}

impl Default for PpllDesc {
    /// Eight sorted fragments a pixel, and room for at most 16.7 million fragments in all.
    fn default() -> Self {
        let (count_limit, fill) = (Self::COUNT_LIMIT, Fill::Compute);
        Self {
            k: 8,
            tail: Tail::default(),
            cap: None,
            max_node_bytes: 256 << 20,
            count_limit,
            fill,
            places: 1,
            skips_hidden: None,
        }
    }
}

impl From<PpllDesc> for crate::Technique {
    fn from(desc: PpllDesc) -> Self {
        Self::Ppll(desc)
    }
}
