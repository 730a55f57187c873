//! What can be typed.

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::Vec3;
use tressfx_core::shader::Language;
use tressfx_render::Look;
use tressfx_sim::{Preset, Solver};

use crate::bind::Bind;
use crate::body::BodyArgs;
use crate::camera::Camera;
use crate::collide::Collision;
use crate::develop::Develop;
use crate::field_view::Show;
use crate::grow::Grow;
use crate::lod::Lod;
use crate::oit::Oit;
use crate::shadows::Shadows;

/// Hair and fur, simulated and rendered strand by strand on the GPU.
#[derive(Debug, Parser)]
#[command(name = "tressfx", version)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Say what is in groom files
    Info(Info),
    /// Simulate a groom and render it
    Render(Box<Render>),
    /// Simulate a groom and write its pose as a 4.x .tfx file
    Simulate(Simulate),
    /// Say how far the roots of a groom are from the skin of a body, to which they would be bound
    Bind(Bind),
    /// Grow hair on a body, evenly by area, and write it as a 4.x .tfx file
    Grow(Grow),
    /// Convert a groom file; the ending of OUT chooses the format (.tfx: 4.x binary, .txt: 2013 text)
    Convert(Convert),
    /// Say how far two pictures differ: FLIP, PSNR, largest step, share of pixels
    Compare(Compare),
    /// Write the kernels that simulate and render a groom in the language of an engine, with a list of their bindings
    ///
    /// Kernels are specialised on the counts of a groom, on its parameters and on what it needs, which is why they are
    /// written for one groom. Each entry point has a file, LABEL.STAGE.ENDING, and an object in DIR/bindings.json: what
    /// it was specialised on, its bindings and where they lie in each language, and the structs in them.
    Shaders(Shaders),
    /// List the graphics adapters of this machine
    Adapters,
}

#[derive(Debug, Args)]
pub(crate) struct Info {
    /// Grooms, characters (.glb, .gltf), .tfxmesh, .tfxbone, .tfxskin, .pc2; or `builtin:NAME[:STRANDS[:VERTICES]]`
    #[arg(required = true, value_name = "FILE")]
    pub(crate) grooms: Vec<String>,
    /// Write JSON: an array with one object a file
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// The file to read, of any format, or `builtin:NAME[:STRANDS[:VERTICES]]`
    pub(crate) input: String,
    /// The file to write
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// A .png of 8 or 16 bits a channel
    #[arg(value_name = "A.png")]
    pub(crate) a: PathBuf,
    /// Another, of the same size
    #[arg(value_name = "B.png")]
    pub(crate) b: PathBuf,
    /// Write JSON: an object with flip_mean, psnr_db (null for equal pictures), max_difference and differing_share
    #[arg(long)]
    pub(crate) json: bool,
    /// Where to write a picture of FLIP at every pixel
    #[arg(long, value_name = "FILE.png", value_parser = png)]
    pub(crate) heat_map: Option<PathBuf>,
}

