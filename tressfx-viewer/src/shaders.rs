//! `tressfx shaders`: the kernels in the language of an engine, and what they bind.

use std::collections::BTreeMap;
use std::fs;
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use glam::Vec3;
use serde::Serialize;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Caps, Format};
use tressfx_core::body::{Influences, Morph, MorphOffset, SkinnedMesh};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::shader::{
    Emitted, EntryPoint, Extra, Language, Shader, ShaderSlot, ShaderStage, Stages, StructLayout,
};
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_render::{HairRenderer, OwnLook, RenderDesc};
use tressfx_sim::body::{BoneRoots, Skinning, TriangleRoots};
use tressfx_sim::field::{FieldDesc, FieldSurface, Fields};
use tressfx_sim::{HairSim, Interpolation, InterpolationParams, SectionDesc, SimParams, SleepParams};

use crate::cli;
use crate::groom::Groom;
use crate::oit::CompositeName;
use crate::params::Params;
use crate::say::say;

/// An entry point in `bindings.json`.
#[derive(Serialize)]
struct DescribedEntryPoint<'a> {
    label: &'a str,
    stage: &'static str,
    /// In the WGSL.
    entry_point: &'a str,
    /// Threads of a group; of compute.
    workgroup_size: Option<[u32; 3]>,
    features: BTreeMap<&'a str, bool>,
    constants: BTreeMap<&'a str, u32>,
    bindings: Vec<Binding<'a>>,
    structs: Vec<StructLayout>,
    /// By the name of the language.
    languages: BTreeMap<&'static str, Written>,
}

#[derive(Serialize)]
struct Binding<'a> {
    name: &'a str,
    binding: u32,
    kind: String,
    #[serde(rename = "type")]
    type_name: &'a str,
    min_bytes: u64,
    /// All stages of the pipeline that see it.
    stages: Vec<&'static str>,
    /// In the words of each language.
    places: BTreeMap<&'static str, String>,
}

/// A file that was written.
#[derive(Serialize)]
struct Written {
    file: String,
    entry_point: String,
    /// What has to be bound beside the bindings: a constant buffer of `u32`.
    #[serde(skip_serializing_if = "Option::is_none")]
    extra: Option<ExtraBuffer>,
}

#[derive(Serialize)]
struct ExtraBuffer {
    name: &'static str,
    place: &'static str,
    holds: Vec<String>,
}

const STAGES: [ShaderStage; 3] = [ShaderStage::Compute, ShaderStage::Vertex, ShaderStage::Fragment];

/// The stage, as files and compilers of shaders call it.
fn suffix(stage: ShaderStage) -> &'static str {
    match stage {
        ShaderStage::Compute => "comp",
        ShaderStage::Vertex => "vert",
        ShaderStage::Fragment => "frag",
    }
}

/// Writes a file for each entry point and language, and `bindings.json`.
pub(crate) fn run(args: &cli::Shaders) -> Result<()> {
    let all = shaders(args)?;
    let named = |shader: &&Arc<Shader>| args.kernel.as_deref().is_none_or(|label| label == shader.label);
    let chosen: Vec<_> = all.iter().filter(named).collect();
    if let (true, Some(label)) = (chosen.is_empty(), &args.kernel) {
        let labels: std::collections::BTreeSet<_> = all.iter().map(|shader| shader.label).collect();
        let labels = labels.into_iter().collect::<Vec<_>>().join(", ");
        bail!("no kernel of this groom is named `{label}`; there are {labels}");
    }
    fs::create_dir_all(&args.out).with_context(|| args.out.display().to_string())?;
    let mut entries = Vec::new();
    for shader in chosen {
        let name = file_name(shader, &all);
        for found in &shader.entry_points {
            let suffix = suffix(found.stage);
            let mut entry = DescribedEntryPoint::new(shader, found);
            for language in args.languages() {
                let emitted = shader.emit(found.stage, language)?;
                let written = write(args, format!("{name}.{suffix}.{}", language.ending()), emitted)?;
                entry.languages.insert(language.name(), written);
            }
            entries.push(entry);
        }
    }
    let path = args.out.join("bindings.json");
    fs::write(&path, serde_json::to_string_pretty(&entries)? + "\n").with_context(|| path.display().to_string())?;
    say(format_args!("{} entry points, described in {}", entries.len(), path.display()))?;
    Ok(())
}

