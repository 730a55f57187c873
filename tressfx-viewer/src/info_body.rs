//! `tressfx info` of characters and of what belongs to them.

use std::path::Path;

use anyhow::{Result, bail};
use serde_json::{Value, json};
use tressfx_asset::character::{Character, read_bytes};
use tressfx_asset::{FileKind, bones, pc2, tfxmesh, tfxskin};

use crate::say::say;

/// A file that is no groom.
pub(crate) struct File {
    name: String,
    kind: FileKind,
    data: Vec<u8>,
}

/// Those named, where none of them is a groom; nothing where all are.
pub(crate) fn files(names: &[String]) -> Result<Option<Vec<File>>> {
    let mut files = Vec::new();
    let mut grooms = 0;
    for name in names {
        // A file that is not there is said to be so by who reads grooms.
        let data = if name.starts_with("builtin:") { None } else { std::fs::read(name).ok() };
        match data.map(|data| (FileKind::of(&data), data)) {
            Some((kind, data)) if kind != FileKind::Groom => files.push(File { name: name.clone(), kind, data }),
            _ => grooms += 1,
        }
    }
    match (files.is_empty(), grooms) {
        (true, _) => Ok(None),
        (false, 0) => Ok(Some(files)),
        _ => bail!("{}: it is no groom; ask for grooms and for other files apart", files[0].name),
    }
}

/// Reports every file, as text or as a JSON array.
pub(crate) fn run(files: Vec<File>, as_json: bool) -> Result<()> {
    let reports = files.iter().map(report).collect::<Result<Vec<_>>>()?;
    if as_json {
        let object = |(file, facts): (&File, &Vec<(&str, Value)>)| {
            let facts = facts.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
            facts.chain([("name".to_owned(), json!(file.name))]).collect::<serde_json::Map<_, _>>()
        };
        let objects: Vec<_> = files.iter().zip(&reports).map(object).collect();
        say(serde_json::to_string_pretty(&objects)?)?;
        return Ok(());
    }
    for (file, facts) in files.iter().zip(&reports) {
        say(&file.name)?;
        for (name, value) in facts {
            match value {
                Value::Array(values) => {
                    let values: Vec<_> = values.iter().map(|value| value.to_string().replace('"', "")).collect();
                    say(format_args!("  {name:11} {}", values.join(", ")))?;
                }
                Value::String(text) => say(format_args!("  {name:11} {text}"))?,
                value => say(format_args!("  {name:11} {value}"))?,
            }
        }
    }
    Ok(())
}

fn report(file: &File) -> Result<Vec<(&'static str, Value)>> {
    let (name, data) = (&file.name, &file.data[..]);
    Ok(match file.kind {
        FileKind::Character => {
            let folder = Path::new(name).parent();
            of_character("glTF", &read_bytes(name, data, folder)?)
        }
        FileKind::SkinnedMesh => of_character("TfxMesh", &tfxmesh::read(name, data)?.into()),
        FileKind::StrandBones => {
            let read = bones::read(name, data)?;
            vec![
                ("format", json!("TfxBone")),
                ("strands", json!(read.strands.len())),
                ("bones", json!(read.bones)),
                ("normalised", json!(read.normalised)),
            ]
        }
        FileKind::StrandTriangles => {
            let read = tfxskin::read(name, data)?;
            let meshes = read.roots.iter().map(|root| root.mesh).max().map_or(0, |last| last + 1);
            vec![
                ("format", json!("TfxSkin")),
                ("strands", json!(read.roots.len())),
                ("meshes", json!(meshes)),
                ("uvs", json!(read.uvs.is_some())),
            ]
        }
        FileKind::PointCache => {
            let read = pc2::read(name, data)?;
            vec![
                ("format", json!("Pc2")),
                ("points", json!(read.points)),
                ("samples", json!(read.samples())),
                ("start", json!(read.start_frame)),
                ("rate", json!(read.sample_rate)),
            ]
        }
        _ => bail!("{name}: no report of such a file"),
    })
}

fn of_character(format: &str, character: &Character) -> Vec<(&'static str, Value)> {
    let mesh = &character.mesh;
    let corner = |of: fn(glam::Vec3, glam::Vec3) -> glam::Vec3, from: f32| {
        mesh.positions.iter().copied().fold(glam::Vec3::splat(from), of).to_array()
    };
    let animation = |animation: &tressfx_asset::character::Animation| {
        json!(format!("{} ({:.3} s)", animation.name, animation.seconds))
    };
    let low = corner(glam::Vec3::min, f32::INFINITY);
    let high = corner(glam::Vec3::max, f32::NEG_INFINITY);
    vec![
        ("format", json!(format)),
        ("vertices", json!(mesh.positions.len())),
        ("triangles", json!(mesh.triangles.len())),
        ("low", json!(low)),
        ("high", json!(high)),
        ("joints", json!(mesh.joints)),
        ("morphs", json!(mesh.morphs.len())),
        ("animations", Value::Array(character.animations.iter().map(animation).collect())),
        ("normalised", json!(character.normalised)),
        ("reduced", json!(character.reduced)),
    ]
}