/// What `render` and `simulate` share.
#[derive(Clone, Debug, Args)]
pub(crate) struct Scene {
    /// Files, or `builtin:NAME[:STRANDS[:VERTICES]]`; several become the sections of one groom
    #[arg(required = true, value_name = "GROOM")]
    pub(crate) grooms: Vec<String>,
    /// Frames to simulate; 0 is the rest pose
    #[arg(long, default_value_t = 120)]
    pub(crate) frames: u32,
    /// Frames a second
    #[arg(long, default_value_t = 60.0, value_parser = fps)]
    pub(crate) fps: f64,
    /// Wind in metres a second
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub(crate) wind: Option<Vec3>,
    /// How the head moves
    #[arg(long, value_enum, default_value_t = Motion::Still)]
    pub(crate) motion: Motion,
    #[command(flatten)]
    pub(crate) body: BodyArgs,
    /// Parameters of simulation and look
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) params: Option<PathBuf>,
    /// Hair keeps its volume and rubs against hair: as the table `volume` of the parameters says, which asks for it too, or by default
    #[arg(long)]
    pub(crate) volume: bool,
    /// The material of the hair, for the solver `direct`; it replaces what the parameters say
    #[arg(long, value_name = "NAME", value_parser = presets())]
    pub(crate) preset: Option<Preset>,
    /// A `local_stiffness` that a groom was made with for TressFX, as the bending length that is as stiff; it replaces what the parameters say
    #[arg(long, value_name = "0..1", value_parser = share, conflicts_with = "preset")]
    pub(crate) local_stiffness: Option<f32>,
    #[command(flatten)]
    pub(crate) collision: Collision,
    /// Follow strands of each guide; without it, what the file says, or more where a file has few strands
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=256))]
    pub(crate) follow: Option<u32>,
    /// What solves the equations of motion; without it, rods (`direct`), and `tressfx` where the device has no room for rods
    #[arg(long, value_enum)]
    pub(crate) solver: Option<SolverName>,
    /// The backend that runs the passes
    #[arg(long, value_enum, default_value_t = BackendName::Wgpu)]
    pub(crate) backend: BackendName,
    /// A part of the name of the adapter to use
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
    /// Write figures about the run as JSON
    #[arg(long, value_name = "FILE.json")]
    pub(crate) stats: Option<PathBuf>,
    /// Print the passes of a frame as a table
    #[arg(long)]
    pub(crate) print_passes: bool,
    /// Print what each pass costs as a table; every frame is drawn
    #[arg(long)]
    pub(crate) profile: bool,
    /// Write when what ran, for chrome://tracing and Perfetto; every frame is drawn
    #[arg(long, value_name = "FILE.json")]
    pub(crate) trace: Option<PathBuf>,
    /// Let the Vulkan validation layer watch: what it says is an error
    #[arg(long)]
    pub(crate) validate: bool,
    /// Keep compiled pipelines of raw Vulkan in this file
    #[arg(long, value_name = "FILE")]
    pub(crate) pipeline_cache: Option<PathBuf>,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Render {
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// A .png of the last frame, a .gif or .apng of all, or a folder (ending in /) with every frame
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Draw so many strands between the guides, made each frame, in the place of those that follow them
    #[arg(long, value_name = "N", conflicts_with = "follow", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub(crate) interpolate: Option<u32>,
    /// The first frame that is written where every frame is, from 0; those before it are simulated alone
    #[arg(long, default_value_t = 0, value_name = "FRAME")]
    pub(crate) from: u32,
    /// Width and height in pixels
    #[arg(long, default_value = "1280x720", value_name = "WxH", value_parser = size)]
    pub(crate) size: [u32; 2],
    /// `auto`, or EYE,TARGET,FOV: seven numbers, the last in degrees
    #[arg(long, default_value = "auto", value_parser = Camera::parse, allow_hyphen_values = true)]
    pub(crate) camera: Camera,
    #[command(flatten)]
    pub(crate) oit: Oit,
    #[command(flatten)]
    pub(crate) shadows: Shadows,
    #[command(flatten)]
    pub(crate) lod: Lod,
    #[command(flatten)]
    pub(crate) develop: Develop,
    /// The colour of the hair, with fibres that scatter light as glass; it replaces what the parameters say
    #[arg(long, value_name = "NAME", value_parser = looks())]
    pub(crate) look: Option<Look>,
    /// How fibres scatter light, with the colours that the hair has; without it, as the look and the parameters say
    #[arg(long, value_enum)]
    pub(crate) scattering: Option<Scattering>,
    /// A picture over the roots, by their texture coordinates, in the place of the colours of the hair
    #[arg(long, value_name = "FILE.png|jpg")]
    pub(crate) root_texture: Option<PathBuf>,
    /// A picture along the strands, from the root at its left to the tip; each guide takes one of its rows by chance
    #[arg(long, value_name = "FILE.png|jpg")]
    pub(crate) strand_texture: Option<PathBuf>,
    /// Degrees by which the lights turn about the vertical axis from frame to frame
    #[arg(long, value_name = "DEGREES", default_value = "0", allow_negative_numbers = true)]
    pub(crate) light_turn: f32,
    /// Write the depth of the hair in the last frame as 16-bit gray, the nearest white; what that stands for is printed
    #[arg(long, value_name = "FILE.png", value_parser = png, conflicts_with = "reference")]
    pub(crate) depth_out: Option<PathBuf>,
    /// Write how much of each pixel hair covers in the last frame, `1 - transmittance`, as 16-bit gray
    #[arg(long, value_name = "FILE.png", value_parser = png, conflicts_with = "reference")]
    pub(crate) coverage_out: Option<PathBuf>,
    /// Write how far the hair of the last frame has moved on the screen since the frame before: to the right as red and down as green, around a
    /// middle gray; what the largest motion is is printed
    #[arg(long, value_name = "FILE.png", value_parser = png, conflicts_with = "reference")]
    pub(crate) velocity_out: Option<PathBuf>,
    /// Write the linear light of the last frame too, before exposure and tone mapping
    #[arg(long, value_name = "FILE.exr", value_parser = exr)]
    pub(crate) linear_out: Option<PathBuf>,
    /// Write the last frame with 16 bits a channel too: to compare it with others without the rounding to 8
    #[arg(long, value_name = "FILE.png", value_parser = png)]
    pub(crate) deep_out: Option<PathBuf>,
    /// Fail if any hair found no room and is missing in the picture
    #[arg(long)]
    pub(crate) strict: bool,
    /// What is drawn in place of the meshes that hair collides with
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with = "reference")]
    pub(crate) show: Option<Show>,
    /// Draw with the reference renderer: rays through fibres as solids, on the CPU
    #[arg(long, conflicts_with = "character")]
    pub(crate) reference: bool,
    /// Rays a pixel of the reference renderer
    #[arg(long, default_value = "64", value_name = "N", requires = "reference")]
    pub(crate) samples: NonZeroU32,
    /// Where the reference renderer has its colours from
    #[arg(long, value_enum, default_value_t = ReferenceLight::Traced, requires = "reference")]
    pub(crate) reference_light: ReferenceLight,
    /// Distance from one fibre to the next one behind it in radii, for `--reference-light nearest`
    #[arg(long, default_value = "0.4", value_name = "N", requires = "reference")]
    pub(crate) fibre_spacing: f64,
}

