//! Small grooms, a small screen, and pictures that can be held against their f64 references.

use glam::{DVec4, Vec3, Vec4};
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{DepthOrder, Format, Run, TextureDesc};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Load, PassList, RasterPass};
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{Strands, relative_to};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    Bends, Counters, HAIR_FORMAT, HairRenderer, Lights, Lod, Material, OwnLook, PpllDesc, RenderDesc, SectionDraw,
    ShadedStrands, ShadowDesc, StrandInfo, Targets, Technique, ViewDraw, reference, uniforms::SectionUniform,
};

use crate::scene::{SceneMesh, ScenePass, lights};

/// Strands without follow strands, in the order of the GPU.
#[derive(Clone, Debug)]
pub struct Groom {
    /// Counts.
    pub shape: StrandShape,
    /// Positions.
    pub positions: Vec<[f32; 4]>,
    /// Tangents.
    pub tangents: Vec<[f32; 4]>,
    /// Shares of the full width.
    pub thickness: Vec<f32>,
    /// What rendering asks for beside.
    pub info: StrandInfo,
    /// Its look.
    pub material: Material,
    /// Where it is moved to.
    pub pose: Pose,
    /// What of it is drawn.
    pub lod: Lod,
    /// Colours and widths that it brings along.
    pub own: OwnLook,
}

impl Groom {
    /// A groom of strands of one length each, in metres, of full width everywhere.
    pub fn new(strands: &[Vec<Vec3>], material: Material) -> Self {
        let vertices = strands.first().map_or(2, Vec::len);
        let shape = StrandShape { guides: strands.len() as u32, follows: 0, vertices: vertices as u32 };
        let order = (0..vertices).flat_map(|vertex| strands.iter().map(move |strand| (strand, vertex)));
        let tangent = |strand: &[Vec3], vertex: usize| {
            let (before, after) = (strand[vertex.saturating_sub(1)], strand[(vertex + 1).min(vertices - 1)]);
            (after - before).normalize_or(Vec3::Y)
        };
        let segments = strands.iter().flat_map(|strand| strand.windows(2));
        Self {
            shape,
            positions: order.clone().map(|(strand, vertex)| strand[vertex].extend(1.0).to_array()).collect(),
            tangents: order.clone().map(|(strand, vertex)| tangent(strand, vertex).extend(0.0).to_array()).collect(),
            thickness: order.map(|_| 1.0).collect(),
            info: StrandInfo {
                metres_per_unit: 1.0,
                fitting_radius: 0.000_1,
                sample: segments.map(|ends| ([ends[0], ends[1]], [1.0, 1.0])).collect(),
                bends: Bends::default(),
                reach: (Vec3::ZERO, f32::INFINITY),
            },
            material,
            pose: Pose::IDENTITY,
            lod: Lod::FULL,
            own: OwnLook::default(),
        }
    }

    /// Strands about the middle of them, with what they bring along.
    pub fn of(strands: &Strands, material: Material) -> Self {
        let center = strands.bounds.rounded_center();
        let copies = 1 + strands.follows as usize;
        let arrays = |values: Vec<Vec4>| values.into_iter().map(|value| value.to_array()).collect();
        let mut info = StrandInfo::new(strands);
        info.sample.iter_mut().flat_map(|(ends, _)| ends).for_each(|end| *end -= center);
        let own = OwnLook::of(strands);
        let taper = strands.interleave(&strands.thickness);
        Self {
            shape: StrandShape::of(strands),
            positions: arrays(strands.interleave(&relative_to(center, &strands.rest_of_all()))),
            tangents: arrays(strands.interleave(&strands.tangents.repeat(copies))),
            thickness: own.thickness(material.tip_width).unwrap_or(taper),
            info,
            material,
            pose: Pose::IDENTITY,
            lod: Lod::FULL,
            own,
        }
    }

