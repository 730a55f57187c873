//! The porting guide, held to the code: its tables of parameters and of passes, and its excerpts.

#[path = "guide/ranges.rs"]
mod ranges;
#[path = "guide/table.rs"]
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use tressfx_asset::builtin::Builtin;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Backend, Caps, Format, TextureDesc};
use tressfx_core::body::{Influences, Morph, MorphOffset};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{Command, PassList};
use tressfx_core::shader::{Shader, ShaderSlot};
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{
    FibreScattering, Fill, HairRenderer, Light, Lights, LodDesc, Look, MAX_LIGHTS, Material, OpaqueDepth, OwnLook,
    Pigment, PpllDesc, RenderDesc, SectionDraw, ShadedStrands, ShadowDesc, ShortCutDesc, StrandInfo, Targets,
    Technique, TilesDesc, VELOCITY_FORMAT, ViewDraw,
};
use tressfx_sim::body::{Binding, BoneRoots, Skinning, TriangleRoots};
use tressfx_sim::field::{FieldDesc, FieldSurface, Fields};
use tressfx_sim::{
    ClockParams, Collider, HairSim, Interpolation, InterpolationParams, SectionDesc, SimParams, SleepParams, Solver,
    StepInput, VolumeParams, Wind,
};

use table::{GUIDE, Row, rows, words};

/// The row of a name.
fn row<'a>(rows: &'a [Row], name: &str) -> &'a Row {
    rows.iter().find(|row| words(&row[0]).contains(&name.to_owned())).unwrap_or_else(|| panic!("`{name}` has no row"))
}

#[test]
fn the_tables_of_parameters_have_the_defaults_of_the_code() {
    let text = include_str!("../../docs/parameters.toml");
    let defaults: toml::Table = text.parse().unwrap();
    for (table, heading) in [("clock", "Clock"), ("sim", "Simulation"), ("material", "Material")] {
        let rows = rows(heading);
        let mut expected = BTreeMap::new();
        for (name, value) in defaults[table].as_table().unwrap() {
            match value {
                toml::Value::Table(parts) => {
                    expected.extend(parts.iter().map(|(part, value)| (format!("{name}.{part}"), value.clone())));
                }
                value => drop(expected.insert(name.clone(), value.clone())),
            }
        }
        for (name, value) in &expected {
            let said: toml::Table = format!("said = {}", words(&row(&rows, name)[2])[0]).parse().unwrap();
            assert_eq!(&said["said"], value, "{table}.{name}");
        }
        // What is left is none by default, and commented out in the file.
        let names: BTreeSet<_> = rows.iter().flat_map(|row| words(&row[0])).collect();
        let left = names.into_iter().filter(|name| !expected.contains_key(name));
        let none: Vec<_> = left.collect();
        let all_none =
            none.iter().all(|name| row(&rows, name)[2].starts_with("`None`") && text.contains(&format!("# {name} =")));
        assert!(all_none, "{table}: {none:?}");
    }
}

