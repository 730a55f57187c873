//! Which segments can be seen in which tile of the picture.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec2, UVec2};
use rayon::prelude::*;

use crate::bound::Bound;
use crate::fibres::Fibres;
use crate::rays::Rays;

/// Pixels along the side of a tile.
pub(crate) const TILE: u32 = 8;

/// Lists hold at most so many segments at a time; what is more is done in several passes over the picture.
const MOST_LISTED: u64 = 1 << 26;

/// The division of a picture into tiles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiling {
    size: [u32; 2],
    columns: u32,
    rows: u32,
}

/// The segments of some tiles that follow each other.
#[derive(Debug)]
pub(crate) struct Lists {
    tiles: Range<u32>,
    /// Where the list of each tile ends.
    ends: Vec<usize>,
    segments: Vec<u32>,
}

impl Tiling {
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let [columns, rows] = size.map(|side| side.div_ceil(TILE));
        Self { size, columns, rows }
    }

    pub(crate) fn count(&self) -> u32 {
        self.columns * self.rows
    }

    /// The pixels of a tile.
    pub(crate) fn pixels(&self, tile: u32) -> impl Iterator<Item = [u32; 2]> + use<> {
        let low = UVec2::new(tile % self.columns, tile / self.columns) * TILE;
        let high = (low + TILE).min(UVec2::from_array(self.size));
        (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| [x, y]))
    }

    /// The tiles that a segment may be seen in.
    fn tiles_of(&self, bound: &Bound) -> impl Iterator<Item = u32> {
        let tile = f64::from(TILE);
        let end = UVec2::new(self.columns, self.rows);
        let low = (bound.low / tile).floor().max(DVec2::ZERO).as_uvec2();
        // Above 0 only where something of it is on the picture.
        let high = ((bound.high / tile).floor() + 1.0).max(DVec2::ZERO).as_uvec2().min(end);
        let half_diagonal = tile * std::f64::consts::FRAC_1_SQRT_2;
        let meets =
            move |&(x, y): &(u32, u32)| bound.meets((UVec2::new(x, y).as_dvec2() + 0.5) * tile, half_diagonal + 1e-9);
        let columns = self.columns;
        let tiles = (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| (x, y)));
        tiles.filter(meets).map(move |(x, y)| y * columns + x)
    }

    /// Calls `visit` with each segment and each tile that it may be seen in, on many threads.
    fn for_each(&self, rays: &Rays, fibres: &Fibres, visit: impl Fn(u32, u32) + Sync) {
        (0..fibres.end()).into_par_iter().with_min_len(1024).for_each(|segment| {
            if let Some(bound) = fibres.cone(segment).and_then(|cone| Bound::new(rays, &cone)) {
                self.tiles_of(&bound).for_each(|tile| visit(segment, tile));
            }
        });
    }

    /// How many segments each tile has.
    pub(crate) fn counts(&self, rays: &Rays, fibres: &Fibres) -> Vec<u32> {
        let counts: Vec<AtomicU32> = (0..self.count()).map(|_| AtomicU32::new(0)).collect();
        self.for_each(rays, fibres, |_, tile| {
            counts[tile as usize].fetch_add(1, Ordering::Relaxed);
        });
        counts.into_iter().map(AtomicU32::into_inner).collect()
    }
}

/// Runs of tiles of which the lists fit into memory together; a tile is never divided.
pub(crate) fn runs(counts: &[u32]) -> Vec<Range<u32>> {
    let (mut runs, mut start, mut listed) = (Vec::new(), 0, 0);
    for (tile, &count) in counts.iter().enumerate() {
        let tile = tile as u32;
        if listed + u64::from(count) > MOST_LISTED && tile > start {
            runs.push(start..tile);
            (start, listed) = (tile, 0);
        }
        listed += u64::from(count);
    }
    runs.push(start..counts.len() as u32);
    runs
}

impl Lists {
    /// The lists of `tiles`; `counts` are those of [`Tiling::counts`].
    pub(crate) fn new(tiling: &Tiling, rays: &Rays, fibres: &Fibres, counts: &[u32], tiles: Range<u32>) -> Self {
        let mut end = 0;
        let ends: Vec<usize> = counts[tiles.start as usize..tiles.end as usize]
            .iter()
            .map(|&count| {
                end += count as usize;
                end
            })
            .collect();
        let filled: Vec<AtomicU32> = ends.iter().map(|_| AtomicU32::new(0)).collect();
        let segments: Vec<AtomicU32> = (0..end).map(|_| AtomicU32::new(0)).collect();
        tiling.for_each(rays, fibres, |segment, tile| {
            if tiles.contains(&tile) {
                let list = (tile - tiles.start) as usize;
                let back = filled[list].fetch_add(1, Ordering::Relaxed) as usize;
                segments[ends[list] - 1 - back].store(segment, Ordering::Relaxed);
            }
        });
        let segments = segments.into_iter().map(AtomicU32::into_inner).collect();
        Self { tiles, ends, segments }
    }

    /// The tiles that have lists.
    pub(crate) fn tiles(&self) -> Range<u32> {
        self.tiles.clone()
    }

    /// The segments of a tile, in no order.
    pub(crate) fn of(&self, tile: u32) -> &[u32] {
        let list = (tile - self.tiles.start) as usize;
        let start = list.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.segments[start..self.ends[list]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_hold_every_tile_once_and_are_no_larger_than_they_may_be() {
        let most = MOST_LISTED as u32;
        let ends = |counts: &[u32]| runs(counts).iter().map(|run| (run.start, run.end)).collect::<Vec<_>>();
        assert_eq!(ends(&[]), [(0, 0)]);
        assert_eq!(ends(&[5, 6, 7]), [(0, 3)]);
        assert_eq!(ends(&[most, 1, most - 1, 1]), [(0, 1), (1, 3), (3, 4)]);
        assert_eq!(ends(&[most + 1, most + 1]), [(0, 1), (1, 2)]);
    }

    #[test]
    fn the_tiles_at_the_edge_end_with_the_picture() {
        let tiling = Tiling::new([17, 9]);
        assert_eq!(tiling.count(), 6);
        assert_eq!(tiling.pixels(5).collect::<Vec<_>>(), [[16, 8]]);
        let all: usize = (0..6).map(|tile| tiling.pixels(tile).count()).sum();
        assert_eq!(all, 17 * 9);
    }
}