    /// Wavy strands that hang from a disc, tapered, the same for the same seed.
    pub fn wavy(strands: u32, vertices: u32, seed: u32, material: Material) -> Self {
        let mut random = Random(seed);
        let mut strand = |_| {
            let root = Vec3::new(random.unit() - 0.5, 0.6, random.unit() - 0.5);
            let (phase, swing) = (random.unit() * 6.3, 0.05 + 0.1 * random.unit());
            let point = |i: u32| {
                let s = i as f32 / (vertices - 1) as f32;
                root + Vec3::new((phase + 7.0 * s).sin() * swing, -1.2 * s, (phase + 5.0 * s).cos() * swing)
            };
            (0..vertices).map(point).collect()
        };
        let mut groom = Self::new(&(0..strands).map(&mut strand).collect::<Vec<_>>(), material);
        let taper = |i: usize| (1.0 - (i as u32 / strands) as f32 / (vertices - 1) as f32).sqrt();
        (0..groom.thickness.len()).for_each(|i| groom.thickness[i] = taper(i));
        groom
    }

    fn uniform(&self) -> SectionUniform {
        let uniform = SectionUniform::new(self.shape, &self.info, &self.material, &self.pose, &self.lod);
        let has_widths = self.own.thickness(1.0).is_some();
        uniform.with_own_look(&self.material, self.own.has_color(), has_widths)
    }

    /// As the references take it.
    pub fn reference(&self) -> reference::Strands<'_> {
        reference::Strands {
            uniform: self.uniform(),
            positions: &self.positions,
            tangents: &self.tangents,
            arriving: None,
            fibre: None,
            own_colors: self.own.colors(),
            thickness: &self.thickness,
        }
    }
}

/// Numbers in [0, 1) that are the same everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Random(pub u32);

impl Random {
    /// The next one (Marsaglia's xorshift over a Weyl sequence).
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        let mut x = self.0 ^ (self.0 >> 15);
        x = x.wrapping_mul(0x85eb_ca6b);
        x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
        ((x ^ (x >> 16)) >> 8) as f32 / (1 << 24) as f32
    }
}

/// A picture that came back.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// The texels as they were read back.
    pub bytes: Vec<u8>,
    /// What was counted.
    pub counters: Counters,
    /// Depth and coverage of the hair, where they were drawn; [`NO_HAIR`] elsewhere.
    pub hair: Vec<[f32; 2]>,
}

/// What pixels without hair are cleared to: neither a depth nor a coverage.
pub const NO_HAIR: [f32; 2] = [-7.0, -9.0];

impl Picture {
    /// The texels, row by row.
    pub fn pixels(&self) -> Vec<DVec4> {
        let channel = |pair: &[u8]| half::f16::from_le_bytes([pair[0], pair[1]]).to_f64();
        let texel = |bytes: &[u8]| DVec4::from_array([0, 2, 4, 6].map(|i| channel(&bytes[i..])));
        self.bytes.chunks(8).map(texel).collect()
    }

    /// How far it is from a reference.
    pub fn difference(&self, reference: &[DVec4]) -> Difference {
        Difference::between(&self.pixels(), reference)
    }
}

/// How far two pictures are apart, over the four channels of all pixels.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// The largest difference of a channel.
    pub max: f64,
    /// Peak signal-to-noise ratio in decibels, for a peak of 1.
    pub psnr: f64,
}

impl Difference {
    /// Between two pictures of one size.
    pub fn between(a: &[DVec4], b: &[DVec4]) -> Self {
        assert_eq!(a.len(), b.len());
        let differences = || a.iter().zip(b).map(|(a, b)| (*a - *b).abs());
        let square = differences().map(|d| d.length_squared()).sum::<f64>() / (4 * a.len()) as f64;
        Self { max: differences().map(DVec4::max_element).fold(0.0, f64::max), psnr: -10.0 * square.log10() }
    }
}