/// The kernels that simulating and rendering the groom compiles; with capsules, in wind, with roots that ride on the
/// head and with roots of their own.
fn shaders(args: &cli::Shaders) -> Result<Vec<Arc<Shader>>> {
    let groom = Groom::load(std::slice::from_ref(&args.groom), args.follow)?;
    let params = Params::read(args.params.as_deref(), 1)?;
    let mut caps = Caps::webgpu_default();
    // What a device can hold does not matter where nothing runs, unless it is asked what it would run.
    if !args.for_least_limits {
        (caps.max_storage_binding_bytes, caps.max_buffer_bytes) = (u64::MAX, u64::MAX);
    }
    (caps.read_write_textures, caps.is_cpu) = (true, args.for_cpu);
    let mut backend = NullBackend::new(caps);
    let (volume, copies) = (params.volume.clone(), params.material(0).copies > 1);
    // What strands want at rest takes time and changes no kernel.
    let params = SimParams { sag_free: 0.0, ..params.sim(0).clone() };
    let section = SectionDesc::new(&groom.sections[0], params).with_solver(args.solver.solver());
    let sections = [section.clone(), section.with_own_roots()];
    let mut list = PassList::new();
    let fields = if args.fields { Some(fields(&mut backend, &mut list)?) } else { None };
    let mut sim = match (&volume, &fields) {
        (Some(volume), _) => HairSim::with_volume(&mut backend, &mut list, &sections, 1, fields.as_ref(), volume)?,
        (None, None) => HairSim::new(&mut backend, &mut list, &sections, 1)?,
        (None, Some(fields)) => HairSim::with_fields(&mut backend, &mut list, &sections, 1, fields)?,
    };
    sim.allow_sleep(&mut backend, SleepParams::default())?;
    body(&mut backend, &sim, &groom.sections[0])?;
    interpolations(&mut backend)?;
    let technique = args.oit.technique()?;
    let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(technique);
    let desc = desc.hair_output(args.hair_output).storage_target(args.oit.composite == Some(CompositeName::Compute));
    let own_colors = OwnLook::of(&groom.sections[0]).colors().is_some();
    let desc = desc.velocity_output(true).own_colors(own_colors || args.own_colors).copies(copies);
    HairRenderer::new(&mut backend, &desc)?;
    Ok(backend.shaders)
}

/// A field of a mesh that is closed, whose surface is looked at, and one of a mesh that is not.
fn fields(backend: &mut NullBackend, list: &mut PassList) -> Result<Fields> {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let [closed, open] = [&faces[..], &faces[3..]].map(|faces| FieldDesc::new(&corners, faces));
    let fields = Fields::new(backend, list, &[closed, open])?;
    FieldSurface::new(backend, &fields, 0)?;
    Ok(fields)
}

