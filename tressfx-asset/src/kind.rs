//! What a file is, by its content.

use crate::{bones, character, detect, pc2, tfxmesh, tfxskin, tokenizer};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileKind {
    /// Strands: [`crate::read`].
    Groom,
    /// A character as glTF: [`crate::character`].
    Character,
    /// A skinned mesh as text: [`crate::tfxmesh`].
    SkinnedMesh,
    /// The bones of strands: [`crate::bones`].
    StrandBones,
    /// The triangles of strands: [`crate::tfxskin`].
    StrandTriangles,
    /// A mesh in motion: [`crate::pc2`].
    PointCache,
}

impl FileKind {
    /// That of a file; a groom where nothing else is known, whose reader then says what is wrong.
    pub fn of(data: &[u8]) -> Self {
        if character::is_like(data) {
            Self::Character
        } else if data.starts_with(pc2::MAGIC) {
            Self::PointCache
        } else if tokenizer::first_word(data).is_some_and(tfxmesh::is_first_word) {
            Self::SkinnedMesh
        } else if detect(data).is_some() {
            Self::Groom
        } else if tfxskin::is_like(data) {
            Self::StrandTriangles
        } else if bones::is_like(data) {
            Self::StrandBones
        } else {
            Self::Groom
        }
    }
}
