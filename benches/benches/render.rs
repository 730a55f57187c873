//! GPU time of each render pass at 1920x1080, beside the error of the picture.
//!
//! `cargo bench -p tressfx-benches --bench render -- [GROOM[,FOLLOWS]]...`, where `GROOM` is a file, `builtin:NAME...` or
//! `sphere:STRANDS`. Times are from the GPU's timestamps, the median and the least of 100 frames. The error is that of the
//! same view at 480x270 against the picture in f64 with all fragments in order.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use glam::{DVec4, Vec3};
use tressfx_asset::builtin::Builtin;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Backend, Format, Run, TextureDesc};
use tressfx_core::pass::{Load, PassList, RasterPass};
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    Counters, HairRenderer, Light, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets,
    ViewDraw, reference, uniforms,
};

const FRAMES: usize = 100;

/// The first frames grow the pool, and the GPU takes its time to raise its clocks.
const WARM_UP: Duration = Duration::from_secs(1);

type Failure = Box<dyn std::error::Error>;

/// Label and times of each pass, in the order of the frame.
type Times = BTreeMap<usize, (&'static str, Vec<Duration>)>;

fn main() -> Result<(), Failure> {
    // Cargo adds `--bench`.
    let mut grooms: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with("--")).collect();
    if grooms.is_empty() {
        grooms = ["sphere:16384", "builtin:long:16384:32"].map(String::from).to_vec();
        if let Some(assets) = std::env::var_os("TRESSFX_ASSETS") {
            let assets = std::path::PathBuf::from(assets);
            // AMD's sample draws three strands for each of the file.
            grooms.push(format!("{},2", assets.join("tressfx41_ratboy/Ratboy_mohawk.tfx").display()));
        }
    }
    let mut backend = WgpuBackend::headless()?;
    println!("{}", backend.caps().adapter);
    for groom in &grooms {
        bench(&mut backend, groom)?;
    }
    Ok(())
}

fn bench(backend: &mut WgpuBackend, groom: &str) -> Result<(), Failure> {
    let (name, follows) = groom.rsplit_once(',').unwrap_or((groom, "0"));
    let strands =
        Strands::new(&asset(name)?, &StrandOptions { follows: Some(follows.parse()?), ..Default::default() })?;
    let mut uploads = PassList::new();
    let buffers = StrandBuffers::new(backend, StrandShape::of(&strands), Vec3::ZERO)?;
    buffers.upload(&mut uploads, &strands);
    let section = ShadedStrands::new(backend, &mut uploads, buffers, StrandInfo::new(&strands))?;
    backend.run(&uploads)?;
    let mut stage = Stage::new(backend, &strands, [1920, 1080])?;
    let (counters, times) = stage.time(backend, &section)?;
    let small = Stage::new(backend, &strands, [480, 270])?.error(backend, &section, &strands)?;
    println!("\n{groom}: {} strands of {} vertices", strands.strand_count(), strands.vertices);
    println!("  {counters:?}; PSNR {small:.1} dB at 480x270");
    for (label, mut runs) in times.into_values() {
        runs.sort();
        println!("  {label:24} median {:>9.1?} least {:>9.1?}", runs[runs.len() / 2], runs[0]);
    }
    section.destroy(backend);
    [buffers.positions, buffers.tangents, buffers.thickness].into_iter().for_each(|b| backend.destroy(b.into()));
    Ok(())
}

fn asset(name: &str) -> Result<HairAsset, Failure> {
    if let Some(builtin) = name.strip_prefix("builtin:") {
        return Ok(builtin.parse::<Builtin>()?.asset());
    }
    match name.strip_prefix("sphere:") {
        Some(strands) => Ok(sphere(strands.parse()?)),
        None => Ok(tressfx_asset::read(name)?),
    }
}

/// Strands 0.4 units long on a sphere, which hang a little: like the groom on which AMD's shaders were measured.
fn sphere(strands: u32) -> HairAsset {
    let golden = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let strand = |i: u32| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / strands as f32;
        let (sin, cos) = (golden * i as f32).sin_cos();
        let out = Vec3::new(cos, 0.0, sin) * (1.0 - y * y).sqrt() + Vec3::Y * y;
        let point = move |s: f32| out * (0.5 + 0.4 * s - 0.05 * s * s) - Vec3::Y * 0.12 * s * s;
        (0..32).map(move |vertex| point(vertex as f32 / 31.0).to_array())
    };
    HairAsset::new("sphere", AssetFormat::Builtin, (0..strands).flat_map(strand).collect(), vec![32; strands as usize])
}

struct Stage {
    view: View,
    targets: Targets,
    renderer: HairRenderer,
}