/// The kernels of a body that the second section grows on, with morph targets and without.
fn body(backend: &mut NullBackend, sim: &HairSim, strands: &Strands) -> Result<()> {
    let mut list = PassList::new();
    let joint = SkinnedMesh {
        name: "body".into(),
        positions: vec![glam::Vec3::ZERO, glam::Vec3::Z, glam::Vec3::X],
        normals: vec![glam::Vec3::Y; 3],
        triangles: vec![[0, 1, 2]],
        joints: vec!["root".into()],
        influences: vec![Influences::rigid(0); 3],
        ..SkinnedMesh::default()
    };
    let offsets = vec![MorphOffset { vertex: 0, position: glam::Vec3::Y, normal: glam::Vec3::ZERO }];
    let morphs = vec![Morph { name: "morph".into(), offsets }];
    let mesh = SkinnedMesh { morphs, tangents: vec![glam::Vec4::X; 3], ..joint.clone() };
    Skinning::new(backend, &mut list, &joint, false)?;
    let skinning = Skinning::new(backend, &mut list, &mesh, false)?;
    let binding = tressfx_sim::body::Binding::of_guides(strands, &mesh, f64::INFINITY)?;
    TriangleRoots::new(backend, &mut list, sim, 1, &binding, skinning.mesh_vertices())?;
    let of = vec![Influences::rigid(0); strands.order.len()];
    BoneRoots::new(backend, &mut list, (sim, 1), strands, &of, skinning.palette())?;
    Ok(())
}

/// The kernels of strands between guides: a mean of them, and all that there is.
fn interpolations(backend: &mut NullBackend) -> Result<()> {
    let points = [Vec3::ZERO, Vec3::X, Vec3::Z].iter().flat_map(|&root| [root, root + Vec3::Y].map(Vec3::into));
    let asset = HairAsset::new("guides", AssetFormat::Builtin, points.collect(), vec![2; 3]);
    let guides = Strands::new(&asset, &StrandOptions::default())?;
    let buffers = StrandBuffers::new(backend, StrandShape::of(&guides), Vec3::ZERO)?;
    let all = InterpolationParams { clump: 0.5, noise: 0.1, shorter: 0.2, ..InterpolationParams::default() };
    for params in [InterpolationParams::default(), all] {
        Interpolation::new(backend, &mut PassList::new(), (&buffers, &guides), 1, &params)?;
    }
    Ok(())
}

/// The label, and where several kernels have it, the features that are on, and the constants in which they differ.
fn file_name(shader: &Shader, all: &[Arc<Shader>]) -> String {
    let mut name = shader.label.to_owned();
    let others: Vec<_> = all.iter().filter(|other| other.label == shader.label).collect();
    if others.len() > 1 {
        for (feature, _) in shader.specialization.features().iter().filter(|(_, on)| *on) {
            name = format!("{name}.{feature}");
        }
    }
    for constant in shader.specialization.constants() {
        if others.iter().any(|other| !other.specialization.constants().contains(constant)) {
            name = format!("{name}.{}_{}", constant.0.to_lowercase(), constant.1);
        }
    }
    name
}

fn write(args: &cli::Shaders, file: String, Emitted { code, entry_point, extra }: Emitted) -> Result<Written> {
    let path = args.out.join(&file);
    fs::write(&path, code).with_context(|| path.display().to_string())?;
    let extra = extra.map(|Extra { name, place, holds }| ExtraBuffer { name, place, holds });
    Ok(Written { file, entry_point, extra })
}

impl<'a> DescribedEntryPoint<'a> {
    fn new(shader: &'a Shader, entry: &'a EntryPoint) -> Self {
        Self {
            label: shader.label,
            stage: suffix(entry.stage),
            entry_point: &entry.name,
            workgroup_size: entry.workgroup_size,
            features: shader.specialization.features().iter().copied().collect(),
            constants: shader.specialization.constants().iter().copied().collect(),
            bindings: shader.slots_of(entry.stage).map(Binding::new).collect(),
            structs: shader.structs(),
            languages: BTreeMap::new(),
        }
    }
}

impl<'a> Binding<'a> {
    fn new(slot: &'a ShaderSlot) -> Self {
        let stages = STAGES.into_iter().filter(|&stage| slot.stages.intersects(Stages::from(stage)));
        Self {
            name: &slot.name,
            binding: slot.binding,
            kind: slot.kind.to_string(),
            type_name: &slot.type_name,
            min_bytes: slot.min_bytes,
            stages: stages.map(suffix).collect(),
            places: Language::ALL.iter().map(|language| (language.name(), language.place(slot))).collect(),
        }
    }
}
