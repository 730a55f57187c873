//! The body that hair grows on and that moves it: `--character` and what belongs to it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use tressfx_asset::character::{Character, read_bytes};
use tressfx_asset::mesh::{Mesh, skinned_obj};
use tressfx_asset::{FileKind, bones, tfxmesh};
use tressfx_core::backend::Backend;
use tressfx_core::body::{MeshPose, SkinnedMesh};
use tressfx_core::pass::PassList;
use tressfx_core::strands::Strands;
use tressfx_sim::body::{Binding, BoneRoots, Skinning, TriangleRoots};
use tressfx_sim::field::{FieldDesc, VertexBuffer};
use tressfx_sim::{HairSim, reference};
use tressfx_viewer::scene::SceneMesh;

/// A root may be so far from the skin, as a share of the size of the body.
const MOST: f64 = 0.05;
/// Poses of an animation in which the room is measured that it takes.
const SAMPLES: u32 = 32;

#[derive(Clone, Debug, Args)]
pub(crate) struct BodyArgs {
    /// The body that the hair grows on and moves with; it is drawn, too
    #[arg(long, value_name = "FILE.glb|gltf|tfxmesh|obj")]
    pub(crate) character: Option<PathBuf>,
    /// An animation of the character, over and over; without one it stays in its bind pose
    #[arg(long, value_name = "NAME", requires = "character")]
    animation: Option<String>,
    /// The bones of the strands; without them, roots ride on the nearest triangles
    #[arg(long, value_name = "FILE.tfxbone", requires = "character")]
    bones: Option<PathBuf>,
}

impl BodyArgs {
    pub(crate) fn is_given(&self) -> bool {
        self.character.is_some()
    }
}

/// Reads a body of any kind; one without a skeleton stands still.
pub(crate) fn character(path: &Path) -> Result<Character> {
    let name = path.display().to_string();
    let data = std::fs::read(path).with_context(|| name.clone())?;
    Ok(match FileKind::of(&data) {
        FileKind::Character => read_bytes(&name, &data, Some(path.parent().unwrap_or(Path::new(""))))?,
        FileKind::SkinnedMesh => tfxmesh::read(&name, &data)?.into(),
        _ => skinned_obj(&name, &data)?.into(),
    })
}

/// How large a mesh is: the diagonal of the box around it.
pub(crate) fn size(character: &Character) -> f64 {
    let positions = &character.mesh.positions;
    let low = positions.iter().copied().fold(glam::Vec3::INFINITY, glam::Vec3::min);
    let high = positions.iter().copied().fold(glam::Vec3::NEG_INFINITY, glam::Vec3::max);
    f64::from(low.distance(high))
}

/// What writes the roots of a section.
#[derive(Debug)]
enum Roots {
    Triangles(TriangleRoots),
    Bones(BoneRoots),
}

/// A body with the hair on it.
#[derive(Debug)]
pub(crate) struct Body {
    character: Character,
    /// Its place among the animations.
    animation: Option<usize>,
    skinning: Skinning,
    roots: Vec<Roots>,
}

impl Body {
    /// The body that was asked for, without hair.
    pub(crate) fn read(args: &BodyArgs, backend: &mut dyn Backend, list: &mut PassList) -> Result<Option<Self>> {
        let Some(path) = &args.character else { return Ok(None) };
        let mut character = character(path)?;
        // Nothing here is bumpy.
        character.mesh.tangents.clear();
        let animation = args.animation.as_deref().map(|name| find(&character, name)).transpose()?;
        let skinning = Skinning::new(backend, list, &character.mesh, false)?;
        Ok(Some(Self { character, animation, skinning, roots: Vec::new() }))
    }

