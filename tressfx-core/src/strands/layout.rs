//! Orders of vertices and of strands: strand-major and vertex-major, guides and files.

use glam::Vec4;

use super::{Strands, StrandsError};
use crate::asset::{AssetFormat, HairAsset};

impl Strands {
    /// From strand-major (`strand * vertices + vertex`) to the GPU's vertex-major (`vertex * strands + strand`). Takes any
    /// number of strands: guides alone, or all.
    ///
    /// # Panics
    /// Where the length is not a multiple of [`Strands::vertices`].
    pub fn interleave<T: Copy>(&self, strand_major: &[T]) -> Vec<T> {
        transpose(strand_major, self.strands_in(strand_major.len()), self.vertices as usize)
    }

    /// From the GPU's vertex-major order back to strand-major: the inverse of [`Strands::interleave`].
    ///
    /// # Panics
    /// Where the length is not a multiple of [`Strands::vertices`].
    pub fn deinterleave<T: Copy>(&self, vertex_major: &[T]) -> Vec<T> {
        transpose(vertex_major, self.vertices as usize, self.strands_in(vertex_major.len()))
    }

    fn strands_in(&self, length: usize) -> usize {
        let vertices = self.vertices as usize;
        assert!(length.is_multiple_of(vertices), "{length} values are not whole strands of {vertices} vertices");
        length / vertices
    }

    /// Turns a pose into an asset, in the order of the file that the strands came from: each guide, and behind it its
    /// follow strands where `all` is set. Inverse masses, strand UVs, colours and thickness come along; the unit stays the file's.
    ///
    /// `positions` are strand-major, of the guides or of all strands; `w` is not looked at.
    ///
    /// # Errors
    /// Where there are not as many positions as the guides have vertices, or, with `all`, as all strands have.
    pub fn pose_asset(&self, positions: &[Vec4], all: bool) -> Result<HairAsset, StrandsError> {
        let vertices = self.vertices as usize;
        let (guides, strands) = (self.guides as usize, self.strand_count() as usize);
        let enough = positions.len() == strands * vertices || (!all && positions.len() == guides * vertices);
        if !enough {
            let needed = if all { strands } else { guides } * vertices;
            return Err(StrandsError::PoseLength { found: positions.len(), needed });
        }
        let copies = if all { 1 + self.follows as usize } else { 1 };
        let (mut points, mut masses) = (Vec::new(), Vec::new());
        let mut uvs = self.strand_uv.as_ref().map(|_| Vec::new());
        let mut colors = self.vertex_colors.as_ref().map(|_| Vec::new());
        let mut widths = self.vertex_widths.as_ref().map(|_| Vec::new());
        for guide in self.guides_in_file_order() {
            let own = guide * vertices..(guide + 1) * vertices;
            for copy in 0..copies {
                let start = (guides * copy + guide) * vertices;
                points.extend(positions[start..start + vertices].iter().map(|p| p.truncate().to_array()));
                masses.extend(self.rest[own.clone()].iter().map(|vertex| vertex.w));
                if let (Some(out), Some(uv)) = (&mut uvs, &self.strand_uv) {
                    out.push(uv[guide].to_array());
                }
                if let (Some(out), Some(of)) = (&mut colors, &self.vertex_colors) {
                    out.extend(of[own.clone()].iter().map(Vec4::to_array));
                }
                if let (Some(out), Some(of)) = (&mut widths, &self.vertex_widths) {
                    out.extend_from_slice(&of[own.clone()]);
                }
            }
        }
        let counts = vec![self.vertices; guides * copies];
        Ok(HairAsset {
            inverse_mass: Some(masses),
            strand_uvs: uvs,
            vertex_colors: colors,
            vertex_thickness: widths,
            ..HairAsset::new(self.name.clone(), AssetFormat::TressFx4, points, counts)
        })
    }

    /// The guide that each strand of the file became.
    fn guides_in_file_order(&self) -> Vec<usize> {
        let mut guides = vec![0; self.order.len()];
        self.order.iter().enumerate().for_each(|(guide, &strand)| guides[strand as usize] = guide);
        guides
    }
}

/// Rows become columns.
fn transpose<T: Copy>(values: &[T], rows: usize, columns: usize) -> Vec<T> {
    (0..columns).flat_map(|column| (0..rows).map(move |row| values[row * columns + column])).collect()
}