#[test]
fn what_has_no_file_has_its_defaults_too() {
    let StrandOptions { vertices, follows, follow_radius, tip_separation, shuffle, seed, metres_per_unit } =
        StrandOptions::default();
    let Wind { velocity, half_angle, gust_period } = Wind::default();
    let PpllDesc { k, max_node_bytes, count_limit, fill, places, .. } = PpllDesc::default();
    let shortcut = ShortCutDesc::default();
    let ShadowDesc { texels, layers, cells, lights, samples, .. } = ShadowDesc::default();
    let LodDesc { width, deviation, least, .. } = LodDesc::default();
    let volume = VolumeParams::default();
    let tables: [(&str, &[(&str, String)]); 7] = [
        (
            "Volume",
            &[
                ("cells", volume.cells.to_string()),
                ("rest_density", format!("{:?}", volume.rest_density)),
                ("sound_speed", format!("{:?}", volume.sound_speed)),
                ("friction", format!("{:?}", volume.friction)),
            ],
        ),
        (
            "Level of detail in numbers",
            &[("width", width.to_string()), ("deviation", deviation.to_string()), ("least", least.to_string())],
        ),
        (
            "Shadows",
            &[
                ("texels", texels.to_string()),
                ("layers", layers.to_string()),
                ("cells", cells.to_string()),
                ("lights", lights.to_string()),
                ("samples", samples.to_string()),
            ],
        ),
        (
            "Strands",
            &[
                ("vertices", format!("{vertices:?}")),
                ("follows", format!("{follows:?}")),
                ("follow_radius", format!("{follow_radius:?}")),
                ("tip_separation", format!("{tip_separation:?}")),
                ("shuffle", format!("{shuffle:?}")),
                ("seed", format!("{seed:?}")),
                ("metres_per_unit", format!("{metres_per_unit:?}")),
            ],
        ),
        (
            "Wind",
            &[
                ("velocity", format!("{:?}", velocity.to_array())),
                ("half_angle", format!("{half_angle:?}")),
                ("gust_period", format!("{gust_period:?}")),
            ],
        ),
        (
            "Renderer",
            &[
                ("k", k.to_string()),
                ("max_node_bytes", max_node_bytes.to_string()),
                ("count_limit", count_limit.to_string()),
                ("places", places.to_string()),
                ("fill", format!("Fill::{fill:?}")),
            ],
        ),
        (
            "ShortCut",
            &[
                ("k", shortcut.k.to_string()),
                ("ordered", shortcut.ordered.to_string()),
                ("fill", format!("Fill::{:?}", shortcut.fill)),
            ],
        ),
    ];
    for (heading, expected) in tables {
        let rows = rows(heading);
        for (name, default) in expected {
            assert_eq!(words(&row(&rows, name)[2])[0], *default, "{heading}: {name}");
        }
    }
    assert!(GUIDE.contains(&format!("At most {MAX_LIGHTS} lights")));
}

#[test]
fn ranges_are_those_that_the_code_refuses_beyond() {
    ranges::hold("Clock", "", |table| table.try_into().ok().map(|params: ClockParams| params.validate().is_ok()));
    ranges::hold("Simulation", "", |table| table.try_into().ok().map(|params: SimParams| params.validate().is_ok()));
    ranges::hold("Volume", "", |table| table.try_into().ok().map(|volume: VolumeParams| volume.validate().is_ok()));
    ranges::hold("Wind", "", |table| table.try_into().ok().map(|wind: Wind| wind.validate().is_ok()));
    let material = "primary = { strength = 0.5, exponent = 9.0 }\nsecondary = { strength = 0.5, exponent = 9.0 }\nfibre = { roughness = 0.3 }\n";
    ranges::hold("Material", material, |table| {
        table.try_into().ok().map(|material: Material| material.validate().is_ok())
    });
}

#[test]
fn the_table_of_looks_has_those_of_the_code() {
    let text = include_str!("../../docs/materials.md");
    let numbers = |color: glam::Vec3| color.to_array().map(|c| c.to_string()).join(", ");
    for look in Look::ALL {
        let pigment = match (look.pigment, look.colors) {
            (Pigment::Melanin { eumelanin, pheomelanin }, _) => {
                format!("eumelanin {eumelanin}, pheomelanin {pheomelanin}")
            }
            (Pigment::Absorption(absorption), _) => format!("absorption {}", numbers(absorption)),
            (_, colors) => format!("colours {}", colors.unwrap().map(numbers).join(" and ")),
        };
        let Look { name, roughness, variation, shadow_alpha, .. } = look;
        let row = format!("| `{name}` | {pigment} | {roughness} | {variation} | {shadow_alpha} |");
        assert!(text.contains(&row), "materials.md has no row {row}");
    }
}

/// The passes of a body with morph targets, on which the second section grows by triangles and by bones.
fn body(backend: &mut NullBackend, list: &mut PassList, sim: &mut HairSim, groom: &Builtin, strands: &Strands) {
    let mut mesh = groom.mesh().skinned("head").unwrap();
    let offset = MorphOffset { vertex: 0, position: glam::Vec3::Y, normal: glam::Vec3::ZERO };
    mesh.morphs = vec![Morph { name: "swell".into(), offsets: vec![offset] }];
    mesh.tangents = vec![glam::Vec4::X; mesh.positions.len()];
    let mut skinning = Skinning::new(backend, list, &mesh, true).unwrap();
    skinning.pose(list, &mesh.bind_pose()).unwrap();
    let binding = Binding::of_guides(strands, &mesh, 1.0).unwrap();
    let on_skin = TriangleRoots::new(backend, list, sim, 1, &binding, skinning.mesh_vertices()).unwrap();
    on_skin.record(list, sim);
    let of = vec![Influences::rigid(0); strands.order.len()];
    BoneRoots::new(backend, list, (sim, 1), strands, &of, skinning.palette()).unwrap().record(list, sim);
}

