//! Where pictures are taken: targets, lights, backdrop, the mesh that hair grows on, and the renderer.

use anyhow::Result;
use glam::Quat;
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{Caps, Format, TextureDesc};
use tressfx_core::pass::{Load, PassList, RasterPass, Ticket};
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::view::{Pose, View};
use tressfx_render::{
    Counters, HAIR_FORMAT, HairRenderer, LightPlace, Lights, LodDesc, Material, RenderDesc, SectionDraw, ShadedStrands,
    StrandInfo, Targets, Technique, VELOCITY_FORMAT, ViewDraw,
};
use tressfx_sim::Interpolation;
use tressfx_viewer::light_depth::LightDepth;
use tressfx_viewer::scene::{Backdrop, MeshDraw, Scene, SceneMesh, ScenePass, Surface, studio_lights};

use crate::cli::{self, Render};
use crate::field_view::FieldViews;
use crate::interpolate;
use crate::oit::CompositeName;
use crate::own_look::Textures;
use crate::run::Run;
use crate::stats::RenderStats;

const TARGET: Format = Format::Rgba16F;

/// More than hair moves: pixels without hair.
pub(crate) const NO_MOTION: f32 = 1e9;

/// Whether a compute pass lays hair over the picture.
fn is_storage_target(args: &Render, caps: &Caps, hair_output: bool) -> bool {
    match args.oit.composite {
        Some(composite) => composite == CompositeName::Compute,
        None => caps.read_write_textures && !caps.is_cpu && !hair_output,
    }
}

/// Everything that a picture is taken with.
#[derive(Debug)]
pub(crate) struct Studio {
    pub(crate) targets: Targets,
    /// What the newest frame drew.
    pub(crate) drawn: RenderStats,
    pub(crate) view: View,
    pub(crate) lights: Lights,
    /// As they stand in the first frame.
    first_lights: Lights,
    light_depth: LightDepth,
    scene: ScenePass,
    meshes: Vec<SceneMesh>,
    /// What the meshes draw, if it is not the meshes of the run.
    views: FieldViews,
    /// The meshes of the run on the CPU.
    pub(crate) opaque: Vec<Mesh>,
    pub(crate) sections: Vec<(ShadedStrands, Material)>,
    renderer: HairRenderer,
    lod: Option<LodDesc>,
    /// A section each, where strands are made between guides.
    interpolations: Vec<Interpolation>,
}