/// How a screen is made.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// The camera.
    pub camera: Camera,
    /// Pixels.
    pub size: [u32; 2],
    /// The technique.
    pub technique: Technique,
    /// Whether a compute pass lays hair over the picture.
    pub storage_target: bool,
    /// Whether depth and coverage of the hair are drawn too.
    pub hair_output: bool,
    /// Whether grooms may bring colours of their own along.
    pub own_colors: bool,
    /// Whether strands may have copies.
    pub copies: bool,
    /// How shadows are made.
    pub shadows: Option<ShadowDesc>,
}

impl Setup {
    /// The lists of fragments that are the technique.
    ///
    /// # Panics
    /// If the technique has been changed to another.
    pub fn ppll(&mut self) -> &mut PpllDesc {
        match &mut self.technique {
            Technique::Ppll(desc) => desc,
            other => panic!("the technique is {other:?}"),
        }
    }
}

impl Default for Setup {
    /// 96 x 64 pixels that look along -z at the origin from a distance of 3, without shadows.
    fn default() -> Self {
        let camera = Camera {
            eye: Vec3::new(0.0, 0.0, 3.0),
            target: Vec3::ZERO,
            fov: 0.6,
            near: 0.05,
            far: 50.0,
            depth: DepthOrder::Reverse,
        };
        let technique = Technique::default();
        Self {
            camera,
            size: [96, 64],
            technique,
            storage_target: false,
            hair_output: false,
            own_colors: false,
            copies: false,
            shadows: None,
        }
    }
}

fn renderer(backend: &mut dyn Run, setup: &Setup) -> HairRenderer {
    let desc = RenderDesc::new(setup.size, Format::Rgba16F).technique(setup.technique);
    let desc = desc.storage_target(setup.storage_target).hair_output(setup.hair_output);
    let desc = desc.own_colors(setup.own_colors).copies(setup.copies).shadows(setup.shadows);
    HairRenderer::new(backend, &desc).expect("a renderer")
}

/// A picture and its depth.
fn targets(backend: &mut dyn Run, size: [u32; 2]) -> [TextureId; 2] {
    [("test.color", Format::Rgba16F), ("test.depth", Format::Depth32F)].map(|(label, format)| {
        let desc = TextureDesc::new(label, size, format);
        let desc = if format.is_storage() { desc.storage() } else { desc };
        backend.create_texture(&desc).expect("a texture")
    })
}

/// Light in which hair that nothing shades is about as bright as hair in its own shadow.
fn dimmed(mut lights: Lights) -> Lights {
    const SHARE: f32 = 0.65;
    lights.sky *= SHARE;
    lights.ground *= SHARE;
    lights.lights.iter_mut().for_each(|light| light.color *= SHARE);
    lights
}

/// A screen to draw on.
pub struct Screen {
    /// The GPU.
    pub backend: Box<dyn Run>,
    /// Where the picture is taken from.
    pub view: View,
    /// The light.
    pub lights: Lights,
    /// What is under test.
    pub renderer: HairRenderer,
    /// Whether the pool of fragments may grow to what is predicted.
    pub may_grow: bool,
    /// How often each list runs.
    pub runs: u32,
    /// Renderers of other techniques: their pipelines take long to compile.
    kept: Vec<HairRenderer>,
    /// What draws meshes, by the order of depth.
    scenes: Vec<(DepthOrder, ScenePass)>,
    color: TextureId,
    depth: TextureId,
    hair: Option<TextureId>,
}

impl Screen {
    /// A screen as [`Setup`] makes it by default, unless `change` says otherwise.
    ///
    /// # Panics
    /// If the backend refuses what it asks for.
    pub fn new(mut backend: Box<dyn Run>, change: impl FnOnce(&mut Setup)) -> Self {
        let mut setup = Setup::default();
        change(&mut setup);
        let Setup { camera, size, .. } = setup;
        let renderer = renderer(&mut *backend, &setup);
        let [color, depth] = targets(&mut *backend, size);
        let hair = TextureDesc::new("test.hair", size, HAIR_FORMAT);
        let hair = setup.hair_output.then(|| backend.create_texture(&hair).expect("a texture"));
        let view = camera.view(size).expect("a view");
        let (kept, scenes) = (Vec::new(), Vec::new());
        let lights = dimmed(lights());
        Self { backend, view, lights, renderer, may_grow: true, runs: 1, kept, scenes, color, depth, hair }
    }

