//! The nodes of a file: who hangs on whom, and where they are at rest.

use ::gltf::Document;
use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::gltf::{broken, unsound};
use crate::FileError;

/// A node in the space of its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
}

/// All nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Nodes {
    /// At rest.
    pub(super) rest: Vec<Place>,
    parents: Vec<Option<usize>>,
    /// Parents before their children.
    order: Vec<usize>,
}

impl Nodes {
    /// So many nodes without parents, at the origin.
    pub(super) fn apart(count: usize) -> Self {
        let place = Place { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
        Self { rest: vec![place; count], parents: vec![None; count], order: (0..count).collect() }
    }

    /// # Errors
    /// A node with two parents or among its own, and one with numbers that make no place.
    pub(super) fn new(name: &str, document: &Document) -> Result<Self, FileError> {
        let count = document.nodes().count();
        let mut parents = vec![None; count];
        let mut rest = Vec::with_capacity(count);
        for node in document.nodes() {
            for child in node.children() {
                if parents[child.index()].replace(node.index()).is_some() {
                    return Err(broken(name, format!("node {}", child.index()), "it is a child twice"));
                }
            }
            rest.push(place(&node).ok_or_else(|| unsound(name, format!("node {}", node.index())))?);
        }
        let mut order: Vec<usize> = (0..count).filter(|&node| parents[node].is_none()).collect();
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            order.extend(document.nodes().nth(node).iter().flat_map(::gltf::Node::children).map(|child| child.index()));
            next += 1;
        }
        if order.len() != count {
            return Err(broken(name, "nodes".to_owned(), "some are children of themselves"));
        }
        Ok(Self { rest, parents, order })
    }

    /// Where all nodes are in the world.
    pub(super) fn places(&self, nodes: &[Place]) -> Vec<DAffine3> {
        let mut places = vec![DAffine3::IDENTITY; nodes.len()];
        for &node in &self.order {
            let Place { translation, rotation, scale } = nodes[node];
            let own = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
            places[node] = self.parents[node].map_or(own, |parent| places[parent] * own);
        }
        places
    }
}

/// `None` where it is no place.
fn place(node: &::gltf::Node<'_>) -> Option<Place> {
    let (translation, rotation, scale) = match node.transform() {
        ::gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            (DVec3::from_array(translation.map(f64::from)), rotation, DVec3::from_array(scale.map(f64::from)))
        }
        ::gltf::scene::Transform::Matrix { matrix } => {
            let matrix = DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)));
            let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
            (translation, rotation, scale)
        }
    };
    let length = rotation.length();
    let sound = translation.is_finite() && scale.is_finite() && length.is_finite() && length > 1e-6;
    sound.then(|| Place { translation, rotation: rotation.normalize(), scale })
}