impl Studio {
    pub(crate) fn new(run: &mut Run, args: &Render) -> Result<Self> {
        let view = args.camera.view(&run.groom.rest(), args.size)?;
        let backend = &mut *run.backend;
        let hair_output = args.depth_out.is_some() || args.coverage_out.is_some();
        let storage_target = is_storage_target(args, backend.caps(), hair_output);
        let picture = TextureDesc::new("picture", args.size, TARGET);
        let picture = backend.create_texture(&if storage_target { picture.storage() } else { picture })?;
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, args.size, format));
        let mut targets = Targets::new(picture, texture("depth", Format::Depth32F)?);
        if hair_output {
            targets = targets.hair(texture("hair", HAIR_FORMAT)?);
        }
        let velocity_output = args.velocity_out.is_some();
        if velocity_output {
            targets = targets.velocity(texture("velocity", VELOCITY_FORMAT)?);
        }
        let mut uploads = PassList::new();
        let mut opaque = run.meshes.clone();
        let mut meshes: Vec<SceneMesh> = Vec::new();
        if args.show.is_none() {
            for mesh in &opaque {
                meshes.push(SceneMesh::new(backend, &mut uploads, mesh)?);
            }
        }
        if let Some(body) = &run.body {
            if args.show.is_none() {
                meshes.push(body.scene_mesh(backend, &mut uploads)?);
            }
            opaque.push(body.reached());
        }
        let (mut sections, mut own_colors, textures) = (Vec::new(), false, Textures::read(args)?);
        let interpolations = match args.interpolate {
            None => Vec::new(),
            Some(count) => {
                let groom = (&run.groom, &run.sim);
                interpolate::between(count, (backend, &mut uploads), groom, &run.params.interpolation)?
            }
        };
        for (index, strands) in run.groom.sections.iter().enumerate() {
            let (buffers, info, look) = match interpolations.get(index) {
                None => (run.sim.buffers()[index], StrandInfo::new(strands), textures.look(strands)?),
                Some(between) => {
                    let (info, look) = interpolate::look(between, strands, &textures)?;
                    (*between.buffers(), info, look)
                }
            };
            let section = ShadedStrands::new(backend, buffers, info)?;
            let section = if velocity_output { section.with_past(backend)? } else { section };
            own_colors |= look.colors().is_some();
            let section = section.with_own_look(backend, &mut uploads, &look)?;
            sections.push((section, material(args, *run.params.material(index))));
        }
        let desc = RenderDesc::new(args.size, TARGET).technique(args.oit.technique()?).views(1);
        let desc = desc.storage_target(storage_target).hair_output(hair_output);
        // Where nothing opaque is drawn, nothing that is not seen keeps light away.
        let shadows = args.shadows.desc().map(|shadows| shadows.skin(!opaque.is_empty()));
        let copies = sections.iter().any(|(_, material)| material.copies > 1);
        let desc = desc.shadows(shadows).velocity_output(velocity_output).own_colors(own_colors).copies(copies);
        let mut renderer = HairRenderer::new(backend, &desc)?;
        let lod = args.lod.desc();
        renderer.grow_to_predicted(backend, &view, &draws(&sections, run.sim.pose(), &view, lod.as_ref()))?;
        let scene = ScenePass::new(backend, TARGET, view.depth(), desc.shadows.is_some())?;
        let (lights, drawn) = (run.params.lights()?.unwrap_or_else(studio_lights), RenderStats::default());
        let first_lights = lights.clone();
        let light_depth = LightDepth::new(backend, &lights, &opaque)?;
        backend.run(&uploads)?;
        let mut views = FieldViews::default();
        if args.show.is_some() {
            (views, meshes) = FieldViews::new(run)?;
        }
        Ok(Self {
            targets,
            drawn,
            view,
            lights,
            first_lights,
            light_depth,
            scene,
            meshes,
            views,
            opaque,
            sections,
            renderer,
            lod,
            interpolations,
        })
    }

    /// The buffers of the strands that are drawn, a section each.
    pub(crate) fn buffers(&self, run: &Run) -> Vec<StrandBuffers> {
        let simulated = run.sim.buffers().iter().enumerate();
        simulated
            .map(|(index, &own)| self.interpolations.get(index).map_or(own, |between| *between.buffers()))
            .collect()
    }

    /// Turns the lights to so many degrees about the vertical axis from where they stand.
    pub(crate) fn turn_lights(&mut self, degrees: f32) {
        let turn = Quat::from_rotation_y(degrees.to_radians());
        self.lights.clone_from(&self.first_lights);
        for light in &mut self.lights.lights {
            match &mut light.place {
                LightPlace::Directional { towards } => *towards = turn * *towards,
                LightPlace::Point { position, cone, .. } => {
                    *position = turn * *position;
                    cone.iter_mut().for_each(|cone| cone.along = turn * cone.along);
                }
            }
        }
    }

    /// Records a picture with the head at `head`; `pose` takes the strands to the world, see `HairSim::pose`.
    pub(crate) fn draw(&mut self, list: &mut PassList, head: Pose, pose: Pose) -> Result<Ticket> {
        let lights = self.draw_scene(list, head, pose)?;
        self.draw_hair(list, pose, &lights)
    }

    /// Records strands between guides, the shadows and what is opaque. Gives the lights with what they see of it.
    pub(crate) fn draw_scene(&mut self, list: &mut PassList, head: Pose, pose: Pose) -> Result<Lights> {
        self.views.record(list);
        let mesh = |mesh| MeshDraw { mesh, surface: Surface::default(), pose: head };
        let meshes: Vec<MeshDraw> = self.meshes.iter().map(mesh).collect();
        let lights = self.light_depth.draw(list, &self.lights, &meshes, head)?;
        let sections = draws(&self.sections, pose, &self.view, self.lod.as_ref());
        interpolate::record(&self.interpolations, list, &sections);
        self.renderer.cast(list, &lights, &sections)?;
        let shadows = self.renderer.shadow_bindings();
        let Self { view, targets, scene, .. } = self;
        let opaque = Scene { backdrop: Backdrop::default(), meshes: &meshes, shadows: &shadows };
        scene.draw(list, view, &lights, targets, &opaque)?;
        Ok(lights)
    }

    /// Records the hair over it.
    pub(crate) fn draw_hair(&mut self, list: &mut PassList, pose: Pose, lights: &Lights) -> Result<Ticket> {
        let Self { view, targets, renderer, .. } = self;
        if let Some(hair) = targets.hair {
            // Pixels without hair keep what they have: no coverage.
            list.raster(RasterPass::new("studio.clear_hair").color(hair, Load::Clear([0.0; 4])));
        }
        if let Some(velocity) = targets.velocity {
            let no_hair = [NO_MOTION, NO_MOTION, 0.0, 0.0];
            list.raster(RasterPass::new("studio.clear_velocity").color(velocity, Load::Clear(no_hair)));
        }
        let sections = draws(&self.sections, pose, view, self.lod.as_ref());
        self.drawn.vertices = sections.iter().map(|section| u64::from(section.vertices())).sum();
        renderer.draw(list, &[ViewDraw::new(view, lights, *targets)], &sections)?;
        Ok(self.renderer.request_counters(list, 0))
    }

    /// Records what the motion of the next frame is measured from.
    pub(crate) fn keep_past(&mut self, list: &mut PassList, pose: Pose) -> Result<()> {
        Ok(self.sections.iter_mut().try_for_each(|(strands, _)| strands.keep_past(list, pose))?)
    }

    /// Records the hair once more, for its colours in other light that nothing shades.
    pub(crate) fn draw_unshaded(&mut self, list: &mut PassList, lights: &Lights, pose: Pose) -> Result<()> {
        let materials = self.sections.iter().map(|(_, material)| material.with(|material| material.self_shadow = 0.0));
        let materials: Vec<Material> = materials.collect();
        let sections = self.sections.iter().zip(&materials);
        let draws: Vec<_> =
            sections.map(|((strands, _), material)| SectionDraw::new(strands, material, pose)).collect();
        Ok(self.renderer.draw(list, &[ViewDraw::new(&self.view, lights, self.targets)], &draws)?)
    }

    /// Reads the counters of the frame that was just drawn and makes room where there was too little. Says whether the
    /// frame would now find more room.
    pub(crate) fn take_stock(&mut self, run: &mut Run, counters: Ticket) -> Result<bool> {
        let counters = Counters::from_bytes(&run.fetch(counters)?);
        let technique = match self.renderer.desc().technique {
            _ if self.renderer.uses_tiles() => "tiles",
            Technique::ShortCut(_) => "shortcut",
            _ => "ppll",
        };
        self.drawn = RenderStats {
            technique,
            fragments: u64::from(counters.fragments),
            dropped: u64::from(counters.dropped),
            merged: u64::from(counters.merged),
            vertices: self.drawn.vertices,
            pixels_with_hair: u64::from(counters.pixels_with_hair),
            ..RenderStats::default()
        };
        let has_more_room = self.renderer.grow_to_measured(&mut *run.backend, &counters)?
            | self.views.make_room(run, &mut self.meshes)?;
        self.drawn.oit_bytes = self.renderer.technique_bytes();
        self.drawn.shadow_bytes = self.renderer.shadow_bytes();
        Ok(has_more_room)
    }

    /// Draws the newest frame once more, and brings the picture.
    pub(crate) fn retake(&mut self, run: &mut Run, args: &cli::Scene) -> Result<Vec<u8>> {
        let mut list = PassList::new();
        let counters = self.draw(&mut list, run.head(args), run.sim.pose())?;
        let picture = list.read_texture(self.targets.color);
        run.submit(&list)?;
        self.take_stock(run, counters)?;
        run.fetch(picture)
    }
}