    /// Another camera, size or technique on the same device. What was compiled is kept; pools begin anew.
    ///
    /// # Panics
    /// If the backend refuses what it asks for, or if depth and coverage of hair are drawn.
    pub fn turn_to(&mut self, setup: &Setup) {
        assert!(self.hair.is_none() && !setup.hair_output, "depth and coverage of hair need a screen of their own");
        let &Setup { camera, size, technique, .. } = setup;
        let backend = &mut *self.backend;
        if self.view.viewport().target() != size {
            [self.color, self.depth].into_iter().for_each(|texture| backend.destroy(texture.into()));
            [self.color, self.depth] = targets(backend, size);
        }
        self.view = camera.view(size).expect("a view");
        // A renderer says itself which techniques it can change to.
        if self.renderer.retune(backend, technique).is_err() {
            let fits = self.kept.iter_mut().position(|kept| kept.retune(backend, technique).is_ok());
            let other = match fits {
                Some(index) => self.kept.swap_remove(index),
                None => renderer(backend, setup),
            };
            self.kept.push(std::mem::replace(&mut self.renderer, other));
        }
        self.renderer.resize(backend, size).expect("a size");
    }

    /// What is drawn to.
    pub fn targets(&self) -> Targets {
        let targets = Targets::new(self.color, self.depth);
        self.hair.map_or(targets, |hair| targets.hair(hair))
    }

    /// The picture in f64, with all fragments in order and nothing behind them.
    pub fn exact(&self, grooms: &[&Groom]) -> Vec<DVec4> {
        let far = self.view.depth().far();
        let strands: Vec<_> = grooms.iter().map(|groom| groom.reference()).collect();
        reference::exact(&self.view, &self.lights, &strands, &|_| far)
    }

    /// Uploads a groom with the next run of `list`.
    pub fn section(&mut self, list: &mut PassList, groom: &Groom) -> ShadedStrands {
        self.placed(list, groom).1
    }

    fn placed(&mut self, list: &mut PassList, groom: &Groom) -> (StrandBuffers, ShadedStrands) {
        let buffers = StrandBuffers::new(&mut *self.backend, groom.shape, Vec3::ZERO).expect("buffers");
        list.upload(buffers.positions, 0, &groom.positions);
        list.upload(buffers.tangents, 0, &groom.tangents);
        list.upload(buffers.thickness, 0, &groom.thickness);
        let section = ShadedStrands::new(&mut *self.backend, buffers, groom.info.clone()).expect("a section");
        let section = section.with_own_look(&mut *self.backend, list, &groom.own).expect("buffers");
        (buffers, section)
    }

    /// Hair over nothing.
    pub fn hair(&mut self, grooms: &[&Groom]) -> Picture {
        let view = self.view;
        self.views(&[view], grooms)
    }

    /// Hair over nothing, from several views into parts of one target.
    pub fn views(&mut self, views: &[View], grooms: &[&Groom]) -> Picture {
        let mut list = PassList::new();
        let pass = RasterPass::new("test.clear").color(self.color, Load::Clear([0.0; 4]));
        list.raster(pass.depth(self.depth, Load::Clear(self.view.depth().far())));
        self.over(list, views, grooms)
    }

    /// Hair and meshes.
    pub fn scene(&mut self, meshes: &[&Mesh], grooms: &[&Groom]) -> Picture {
        let (mut list, targets, view) = (PassList::new(), self.targets(), self.view);
        let order = view.depth();
        if !self.scenes.iter().any(|(of, _)| *of == order) {
            let pass = ScenePass::new(&mut *self.backend, Format::Rgba16F, order).expect("a scene pass");
            self.scenes.push((order, pass));
        }
        let made: Vec<_> =
            meshes.iter().map(|mesh| SceneMesh::new(&mut *self.backend, &mut list, mesh).expect("a mesh")).collect();
        let (_, pass) = self.scenes.iter().find(|(of, _)| *of == order).expect("it has just been made");
        pass.draw(&mut list, &view, glam::Mat4::IDENTITY, &targets, &made);
        let picture = self.over(list, &[view], grooms);
        made.into_iter().for_each(|mesh| mesh.destroy(&mut *self.backend));
        picture
    }