impl Stage {
    fn new(backend: &mut WgpuBackend, strands: &Strands, size: [u32; 2]) -> Result<Self, Failure> {
        let points: Vec<Vec3> = strands.rest_of_all().iter().map(|point| point.truncate()).collect();
        let view = Camera::around(&points, size).view(size)?;
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, size, format));
        let targets = Targets::new(texture("color", Format::Rgba16F)?, texture("depth", Format::Depth32F)?);
        let renderer = HairRenderer::new(backend, &RenderDesc::new(size, Format::Rgba16F))?;
        Ok(Self { view, targets, renderer })
    }

    fn record(&mut self, section: &ShadedStrands) -> Result<PassList, Failure> {
        let mut list = PassList::new();
        let clear = RasterPass::new("clear").color(self.targets.color, Load::Clear([0.0; 4]));
        list.raster(clear.depth(self.targets.depth, Load::Clear(self.view.depth().far())));
        let (lights, material) = (lights(), Material::default());
        let view = ViewDraw::new(&self.view, &lights, self.targets);
        self.renderer.draw(&mut list, &[view], &[SectionDraw::new(section, &material, Pose::IDENTITY)])?;
        Ok(list)
    }

    /// What the last frame drew, and how long each pass took.
    fn time(&mut self, backend: &mut WgpuBackend, section: &ShadedStrands) -> Result<(Counters, Times), Failure> {
        let mut times = Times::new();
        let mut counters = Counters::default();
        let (start, mut measured) = (Instant::now(), 0);
        while measured < FRAMES {
            let warm = start.elapsed() > WARM_UP;
            let mut list = self.record(section)?;
            let ticket = self.renderer.request_counters(&mut list, 0);
            backend.run(&list)?;
            counters = Counters::from_bytes(&backend.read(ticket).ready().ok_or("no counters")?);
            self.renderer.grow_to_measured(backend, &counters)?;
            measured += usize::from(warm);
            for (index, timing) in backend.timings().into_iter().enumerate().filter(|_| warm) {
                let runs = &mut times.entry(index).or_insert((timing.label, Vec::new())).1;
                runs.push(Duration::from_nanos(timing.nanoseconds as u64));
            }
        }
        Ok((counters, times))
    }

    /// Peak signal-to-noise ratio of the picture in decibels.
    fn error(mut self, backend: &mut WgpuBackend, section: &ShadedStrands, strands: &Strands) -> Result<f64, Failure> {
        let material = Material::default();
        let draw = SectionDraw::new(section, &material, Pose::IDENTITY);
        self.renderer.grow_to_predicted(backend, &self.view, &[draw])?;
        let mut list = self.record(section)?;
        let ticket = list.read_texture(self.targets.color);
        backend.run(&list)?;
        let bytes = backend.read(ticket).ready().ok_or("no picture")?;
        let channel = |pair: &[u8]| half::f16::from_le_bytes([pair[0], pair[1]]).to_f64();
        let picture = bytes.chunks(8).map(|texel| DVec4::from_array([0, 2, 4, 6].map(|i| channel(&texel[i..]))));
        let exact = exact(&self.view, strands, draw.uniform());
        let squares = picture.zip(&exact).map(|(a, b)| (a - *b).length_squared()).sum::<f64>();
        Ok(-10.0 * (squares / (4 * exact.len()) as f64).log10())
    }
}

fn exact(view: &View, strands: &Strands, uniform: uniforms::SectionUniform) -> Vec<DVec4> {
    let copies = 1 + strands.follows as usize;
    let arrays = |values: Vec<glam::Vec4>| values.into_iter().map(|v| v.to_array()).collect::<Vec<_>>();
    let section = reference::Strands {
        uniform,
        positions: &arrays(strands.interleave(&strands.rest_of_all())),
        tangents: &arrays(strands.interleave(&strands.tangents.repeat(copies))),
        visibility: &StrandInfo::new(strands).visibility,
        thickness: &strands.interleave(&strands.thickness),
    };
    let far = view.depth().far();
    reference::exact(view, &lights(), &[section], &|_| far)
}

/// Light from above on the right, as in a studio.
fn lights() -> Lights {
    Lights {
        sky: Vec3::new(0.22, 0.24, 0.28),
        ground: Vec3::new(0.09, 0.08, 0.07),
        lights: vec![
            Light::directional(Vec3::new(0.75, 0.8, 0.75), Vec3::new(2.3, 2.1, 1.85)),
            Light::directional(Vec3::new(-0.9, 0.25, 0.6), Vec3::new(0.35, 0.42, 0.55)),
            Light::directional(Vec3::new(-0.45, 0.65, -0.9), Vec3::new(1.1, 1.2, 1.4)),
        ],
    }
}
