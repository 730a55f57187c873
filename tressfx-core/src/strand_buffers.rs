//! The part of a section that simulation and rendering share on the GPU.

use glam::Vec3;

use crate::backend::{Backend, BufferDesc, Owner};
use crate::error::Result;
use crate::id::BufferId;
use crate::pass::PassList;
use crate::strands::{Strands, relative_to};

/// How many strands of how many vertices a section has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StrandShape {
    /// Strands that are simulated.
    pub guides: u32,
    /// Strands that follow each guide.
    pub follows: u32,
    /// Vertices of every strand, 2 to 256.
    pub vertices: u32,
}

impl StrandShape {
    /// The counts of a section.
    pub fn of(strands: &Strands) -> Self {
        Self { guides: strands.guides, follows: strands.follows, vertices: strands.vertices }
    }

    /// Guides and follow strands.
    pub fn strands(&self) -> u32 {
        self.guides * (1 + self.follows)
    }

    /// Vertices of all guides.
    pub fn guide_vertices(&self) -> u32 {
        self.guides * self.vertices
    }

    /// Vertices of all strands.
    pub fn strand_vertices(&self) -> u32 {
        self.strands() * self.vertices
    }

    /// Segments of all strands.
    pub fn segments(&self) -> u32 {
        self.strands() * (self.vertices - 1)
    }

    /// The place of a vertex in a buffer that holds all strands: vertex-major, so that threads that go along neighbouring
    /// strands read neighbouring addresses.
    pub fn index(&self, strand: u32, vertex: u32) -> u32 {
        vertex * self.strands() + strand
    }

    /// The strand that is follow strand `follow` of `guide`.
    pub fn follow(&self, guide: u32, follow: u32) -> u32 {
        self.guides * (1 + follow) + guide
    }
}

/// What the simulation writes and the rendering reads; vertex-major, see [`StrandShape::index`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandBuffers {
    /// The counts.
    pub shape: StrandShape,
    /// The point of the rest pose that positions are relative to, see [`Bounds::rounded_center`](crate::strands::Bounds::rounded_center).
    pub center: Vec3,
    /// `vec4<f32>` a vertex of every strand: position relative to the centre in the unit of the file, inverse mass.
    pub positions: BufferId,
    /// `vec4<f32>` a vertex of every strand: unit tangent towards the tip, 0.
    pub tangents: BufferId,
    /// `f32` a vertex of every guide, `vertex * guides + guide`: width of the strand there, as a share of its full width.
    pub thickness: BufferId,
}

impl StrandBuffers {
    /// Makes the buffers, filled with zeros.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size.
    pub fn new(backend: &mut dyn Backend, shape: StrandShape, center: Vec3) -> Result<Self> {
        let made = Owner::build(backend, |backend| {
            let mut create = |label, bytes_each: u64, count: u32| {
                backend.create_buffer(&BufferDesc::storage(label, (bytes_each * u64::from(count)).max(16)))
            };
            Ok(Self {
                shape,
                center,
                positions: create("hair.positions", 16, shape.strand_vertices())?,
                tangents: create("hair.tangents", 16, shape.strand_vertices())?,
                thickness: create("hair.thickness", 4, shape.guide_vertices())?,
            })
        });
        made.map(|(made, owner)| {
            owner.leave();
            made
        })
    }

    /// Frees the buffers.
    pub fn destroy(self, backend: &mut dyn Backend) {
        [self.positions, self.tangents, self.thickness].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }

    /// Puts the rest pose into the buffers.
    pub fn upload(&self, list: &mut PassList, strands: &Strands) {
        let copies = 1 + strands.follows as usize;
        list.upload(self.positions, 0, &strands.interleave(&relative_to(self.center, &strands.rest_of_all())));
        list.upload(self.tangents, 0, &strands.interleave(&strands.tangents.repeat(copies)));
        list.upload(self.thickness, 0, &strands.interleave(&strands.thickness));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::{AssetFormat, HairAsset};
    use crate::strands::StrandOptions;

    #[test]
    fn places_in_a_buffer_are_those_of_the_interleaved_strands() {
        let points = (0..15).map(|i| [(i / 3) as f32, (i % 3) as f32, 0.5]).collect();
        let asset = HairAsset::new("comb", AssetFormat::Builtin, points, vec![3; 5]);
        let options = StrandOptions { follows: Some(2), ..StrandOptions::default() };
        let strands = Strands::new(&asset, &options).expect("a sound groom");
        let shape = StrandShape::of(&strands);
        let numbered: Vec<u32> = (0..shape.strand_vertices()).collect();
        let interleaved = strands.interleave(&numbered);
        for strand in 0..shape.strands() {
            for vertex in 0..shape.vertices {
                let place = shape.index(strand, vertex) as usize;
                assert_eq!(interleaved[place], strand * shape.vertices + vertex);
            }
        }
        let root = |strand: u32| strands.rest_of_all()[(strand * shape.vertices) as usize];
        let offset = strands.follow_offsets[(shape.guides + 3) as usize];
        assert_eq!(root(shape.follow(3, 1)), root(3) + offset, "the second follow strand of guide 3");
    }
}