#[derive(Debug, Args)]
pub(crate) struct Simulate {
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// The .tfx file to write; a folder (ending in /) where there are several grooms
    #[arg(long, value_name = "POSE.tfx")]
    pub(crate) out: PathBuf,
    /// Write follow strands too
    #[arg(long)]
    pub(crate) all: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Shaders {
    /// A file, or `builtin:NAME[:STRANDS[:VERTICES]]`
    #[arg(default_value = "builtin:long", value_name = "GROOM")]
    pub(crate) groom: String,
    /// The languages to write, between commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "wgsl", value_name = "LANGUAGE")]
    pub(crate) emit: Vec<LanguageName>,
    /// Write only the kernel of this name, such as hair.sim.tressfx
    #[arg(long, value_name = "LABEL")]
    pub(crate) kernel: Option<String>,
    /// The folder to write into
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Parameters of simulation and look
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) params: Option<PathBuf>,
    /// What solves the equations of motion
    #[arg(long, value_enum, default_value_t = SolverName::Direct)]
    pub(crate) solver: SolverName,
    /// Follow strands of each guide; without it, as `render` has them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=256))]
    pub(crate) follow: Option<u32>,
    #[command(flatten)]
    pub(crate) oit: Oit,
    /// Write the kernels for strands that bring colours of their own along too, though this groom has none
    #[arg(long)]
    pub(crate) own_colors: bool,
    /// Write the kernels that make signed distance fields, and those that collide with them, too
    #[arg(long)]
    pub(crate) fields: bool,
    /// Write the kernels of a renderer that writes depth and coverage of the hair too
    #[arg(long)]
    pub(crate) hair_output: bool,
    /// Write the kernels for a device that is a CPU: some drivers end loops that run on, and their kernels end before; a thread goes along a strand alone unless it is long
    #[arg(long)]
    pub(crate) for_cpu: bool,
    /// Write the kernels for the least that WebGPU promises, bindings of 128 MiB: lists of fragments have two buffers of nodes
    #[arg(long)]
    pub(crate) for_least_limits: bool,
}