/// The pass of strands between three guides.
fn interpolation(backend: &mut NullBackend, list: &mut PassList) {
    let roots = [glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Z];
    let points = roots.iter().flat_map(|&root| [root, root + glam::Vec3::Y].map(glam::Vec3::into)).collect();
    let asset = HairAsset::new("guides", AssetFormat::Builtin, points, vec![2; 3]);
    let guides = Strands::new(&asset, &StrandOptions::default()).unwrap();
    let buffers = StrandBuffers::new(backend, StrandShape::of(&guides), glam::Vec3::ZERO).unwrap();
    let params = InterpolationParams { clump: 0.5, noise: 0.1, shorter: 0.5, ..InterpolationParams::default() };
    Interpolation::new(backend, list, (&buffers, &guides), 9, &params).unwrap().record(list, 9);
}

/// Lists with every pass that there is.
fn everything() -> PassList {
    let mut caps = Caps::webgpu_default();
    caps.read_write_textures = true;
    let mut backend = NullBackend::new(caps);
    let groom = Builtin::parse("curly:8:6").unwrap();
    let strands = Strands::new(&groom.asset(), &StrandOptions { follows: Some(2), ..Default::default() }).unwrap();
    let rods = SectionDesc::new(&strands, SimParams::default());
    let colliders = Collider::all_with_head(&groom.capsules());
    let mut list = PassList::new();
    let section = rods.clone().with_solver(Solver::TressFx);
    let sections = [section.clone(), section.with_own_roots(), rods];
    let corners = [glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y];
    let mut fields = Fields::new(&mut backend, &mut list, &[FieldDesc::new(&corners, &[0, 1, 2])]).unwrap();
    fields.record(&mut list);
    FieldSurface::new(&mut backend, &fields, 0).unwrap().record(&mut list);
    let volume = VolumeParams::default();
    let most = colliders.len();
    let mut sim = HairSim::with_volume(&mut backend, &mut list, &sections, most, Some(&fields), &volume).unwrap();
    let wind = Wind::new(glam::Vec3::X);
    let turned = Pose { translation: glam::Vec3::X * 0.01, ..Pose::IDENTITY };
    for head in [Pose::IDENTITY, turned] {
        sim.step(&mut list, &StepInput::new(1.0 / 60.0, head).with_colliders(&colliders).with_wind(wind)).unwrap();
    }
    sim.allow_sleep(&mut backend, SleepParams::default()).unwrap();
    sim.request_motion(&mut list);
    body(&mut backend, &mut list, &mut sim, &groom, &strands);
    interpolation(&mut backend, &mut list);
    let size = [64, 64];
    let view = Camera::around(&[glam::Vec3::NEG_ONE, glam::Vec3::ONE], size).view(size).unwrap();
    let mut texture = |format| backend.create_texture(&TextureDesc::new("target", size, format)).unwrap();
    let targets = Targets::new(texture(Format::Rgba16F), texture(Format::Depth32F));
    let velocity = texture(VELOCITY_FORMAT);
    let map = OpaqueDepth { depth: texture(Format::Depth32F), view, bias: 0.01 };
    let section = ShadedStrands::new(&mut backend, sim.buffers()[0], StrandInfo::new(&strands)).unwrap();
    let section = section.with_past(&mut backend).unwrap();
    let material = Material::default();
    let draw = SectionDraw::new(&section, &material, sim.pose());
    let glass = Material::default().with(|material| material.fibre = Some(FibreScattering::default()));
    let light = Light::directional(glam::Vec3::Y, glam::Vec3::ONE).opaque(map);
    let lights = Lights { sky: glam::Vec3::ONE, lights: vec![light], ..Lights::default() };
    let techniques: [Technique; 9] = [
        PpllDesc::default().into(),
        PpllDesc::default().skips_hidden(true).into(),
        // No room for all fragments.
        PpllDesc::default().max_node_bytes(16 * 8).into(),
        PpllDesc::default().fill(Fill::Raster).into(),
        ShortCutDesc::default().into(),
        ShortCutDesc::default().ordered(true).into(),
        ShortCutDesc::default().fill(Fill::Raster).into(),
        ShortCutDesc::default().ordered(true).fill(Fill::Raster).into(),
        TilesDesc::default().skips_hidden(true).into(),
    ];
    for technique in techniques {
        let desc = RenderDesc::new(size, Format::Rgba16F).technique(technique);
        let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
        renderer.grow_to_predicted(&mut backend, &view, &[draw]).unwrap();
        renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
        let draw = SectionDraw::new(&section, &glass, sim.pose());
        renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
    }
    let desc = RenderDesc::new(size, Format::Rgba16F).storage_target(true);
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
    let desc = RenderDesc::new(size, Format::Rgba16F).velocity_output(true);
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets.velocity(velocity))], &[draw]).unwrap();
    let desc = RenderDesc::new(size, Format::Rgba16F).own_colors(true);
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    let own = ShadedStrands::new(&mut backend, sim.buffers()[0], StrandInfo::new(&strands)).unwrap();
    let look = OwnLook::default().with_colors(vec![[0.5; 4]; 8 * 6]);
    let own = own.with_own_look(&mut backend, &mut list, &look).unwrap();
    let draw = SectionDraw::new(&own, &material, sim.pose());
    renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
    list
}

