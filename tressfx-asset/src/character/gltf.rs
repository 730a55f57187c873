//! glTF 2.0: `.glb` with its chunks, and `.gltf`.

use std::path::Path;

use ::gltf::Document;
use ::gltf::json::Root;
use ::gltf::json::validation::Checked;
use tressfx_core::asset::AssetProblem;

use super::accessor::Arrays;
use super::animation::Animation;
use super::instance;
use super::nodes::Nodes;
use super::{Character, buffers};
use crate::binary::Bytes;
use crate::{FileError, FileErrorKind};

const MAGIC: &[u8; 4] = b"glTF";
const JSON: &[u8; 4] = b"JSON";
const BINARY: &[u8; 4] = b"BIN\0";

/// Something that the file must not say.
pub(super) fn broken(name: &str, field: String, what: &str) -> FileError {
    FileError::new(name, field, FileErrorKind::Gltf(what.to_owned()))
}

/// Numbers that are not finite, or that make nothing.
pub(super) fn unsound(name: &str, field: String) -> FileError {
    broken(name, field, "it has numbers that are not finite, or a rotation or scale that is none")
}

/// Whether a file is one: by the magic of a `.glb`, or as JSON.
pub(crate) fn is_like(data: &[u8]) -> bool {
    data.starts_with(MAGIC) || data.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{')
}

/// Reads a character from memory. Buffers in other files are looked for in `folder`; without one they are errors.
///
/// # Errors
/// What breaks the rules of glTF, an array that is not in the file, an index that names nothing, a value that is not finite, weights that are all
/// 0, and a file without triangles. The error names the file and the mesh, node or channel in it.
pub fn read_bytes(name: &str, data: &[u8], folder: Option<&Path>) -> Result<Character, FileError> {
    let (json, binary) = if data.starts_with(MAGIC) { chunks(Bytes { name, data })? } else { (data, None) };
    let wrong = |error: ::gltf::Error| FileError::new(name, "JSON", FileErrorKind::Gltf(error.to_string()));
    // Not by `Gltf::from_slice`: it would take a chunk that begins as a `.glb` does for another one, and panics where that is cut short.
    let root: Root = ::gltf::json::deserialize::from_slice(json).map_err(::gltf::Error::Deserialize).map_err(wrong)?;
    check_indices(name, &root)?;
    let document = Document::from_json(root).map_err(wrong)?;
    if let Some(extension) = document.extensions_required().next() {
        return Err(FileError::new(
            name,
            "extensionsRequired",
            FileErrorKind::Gltf(format!("{extension} is not known")),
        ));
    }
    let buffers = buffers::read(name, &document, binary, folder)?;
    character(Arrays { name, buffers: &buffers }, &document)
}

/// Indices that the validation of the crate panics at, or that it passes over and what comes after it panics at.
fn check_indices(name: &str, root: &Root) -> Result<(), FileError> {
    for (mesh, of) in root.meshes.iter().enumerate() {
        for (primitive, of) in of.primitives.iter().enumerate() {
            if of.attributes.values().any(|accessor| accessor.value() >= root.accessors.len()) {
                return Err(broken(name, format!("mesh {mesh}, primitive {primitive}"), "it names no accessor"));
            }
        }
    }
    for (animation, of) in root.animations.iter().enumerate() {
        for (place, channel) in of.channels.iter().enumerate() {
            let target = &channel.target;
            if target.node.value() >= root.nodes.len() || matches!(target.path, Checked::Invalid) {
                let field = format!("animation {animation}, channel {place}, target");
                return Err(broken(name, field, "no such node, or no property that is known"));
            }
        }
    }
    Ok(())
}

/// The JSON and the binary chunk of a `.glb`.
fn chunks(bytes: Bytes<'_>) -> Result<(&[u8], Option<&[u8]>), FileError> {
    match bytes.u32("version", 4)? {
        2 => {}
        other => return Err(bytes.error("version", 4, AssetProblem::out_of_range(other, "2"))),
    }
    let chunk = |at: usize, kind: &[u8; 4], field| {
        let length = bytes.u32(field, at)?;
        if bytes.slice(field, at + 4, 4, 1)? != kind {
            return Err(bytes.error(field, at + 4, FileErrorKind::Gltf("another kind of chunk is here".to_owned())));
        }
        bytes.slice(field, at + 8, length.into(), 1)
    };
    let json = chunk(12, JSON, "JSON chunk")?;
    let next = 20 + json.len().next_multiple_of(4);
    let binary = if next < bytes.data.len() { Some(chunk(next, BINARY, "binary chunk")?) } else { None };
    Ok((json, binary))
}

fn character(arrays: Arrays<'_>, document: &Document) -> Result<Character, FileError> {
    let nodes = Nodes::new(arrays.name, document)?;
    let mut character = Character { nodes, ..Character::default() };
    character.mesh.name = arrays.name.to_owned();
    let places = character.nodes.places(&character.nodes.rest);
    let mut skins = vec![None; document.skins().count()];
    for node in document.nodes() {
        if let Some(mesh) = node.mesh() {
            instance::add(&mut character, arrays, &node, &mesh, &places, &mut skins)?;
        }
    }
    // Texture coordinates and tangents that a part of the mesh does not have are of no use to the whole.
    let mesh = &mut character.mesh;
    if mesh.uvs.len() != mesh.positions.len() {
        mesh.uvs.clear();
    }
    if mesh.tangents.len() != mesh.positions.len() {
        mesh.tangents.clear();
    }
    for animation in document.animations() {
        character.animations.push(Animation::new(arrays, &animation)?);
    }
    character.mesh.check().map_err(|error| FileError::new(arrays.name, "meshes", error))?;
    Ok(character)
}