    /// Bytes that the backend holds.
    pub fn backend_memory(&self) -> u64 {
        self.backend.memory().bytes
    }

    /// The depth of the last scene.
    pub fn depth(&mut self) -> Vec<f32> {
        let mut list = PassList::new();
        let ticket = list.read_texture(self.depth);
        bytemuck::pod_collect_to_vec(&crate::run_and_read(&mut *self.backend, &list, ticket))
    }

    /// The depth of meshes from a view: the texture, and what is in it.
    pub fn depth_from(&mut self, view: &View, meshes: &[&Mesh]) -> (TextureId, Vec<f32>) {
        let [color, depth] = targets(&mut *self.backend, view.viewport().target());
        let pass = ScenePass::new(&mut *self.backend, Format::Rgba16F, view.depth()).expect("a scene pass");
        let mut list = PassList::new();
        let made: Vec<_> =
            meshes.iter().map(|mesh| SceneMesh::new(&mut *self.backend, &mut list, mesh).expect("a mesh")).collect();
        pass.draw(&mut list, view, glam::Mat4::IDENTITY, &Targets::new(color, depth), &made);
        let ticket = list.read_texture(depth);
        let bytes = crate::run_and_read(&mut *self.backend, &list, ticket);
        made.into_iter().for_each(|mesh| mesh.destroy(&mut *self.backend));
        (depth, bytemuck::pod_collect_to_vec(&bytes))
    }

    fn over(&mut self, mut list: PassList, views: &[View], grooms: &[&Groom]) -> Picture {
        let sections: Vec<_> = grooms.iter().map(|groom| self.placed(&mut list, groom)).collect();
        let pairs = sections.iter().zip(grooms);
        let draws: Vec<_> = pairs
            .map(|((_, strands), groom)| SectionDraw::new(strands, &groom.material, groom.pose).lod(groom.lod))
            .collect();
        if self.may_grow {
            views
                .iter()
                .for_each(|view| self.renderer.grow_to_predicted(&mut *self.backend, view, &draws).expect("a pool"));
        }
        let targets = self.targets();
        let hair = self.hair;
        hair.into_iter().for_each(|hair| clear_hair(&mut list, hair));
        let drawn: Vec<_> = views.iter().map(|view| ViewDraw::new(view, &self.lights, targets)).collect();
        self.renderer.draw(&mut list, &drawn, &draws).expect("views that can be drawn");
        let counters = self.renderer.request_counters(&mut list, 0);
        let picture = list.read_texture(self.color);
        for _ in 1..self.runs {
            self.backend.run(&list).expect("the list runs");
        }
        let bytes = crate::run_and_read(&mut *self.backend, &list, picture);
        let counters = Counters::from_bytes(&self.backend.read(counters).ready().expect("it has run"));
        for (buffers, section) in sections {
            section.destroy(&mut *self.backend);
            buffers.destroy(&mut *self.backend);
        }
        let hair = hair.map_or_else(Vec::new, |hair| {
            let mut list = PassList::new();
            let ticket = list.read_texture(hair);
            bytemuck::pod_collect_to_vec(&crate::run_and_read(&mut *self.backend, &list, ticket))
        });
        Picture { size: self.view.size(), bytes, counters, hair }
    }
}

/// Writes [`NO_HAIR`] to every pixel.
fn clear_hair(list: &mut PassList, hair: TextureId) {
    let [depth, coverage] = NO_HAIR;
    list.raster(RasterPass::new("test.clear_hair").color(hair, Load::Clear([depth, coverage, 0.0, 0.0])));
}