#[test]
fn the_table_of_passes_has_every_pass_with_what_it_binds() {
    let mut passes: BTreeMap<&str, [BTreeSet<String>; 2]> = BTreeMap::new();
    let list = everything();
    for (label, command) in list.passes() {
        let shaders: Vec<&Shader> = match command {
            Command::Compute(pass) => vec![&pass.kernel.shader],
            Command::Raster(pass) => pass.draws.iter().map(|draw| &*draw.pipeline.shader).collect(),
            _ => unreachable!("only passes have labels"),
        };
        let [reads, writes] = passes.entry(label).or_default();
        // Of the others a line below the table says when they are there.
        let in_table = |slot: &&ShaderSlot| match slot.name.as_str() {
            "roots" => false,
            "rest" => label.starts_with("hair.sim."),
            "nearest_keys" => slot.kind.is_written(),
            "listed" => label == "hair.render.occlusion_sums",
            _ => true,
        };
        for slot in shaders.iter().flat_map(|shader| &shader.slots).filter(in_table) {
            let side = if slot.kind.is_written() { &mut *writes } else { &mut *reads };
            side.insert(slot.name.clone());
        }
    }
    let said: BTreeMap<_, _> = rows("The passes")
        .iter()
        .map(|row| {
            (words(&row[0])[0].clone(), [1, 2].map(|cell| words(&row[cell]).into_iter().collect::<BTreeSet<_>>()))
        })
        .collect();
    let found: BTreeMap<_, _> = passes.into_iter().map(|(label, sides)| (label.to_owned(), sides)).collect();
    assert_eq!(said, found);
}

#[test]
fn excerpts_are_from_the_examples() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = String::new();
    for name in ["src", "embed_wgpu", "embed_vulkan", "my_backend", "tests"] {
        for entry in fs::read_dir(folder.join(name)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with("guide.rs") {
                sources += &fs::read_to_string(path).unwrap();
            }
        }
    }
    let lines: BTreeSet<&str> = sources.lines().map(str::trim).collect();
    let excerpts: Vec<&str> =
        GUIDE.split("```rust,ignore\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(excerpts.len() >= 5, "{} excerpts", excerpts.len());
    for line in excerpts.iter().flat_map(|excerpt| excerpt.lines()) {
        assert!(lines.contains(line.trim()), "no example has: {line}");
    }
}

#[test]
fn files_that_are_linked_are_there() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let links = GUIDE.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| !link.starts_with('#') && !link.starts_with("https:")) {
        assert!(docs.join(link).exists(), "{link}");
    }
    let headings: BTreeSet<String> = GUIDE
        .lines()
        .filter_map(|line| line.strip_prefix('#'))
        .map(|line| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-"))
        .collect();
    for anchor in GUIDE.split("](#").skip(1).filter_map(|rest| rest.split(')').next()) {
        assert!(headings.contains(anchor), "#{anchor}");
    }
}
