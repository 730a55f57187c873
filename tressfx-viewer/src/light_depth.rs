//! `viewer.light_depth`: what the lights of the studio see of the opaque meshes, for their shadows on hair.

use glam::Vec3;
use glam::camera::rh;
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{Backend, Depth, DepthOrder, Format, RasterDesc, TextureDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{self, Load, PassList, RasterPass};
use tressfx_core::shader::{RasterPipeline, Shader, ShaderSource, Specialization};
use tressfx_core::strands::Bounds;
use tressfx_core::uniform_array::UniformArray;
use tressfx_core::view::{Pose, View, Viewport};
use tressfx_render::uniforms::ViewUniform;
use tressfx_render::{Light, LightPlace, Lights, OpaqueDepth, STORED_LIGHTS, VIEW_MODULE};

use crate::scene::MeshDraw;

const LABEL: Label = "viewer.light_depth";

/// Pixels of what a light sees, each way.
const TEXELS: u32 = 1024;

/// Texels that hair may be behind a surface and still be lit: its surface is flat between the texels.
const BIAS: f32 = 2.0;

/// A light at a point sees the meshes from this many times their radius on.
const NEAREST: f32 = 1.1;

/// The depth of the scene as each light sees it, side by side in one texture; a light among the meshes sees none.
#[derive(Debug)]
pub struct LightDepth {
    pipeline: RasterPipeline,
    views: UniformArray<ViewUniform>,
    /// Lights that it has room for, and what they see; none where there are no meshes.
    seen: Option<(u32, TextureId)>,
    /// Around all meshes, with the head in its rest pose.
    sphere: (Vec3, f32),
}

impl LightDepth {
    /// Compiles the shader, and makes a texture for the lights that cast a shadow.
    ///
    /// # Errors
    /// What the backend says.
    pub fn new(backend: &mut dyn Backend, lights: &Lights, meshes: &[Mesh]) -> Result<Self> {
        let root = ("scene_depth", include_str!("../shaders/scene_depth.wgsl"));
        let source = ShaderSource { label: LABEL, root, library: &[VIEW_MODULE] };
        let shader = Shader::new(&source, &Specialization::new())?.into();
        let depth = Depth::TestWrite(DepthOrder::Standard);
        let casting = lights.lights.iter().take(STORED_LIGHTS).filter(|light| light.casts);
        let room = if meshes.is_empty() { 0 } else { casting.count() as u32 };
        let desc = TextureDesc::new(LABEL, [TEXELS * room, TEXELS], Format::Depth32F);
        let texture = (room > 0).then(|| backend.create_texture(&desc)).transpose()?;
        let bounds = Bounds::of(meshes.iter().flat_map(|mesh| &mesh.positions).copied());
        Ok(Self {
            pipeline: backend.create_raster(&RasterDesc::new(shader).depth(depth))?,
            views: UniformArray::new(backend, LABEL, STORED_LIGHTS)?,
            seen: texture.map(|texture| (room, texture)),
            sphere: (bounds.center(), 0.5 * (bounds.max - bounds.min).length()),
        })
    }

    /// Draws what the lights see of the meshes, which are all moved by `head`. Gives the lights back with what they see.
    ///
    /// # Errors
    /// None that can be reached: the names of bindings are those of the shader.
    pub fn draw(&self, list: &mut PassList, lights: &Lights, meshes: &[MeshDraw], head: Pose) -> Result<Lights> {
        let mut lit = lights.clone();
        meshes.iter().for_each(|mesh| mesh.upload(list));
        let Some((room, depth)) = self.seen else { return Ok(lit) };
        let target = [TEXELS * room, TEXELS];
        let mut load = Load::Clear(DepthOrder::Standard.far());
        let casting = lit.lights.iter_mut().take(STORED_LIGHTS).filter(|light| light.casts);
        for (index, light) in casting.take(room as usize).enumerate() {
            let origin = [TEXELS * index as u32, 0];
            let part = Viewport::part(origin, [TEXELS; 2], target).expect("each light has its part");
            let Some(view) = self.view(light, head, part) else { continue };
            self.views.upload(list, index, &[ViewUniform::new(&view, &Lights::default())]);
            let mut pass =
                RasterPass::new(LABEL).depth(depth, load).viewport(pass::Viewport { origin, size: [TEXELS; 2] });
            load = Load::Keep;
            for MeshDraw { mesh, .. } in meshes {
                let bindings = self.pipeline.bind(&mesh.bindings(self.views.binding(index)))?;
                pass = pass.draw(mesh.draw(&self.pipeline, &bindings));
            }
            list.raster(pass);
            let bias = BIAS * 2.0 * self.sphere.1 / TEXELS as f32;
            *light = light.opaque(OpaqueDepth { depth, view, bias });
        }
        Ok(lit)
    }

    /// From a light, around the meshes, into a part of the texture.
    fn view(&self, light: &Light, head: Pose, part: Viewport) -> Option<View> {
        let (middle, radius) = (head.transform(self.sphere.0), self.sphere.1);
        let (eye, lens) = match light.place {
            LightPlace::Directional { towards } => {
                let reach = 1.01 * radius;
                let lens = rh::proj::directx::orthographic(-reach, reach, -reach, reach, 0.5 * radius, 3.5 * radius);
                (middle + 2.0 * radius * towards.try_normalize()?, lens)
            }
            LightPlace::Point { position, .. } => {
                let distance = position.distance(middle);
                // From nearer by, no flat picture has all of the meshes in it.
                if distance < NEAREST * radius {
                    return None;
                }
                let angle = 2.0 * (1.01 * radius / distance).asin();
                (position, rh::proj::directx::perspective(angle, 1.0, distance - radius, distance + radius))
            }
        };
        let way = (middle - eye).try_normalize()?;
        let up = if way.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
        View::new(rh::view::look_to_mat4(eye, way, up), lens, DepthOrder::Standard, part).ok()
    }
}

#[cfg(test)]
mod tests {
    use tressfx_core::null::NullBackend;
    use tressfx_core::pass::Command;
    use tressfx_core::shape::Ellipsoid;

    use super::*;
    use crate::scene::{SceneMesh, Surface, studio_lights};

    #[test]
    fn lights_see_meshes_where_they_are_in_this_frame() {
        let mut backend = NullBackend::default();
        let ball = Mesh::ellipsoid(&Ellipsoid { center: Vec3::ZERO, radii: Vec3::ONE }, 8);
        let mesh = SceneMesh::new(&mut backend, &mut PassList::new(), &ball).unwrap();
        let mut lights = studio_lights();
        lights.lights.push(Light::point(Vec3::Y * 3.0, 1.0, Vec3::ONE));
        lights.lights.push(Light::point(Vec3::Y * 0.5, 1.0, Vec3::ONE));
        let depth = LightDepth::new(&mut backend, &lights, &[ball]).unwrap();
        let mut list = PassList::new();
        let meshes = [MeshDraw { mesh: &mesh, surface: Surface::default(), pose: Pose::IDENTITY }];
        let lit = depth.draw(&mut list, &lights, &meshes, Pose::IDENTITY).unwrap();
        let seen: Vec<_> = lit.lights.iter().map(|light| light.opaque.is_some()).collect();
        assert_eq!(seen, [true, true, true, true, false], "the last one is inside of the ball");
        let view = lit.lights[3].opaque.unwrap().view;
        let clip = view.view_projection() * Vec3::new(0.0, 1.0, 0.0).extend(1.0);
        assert!(
            (clip.truncate() / clip.w).truncate().length() < 1e-5,
            "what is below the light is in its middle: {clip}"
        );
        let first = list.commands().iter().position(Command::is_pass).unwrap();
        let is_place = |command: &Command| matches!(command, Command::Upload { dst, .. } if mesh.is_placed_by(*dst));
        assert!(list.commands()[..first].iter().any(is_place), "the place of the mesh comes before what draws it");
    }
}