impl Shaders {
    /// What was asked for.
    pub(crate) fn languages(&self) -> impl Iterator<Item = Language> {
        self.emit.iter().map(|name| name.language())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LanguageName {
    /// The one source, for WebGPU
    Wgsl,
    /// SPIR-V 1.6 for Vulkan 1.3
    Spirv,
    /// Shader model 6.0, for Direct3D 12
    Hlsl,
    /// Metal Shading Language 2.4; we have nothing that checks it
    Msl,
    /// 4.50, for OpenGL 4.5
    Glsl,
    /// GLSL ES 3.10, for OpenGL ES 3.1
    Essl,
}

impl LanguageName {
    fn language(self) -> Language {
        match self {
            Self::Wgsl => Language::Wgsl,
            Self::Spirv => Language::Spirv,
            Self::Hlsl => Language::Hlsl,
            Self::Msl => Language::Msl,
            Self::Glsl => Language::Glsl,
            Self::Essl => Language::Essl,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Scattering {
    /// A diffuse term and two highlights (Kajiya and Kay)
    Kajiya,
    /// Glass with tilted scales and pigment (Marschner et al.), which keeps the energy of light
    Fibre,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Motion {
    /// It does not
    Still,
    /// It is shaken
    Shake,
    /// It turns to one side and to the other
    Turn,
    /// It goes along with steps
    Walk,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReferenceLight {
    /// The colours that the techniques draw with: what differs from theirs is visibility alone
    Given,
    /// Rays towards each light and the sky, through the strands and past the meshes
    Traced,
    /// By the distance behind the nearest fibre that a light sees, as TressFX 4.1 does: a method to compare with
    Nearest,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendName {
    /// Vulkan, Metal or Direct3D 12 through wgpu
    Wgpu,
    /// Raw Vulkan 1.3
    Vulkan,
    /// One after the other, with a comparison of their pictures
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SolverName {
    /// The published method of TressFX: constraints, one after the other; edges stretch
    Tressfx,
    /// Rods with bending and twist, all edges of a strand at once; edges keep their lengths
    Direct,
}

impl SolverName {
    pub(crate) fn solver(self) -> Solver {
        match self {
            Self::Tressfx => Solver::TressFx,
            Self::Direct => Solver::Direct,
        }
    }
}

/// `N` finite numbers between commas.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<[f32; N], String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse::<f32>()).collect();
    let numbers = numbers.map_err(|error| format!("{error}: {N} numbers between commas are needed"))?;
    if let Some(bad) = numbers.iter().find(|number| !number.is_finite()) {
        return Err(format!("{bad} is not finite"));
    }
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("{N} numbers between commas are needed, not {count}"))
}

/// The names of presets, each with what it is.
fn presets() -> impl TypedValueParser<Value = Preset> {
    let names = Preset::ALL.map(|preset| PossibleValue::new(preset.name).help(preset.what));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Preset>())
}

/// The names of looks, each with what it is.
fn looks() -> impl TypedValueParser<Value = Look> {
    let names = Look::ALL.map(|look| PossibleValue::new(look.name).help(look.what));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Look>())
}

pub(crate) fn share(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        Ok(share) => Err(format!("{share} is not between 0 and 1")),
        Err(error) => Err(error.to_string()),
    }
}

pub(crate) fn vector(text: &str) -> Result<Vec3, String> {
    numbers(text).map(Vec3::from_array)
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once('x').ok_or("WIDTHxHEIGHT is needed, such as 1280x720")?;
    let edge = |text: &str| match text.parse() {
        Ok(edge @ 1..=16384) => Ok(edge),
        Ok(edge) => Err(format!("{edge} is not between 1 and 16384")),
        Err(error) => Err(format!("{text}: {error}")),
    };
    Ok([edge(width)?, edge(height)?])
}

fn png(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if is_png { Ok(path) } else { Err("the ending must be .png".to_owned()) }
}

fn exr(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    if is_exr { Ok(path) } else { Err("the ending must be .exr".to_owned()) }
}

fn fps(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (1.0..=10_000.0).contains(&fps) => Ok(fps),
        Ok(fps) => Err(format!("{fps} is not between 1 and 10000")),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn odd_values_are_refused_in_words() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert!(size("640").unwrap_err().contains("1280x720"));
        assert!(size("0x480").unwrap_err().contains("between 1 and 16384"));
        assert_eq!(vector("1, -2,3.5"), Ok(Vec3::new(1.0, -2.0, 3.5)));
        assert!(vector("1,2").unwrap_err().contains("not 2"));
        assert!(vector("1,2,inf").unwrap_err().contains("not finite"));
        assert!(png("map.jpg").unwrap_err().contains(".png") && png("map.PNG").is_ok());
        assert!(share("0.5") == Ok(0.5) && share("NaN").unwrap_err().contains("between 0 and 1"));
        assert!(fps("0").unwrap_err().contains("between"));
    }
}