    /// Puts the roots of all sections on it.
    pub(crate) fn bind(
        &mut self,
        args: &BodyArgs,
        backend: &mut dyn Backend,
        list: &mut PassList,
        sim: &HairSim,
        sections: &[Strands],
    ) -> Result<()> {
        let Self { character, skinning, .. } = self;
        for (section, strands) in sections.iter().enumerate() {
            self.roots.push(match &args.bones {
                Some(path) => {
                    let name = path.display().to_string();
                    let data = std::fs::read(path).with_context(|| name.clone())?;
                    let of = bones::read(&name, &data)?.on_joints(&name, &character.mesh.joints)?;
                    let palette = skinning.palette();
                    Roots::Bones(BoneRoots::new(backend, list, (sim, section), strands, &of, palette)?)
                }
                None => {
                    let binding = Binding::of_guides(strands, &character.mesh, MOST * size(character))?;
                    let vertices = skinning.mesh_vertices();
                    Roots::Triangles(TriangleRoots::new(backend, list, sim, section, &binding, vertices)?)
                }
            });
        }
        Ok(())
    }

    /// Whether it is another one from frame to frame.
    pub(crate) fn moves(&self) -> bool {
        self.animation.is_some_and(|index| self.character.animations[index].seconds > 0.0)
    }

    /// What a field of it, as it is posed, is made of.
    pub(crate) fn field(&self) -> FieldDesc<'_> {
        let SkinnedMesh { positions, triangles, .. } = &self.character.mesh;
        // A position and a normal of four floats each.
        let vertices = VertexBuffer { buffer: self.skinning.vertices(), first: 0, stride: 8 };
        FieldDesc::new(positions, triangles.as_flattened()).with_vertices(vertices)
    }

    /// Poses it as it is after `seconds`, with its roots.
    pub(crate) fn pose(&mut self, list: &mut PassList, sim: &mut HairSim, seconds: f64) -> Result<()> {
        let pose = self.pose_at(seconds);
        self.skinning.pose(list, &pose)?;
        for roots in &self.roots {
            match roots {
                Roots::Triangles(roots) => roots.record(list, sim),
                Roots::Bones(roots) => roots.record(list, sim),
            }
        }
        Ok(())
    }

    fn pose_at(&self, seconds: f64) -> MeshPose {
        match self.animation.map(|index| &self.character.animations[index]) {
            None => self.character.mesh.bind_pose(),
            Some(animation) if animation.seconds > 0.0 => {
                self.character.pose(Some(animation), seconds.rem_euclid(animation.seconds))
            }
            Some(animation) => self.character.pose(Some(animation), 0.0),
        }
    }

    /// What draws it, wherever it is.
    pub(crate) fn scene_mesh(&self, backend: &mut dyn Backend, list: &mut PassList) -> Result<SceneMesh> {
        Ok(SceneMesh::of_vertices(backend, list, self.skinning.vertices(), &self.character.mesh.triangles)?)
    }

    /// The points that it reaches in its animation, without triangles: lights have to see all of them.
    pub(crate) fn reached(&self) -> Mesh {
        let seconds = self.animation.map_or(0.0, |index| self.character.animations[index].seconds);
        let samples = if self.animation.is_some() { SAMPLES } else { 1 };
        let mut reached = Mesh::default();
        for sample in 0..samples {
            let pose = self.pose_at(seconds * f64::from(sample) / f64::from(samples));
            let points = reference::skin(&self.character.mesh, &pose);
            let points = || points.iter().map(|vertex| vertex[0].as_vec3());
            reached.positions.push(points().fold(glam::Vec3::INFINITY, glam::Vec3::min));
            reached.positions.push(points().fold(glam::Vec3::NEG_INFINITY, glam::Vec3::max));
        }
        reached
    }
}

fn find(character: &Character, name: &str) -> Result<usize> {
    let mut animations = character.animations.iter();
    if let Some(index) = animations.position(|animation| animation.name == name) {
        return Ok(index);
    }
    let names: Vec<&str> = character.animations.iter().map(|animation| animation.name.as_str()).collect();
    match names[..] {
        [] => bail!("{}: it has no animations", character.mesh.name),
        _ => bail!("{}: no animation is named {name:?}; there are {}", character.mesh.name, names.join(", ")),
    }
}
