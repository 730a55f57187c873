//! A mesh of a node, added to the one mesh of a character.

use ::gltf::mesh::{Mode, Primitive, Semantic};
use glam::{DAffine3, DMat4, Vec2, Vec3, Vec4};
use tressfx_core::asset::AssetProblem;
use tressfx_core::body::{Influences, Morph, MorphOffset};

use super::accessor::Arrays;
use super::gltf::{broken, unsound};
use super::{Character, Joint, MorphWeights};
use crate::FileError;
use crate::mesh::vertex_normals;

/// More vertices than this a character cannot have: a small file may name one mesh many times.
const MOST_VERTICES: usize = 1 << 24;
/// A skeleton whose scale differs from that of its mesh by more than this share brings the mesh into its space.
const SAME_SCALE: f64 = 0.01;
/// By how much weights may miss 1 before they count as made to sum to it.
const ROUNDING: f32 = 1e-3;

/// The joints of a skin within those of the character, and where its vertices are brought.
#[derive(Clone, Copy, Debug)]
pub(super) struct Skin {
    first: u32,
    count: u32,
    placed: DAffine3,
}

/// Adds the mesh of a node.
///
/// # Errors
/// As [`super::read_bytes`].
pub(super) fn add(
    character: &mut Character,
    arrays: Arrays<'_>,
    node: &::gltf::Node<'_>,
    mesh: &::gltf::Mesh<'_>,
    places: &[DAffine3],
    skins: &mut [Option<Skin>],
) -> Result<(), FileError> {
    let skin = match node.skin() {
        None => own_joint(character, arrays.name, node, places)?,
        Some(skin) => match skins[skin.index()] {
            Some(known) => known,
            None => *skins[skin.index()].insert(joints(character, arrays, &skin, places)?),
        },
    };
    let targets = mesh.primitives().map(|primitive| primitive.morph_targets().len()).max().unwrap_or(0);
    let first_morph = character.mesh.morphs.len();
    let rest = mesh.weights().unwrap_or_default();
    let rest = (0..targets).map(|target| f64::from(rest.get(target).copied().unwrap_or(0.0))).collect();
    character.morphs.push(MorphWeights { node: node.index(), rest });
    let name = |target| format!("{} {target}", mesh.name().unwrap_or("morph target"));
    character.mesh.morphs.extend((0..targets).map(|target| Morph { name: name(target), offsets: Vec::new() }));
    for primitive in mesh.primitives() {
        let field = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
        Part { arrays, field, skin, is_skinned: node.skin().is_some(), first_morph }.add(character, &primitive)?;
    }
    Ok(())
}

/// The node itself as the only joint.
fn own_joint(
    character: &mut Character,
    name: &str,
    node: &::gltf::Node<'_>,
    places: &[DAffine3],
) -> Result<Skin, FileError> {
    let placed = places[node.index()];
    let inverse_bind = inverse(placed).ok_or_else(|| unsound(name, format!("node {}", node.index())))?;
    let first = character.joints.len() as u32;
    character.joints.push(Joint { node: node.index(), inverse_bind });
    character.mesh.joints.push(node_name(node));
    Ok(Skin { first, count: 1, placed })
}

fn joints(
    character: &mut Character,
    arrays: Arrays<'_>,
    skin: &::gltf::Skin<'_>,
    places: &[DAffine3],
) -> Result<Skin, FileError> {
    let field = format!("inverse bind matrices of skin {}", skin.index());
    let nodes: Vec<_> = skin.joints().collect();
    if nodes.is_empty() {
        return Err(broken(arrays.name, format!("skin {}", skin.index()), "it has no joints"));
    }
    let matrices = match skin.inverse_bind_matrices() {
        None => vec![DAffine3::IDENTITY; nodes.len()],
        Some(accessor) => {
            let matrices = arrays.floats::<16>(&accessor, &field, Some(nodes.len()))?;
            matrices.iter().map(|m| DAffine3::from_mat4(DMat4::from_cols_array(&m.map(f64::from)))).collect()
        }
    };
    let at_rest = places[nodes[0].index()] * matrices[0];
    let scale = at_rest.matrix3.determinant().abs().cbrt();
    let placed = if (scale - 1.0).abs() > SAME_SCALE { at_rest } else { DAffine3::IDENTITY };
    let back = inverse(placed).ok_or_else(|| unsound(arrays.name, field))?;
    let first = character.joints.len() as u32;
    for (node, matrix) in nodes.iter().zip(matrices) {
        character.joints.push(Joint { node: node.index(), inverse_bind: matrix * back });
        character.mesh.joints.push(node_name(node));
    }
    Ok(Skin { first, count: nodes.len() as u32, placed })
}