/// The look of a section, with what was asked for.
fn material(args: &Render, material: Material) -> Material {
    let material = args.look.map_or(material, |look| look.on(material));
    let fibre = match args.scattering {
        None => material.fibre,
        Some(cli::Scattering::Kajiya) => None,
        Some(cli::Scattering::Fibre) => Some(material.fibre.unwrap_or_default()),
    };
    let [base_color, tip_color] = material.colors();
    // A colour that was asked for is seen, whatever the file has.
    let is_asked_for = args.look.is_some() && args.root_texture.is_none() && args.strand_texture.is_none();
    let own_colors = if is_asked_for { 0.0 } else { material.own_colors };
    material.with(|m| {
        (m.fibre, m.base_color, m.tip_color) = (fibre, base_color, tip_color);
        m.own_colors = own_colors;
    })
}

/// The sections with the detail that the view needs; all of it where no `lod` is given.
fn draws<'a>(
    sections: &'a [(ShadedStrands, Material)],
    pose: Pose,
    view: &View,
    lod: Option<&LodDesc>,
) -> Vec<SectionDraw<'a>> {
    let draw = |(strands, material): &'a (ShadedStrands, Material)| {
        let draw = SectionDraw::new(strands, material, pose);
        lod.map_or(draw, |lod| draw.lod(lod.choose(view, &draw)))
    };
    sections.iter().map(draw).collect()
}
