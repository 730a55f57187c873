//! What the hair collides with: `--collide`.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::Backend;
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Bounds;
use tressfx_sim::Collider;
use tressfx_sim::field::{FieldDesc, Fields};

use crate::body::Body;

/// Nodes of a field along the longest side.
const NODES: u32 = 96;
/// The margin of a field in its cells: where the skin bends, a field is off by less.
const MARGIN: f32 = 0.5;
/// Cells that a field has beside those that its mesh is within.
const PADDING: u32 = 7;

#[derive(Clone, Debug, Args)]
pub(crate) struct Collision {
    /// What the hair collides with, beside the capsules of the parameters
    #[arg(long, value_enum, default_value_t = Collide::Capsules, value_name = "WHAT")]
    pub(crate) collide: Collide,
    /// A mesh in the unit of the hair, to be drawn with it and to collide with
    #[arg(long, value_name = "FILE.obj")]
    pub(crate) mesh: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Collide {
    /// A signed distance field of the meshes that are drawn with it
    Sdf,
    /// The capsules of a built-in groom
    Capsules,
    /// Nothing
    None,
}

impl Collision {
    /// The mesh that was named.
    pub(crate) fn mesh(&self) -> Result<Option<Mesh>> {
        Ok(self.mesh.as_ref().map(Mesh::read).transpose()?)
    }

    /// The capsules of a groom and of its parameters that count.
    pub(crate) fn capsules(&self, of_groom: &[Capsule], of_params: &[Capsule]) -> Vec<Collider<'static>> {
        let capsules = match self.collide {
            Collide::Sdf => of_params.to_vec(),
            Collide::Capsules => [of_groom, of_params].concat(),
            Collide::None => Vec::new(),
        };
        Collider::all_with_head(&capsules)
    }

    /// The fields that were asked for: first that of the character, then that of the meshes, as one body.
    pub(crate) fn fields(
        &self,
        backend: &mut dyn Backend,
        uploads: &mut PassList,
        meshes: &[Mesh],
        body: Option<&Body>,
    ) -> Result<Option<Fields>> {
        if self.collide != Collide::Sdf {
            return Ok(None);
        }
        if meshes.is_empty() && body.is_none() {
            bail!("--collide sdf: there is no mesh to collide with; name one with --mesh or --character");
        }
        let mut mesh = Mesh::default();
        meshes.iter().for_each(|part| mesh.append(part));
        let still = (!meshes.is_empty()).then(|| FieldDesc::new(&mesh.positions, &mesh.indices));
        let descs: Vec<_> = body.map(Body::field).into_iter().chain(still).map(fine).collect();
        Ok(Some(Fields::new(backend, uploads, &descs)?))
    }
}

/// As fine as fields of the program are.
fn fine(desc: FieldDesc) -> FieldDesc {
    let bounds = Bounds::of(desc.positions.iter().copied());
    let cell = (bounds.max - bounds.min).max_element() / (NODES - PADDING) as f32;
    desc.with_nodes(NODES).with_margin(MARGIN * cell)
}