fn node_name(node: &::gltf::Node<'_>) -> String {
    node.name().map_or_else(|| format!("node {}", node.index()), str::to_owned)
}

fn inverse(placed: DAffine3) -> Option<DAffine3> {
    let inverse = placed.inverse();
    (placed.matrix3.determinant() != 0.0 && inverse.is_finite()).then_some(inverse)
}

/// A primitive on its way into the mesh.
struct Part<'a> {
    arrays: Arrays<'a>,
    field: String,
    skin: Skin,
    is_skinned: bool,
    first_morph: usize,
}

impl Part<'_> {
    fn add(&self, character: &mut Character, primitive: &Primitive<'_>) -> Result<(), FileError> {
        match primitive.mode() {
            Mode::Triangles => {}
            Mode::TriangleStrip | Mode::TriangleFan => {
                return Err(broken(
                    self.arrays.name,
                    self.field.clone(),
                    "strips and fans are not read: triangles alone",
                ));
            }
            _ => return Ok(()),
        }
        let first = character.mesh.positions.len();
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Err(broken(self.arrays.name, self.field.clone(), "it has no positions"));
        };
        if positions.count().saturating_add(first) > MOST_VERTICES {
            return Err(broken(self.arrays.name, self.field.clone(), "the meshes have more than 2^24 vertices"));
        }
        let positions = self.vectors(&positions, "positions", None)?;
        let count = positions.len();
        let triangles = self.triangles(primitive, count)?;
        let normals = match primitive.get(&Semantic::Normals) {
            Some(normals) => self.vectors(&normals, "normals", Some(count))?,
            None => vertex_normals(&positions, triangles.as_flattened()),
        };
        let turn = self.skin.placed.matrix3.inverse().transpose();
        let placed = |position: &Vec3| self.skin.placed.transform_point3(position.as_dvec3()).as_vec3();
        let turned = |normal: &Vec3| (turn * normal.as_dvec3()).as_vec3();
        let influences = self.influences(character, primitive, count)?;
        let (uvs, tangents) = (self.uvs(primitive, count)?, self.tangents(primitive, count)?);
        let mesh = &mut character.mesh;
        mesh.uvs.extend(uvs);
        mesh.tangents.extend(tangents);
        mesh.positions.extend(positions.iter().map(placed));
        mesh.normals.extend(normals.iter().map(|normal| turned(normal).normalize_or(Vec3::Y)));
        mesh.triangles.extend(triangles.iter().map(|corners| corners.map(|corner| corner + first as u32)));
        mesh.influences.extend(influences);
        for (index, target) in primitive.morph_targets().enumerate() {
            let vectors = |accessor: Option<::gltf::Accessor<'_>>, what| match accessor {
                Some(accessor) => self.vectors(&accessor, &format!("{what} of morph target {index}"), Some(count)),
                None => Ok(vec![Vec3::ZERO; count]),
            };
            let positions = vectors(target.positions(), "positions")?;
            let normals = vectors(target.normals(), "normals")?;
            let offsets = positions.iter().zip(&normals).enumerate();
            let offsets = offsets.filter(|(_, (p, n))| **p != Vec3::ZERO || **n != Vec3::ZERO);
            mesh.morphs[self.first_morph + index].offsets.extend(offsets.map(|(vertex, (p, n))| MorphOffset {
                vertex: (first + vertex) as u32,
                position: self.skin.placed.transform_vector3(p.as_dvec3()).as_vec3(),
                normal: turned(n),
            }));
        }
        Ok(())
    }

    fn vectors(
        &self,
        accessor: &::gltf::Accessor<'_>,
        what: &str,
        count: Option<usize>,
    ) -> Result<Vec<Vec3>, FileError> {
        let vectors = self.arrays.floats::<3>(accessor, &format!("{}, {what}", self.field), count)?;
        Ok(vectors.into_iter().map(Vec3::from).collect())
    }

    /// The first texture coordinates; none where the primitive has none.
    fn uvs(&self, primitive: &Primitive<'_>, count: usize) -> Result<Vec<Vec2>, FileError> {
        let Some(uvs) = primitive.get(&Semantic::TexCoords(0)) else { return Ok(Vec::new()) };
        let uvs = self.arrays.floats::<2>(&uvs, &format!("{}, texture coordinates", self.field), Some(count))?;
        Ok(uvs.into_iter().map(Vec2::from).collect())
    }

    /// Unit tangents, brought to where the vertices are; none where the primitive has none.
    fn tangents(&self, primitive: &Primitive<'_>, count: usize) -> Result<Vec<Vec4>, FileError> {
        let Some(tangents) = primitive.get(&Semantic::Tangents) else { return Ok(Vec::new()) };
        let tangents = self.arrays.floats::<4>(&tangents, &format!("{}, tangents", self.field), Some(count))?;
        let placed = |[x, y, z, w]: [f32; 4]| {
            let along = self.skin.placed.transform_vector3(Vec3::new(x, y, z).as_dvec3());
            // A mirror changes the side of the bitangent.
            let side = if self.skin.placed.matrix3.determinant() < 0.0 { -w } else { w };
            along.as_vec3().normalize_or(Vec3::X).extend(if side < 0.0 { -1.0 } else { 1.0 })
        };
        Ok(tangents.into_iter().map(placed).collect())
    }

    fn triangles(&self, primitive: &Primitive<'_>, vertices: usize) -> Result<Vec<[u32; 3]>, FileError> {
        let field = format!("{}, indices", self.field);
        let indices = match primitive.indices() {
            Some(indices) => self.arrays.integers::<1>(&indices, &field, None)?.into_flattened(),
            None => (0..vertices as u32).collect(),
        };
        if let Some(place) = indices.iter().position(|&index| index as usize >= vertices) {
            let problem = AssetProblem::out_of_range(indices[place], "a vertex of the primitive");
            return Err(FileError::new(self.arrays.name, format!("{field}, entry {place}"), problem));
        }
        match indices.as_chunks::<3>() {
            (triangles, []) => Ok(triangles.to_vec()),
            _ => Err(broken(self.arrays.name, field, "their number is no multiple of 3")),
        }
    }

    /// The joints of the vertices, as the character counts them.
    fn influences(
        &self,
        character: &mut Character,
        primitive: &Primitive<'_>,
        count: usize,
    ) -> Result<Vec<Influences>, FileError> {
        if !self.is_skinned {
            return Ok(vec![Influences::rigid(self.skin.first); count]);
        }
        let mut sets = Vec::new();
        for set in 0.. {
            let arrays = [Semantic::Joints(set), Semantic::Weights(set)].map(|semantic| primitive.get(&semantic));
            let [Some(joints), Some(weights)] = arrays else { break };
            let joints = self.arrays.integers::<4>(&joints, &format!("{}, joints", self.field), Some(count))?;
            let weights = self.arrays.floats::<4>(&weights, &format!("{}, weights", self.field), Some(count))?;
            sets.push((joints, weights));
        }
        if sets.is_empty() {
            return Err(broken(self.arrays.name, self.field.clone(), "it has a skin, but its vertices have no joints"));
        }
        let mut influences = Vec::with_capacity(count);
        for vertex in 0..count {
            let pairs = sets.iter().flat_map(|(joints, weights)| joints[vertex].into_iter().zip(weights[vertex]));
            let pairs: Vec<_> = pairs.filter(|&(_, weight)| weight != 0.0).collect();
            let sum: f32 = pairs.iter().map(|pair| pair.1).sum();
            character.normalised += usize::from((sum - 1.0).abs() > ROUNDING);
            character.reduced += usize::from(pairs.len() > 4);
            let field = format!("{}, weights of vertex {vertex}", self.field);
            if let Some(&(joint, _)) = pairs.iter().find(|&&(joint, _)| joint >= self.skin.count) {
                let problem = AssetProblem::out_of_range(joint, "a joint of the skin");
                return Err(FileError::new(self.arrays.name, field, problem));
            }
            let Some(mut of) = Influences::strongest(&pairs) else {
                let problem = AssetProblem::out_of_range(sum, "weights of 0 or more, not all 0");
                return Err(FileError::new(self.arrays.name, field, problem));
            };
            let weights = of.weights;
            of.joints = std::array::from_fn(|slot| match weights[slot] {
                0.0 => 0,
                _ => of.joints[slot] + self.skin.first,
            });
            influences.push(of);
        }
        Ok(influences)
    }
}
