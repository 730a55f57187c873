//! The measurement. What an interrupted run has measured is not measured again; a run that comes to its end leaves only the pictures
//! of the reference renderer to the next one.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::{Scope, ScopedJoinHandle};

use anyhow::{Context, Result, anyhow};
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};

use crate::figures::{Extent, PassTime, Row, Setting};
use crate::method::Method;
use crate::program::{PassStats, Program, Stats};
use crate::scene::Scene;

/// What is measured with, and where pictures and rows are kept.
#[derive(Debug)]
pub(crate) struct Measure {
    pub(crate) program: Program,
    pub(crate) work: PathBuf,
    setting: Setting,
    /// What is judged: where it is light, the reference traces it, and bytes are those of shadows.
    is_light: bool,
    fresh: bool,
}

/// A row of an interrupted run, and what it was measured with.
#[derive(Deserialize, Serialize)]
struct Kept {
    program: String,
    words: Vec<String>,
    row: Row,
}

impl Measure {
    pub(crate) fn new(program: Program, work: &Path, extent: Extent, fresh: bool) -> Self {
        let (setting, is_light) = (extent.setting(), extent == Extent::Light);
        Self { program, work: work.to_owned(), setting, is_light, fresh }
    }

    /// Every method on every scene whose groom is there, on every backend.
    pub(crate) fn all(&self, scenes: &[Scene], methods: &[Method], backends: &[&str]) -> Result<Vec<Row>> {
        let (there, missing): (Vec<_>, Vec<_>) = scenes.iter().partition(|scene| scene.groom.is_some());
        for scene in missing {
            eprintln!("skipped: {}: TRESSFX_ASSETS is not set", scene.name);
        }
        let style = "{bar:40} {pos} of {len}, {eta} left: {msg}";
        let bar = ProgressBar::new((there.len() * methods.len() * backends.len()) as u64)
            .with_style(ProgressStyle::with_template(style).expect("the template is fixed"));
        let (mut rows, mut kept) = (Vec::new(), Vec::new());
        for scene in there {
            bar.set_message(format!("{}, reference", scene.name));
            let groom = scene.groom.as_deref().unwrap_or_default();
            let words = self.words(groom, scene)?;
            let folder = self.folder(scene)?;
            let reference = self.reference(&folder, &words, backends[0])?;
            let measured = std::thread::scope(|threads| {
                let (mut measured, mut coming) = (Vec::new(), None);
                for (backend, method) in backends.iter().flat_map(|backend| methods.iter().map(move |m| (backend, m))) {
                    bar.set_message(format!("{}, {}, {backend}", scene.name, method.name));
                    let picture = folder.join(format!("{}-{backend}.png", method.name));
                    kept.push(picture.with_extension("json"));
                    let asked = Asked { scene, method, backend, words: &words, picture, reference: &reference };
                    let before = coming.replace(self.row(threads, asked)?);
                    measured.extend(before.map(Coming::row).transpose()?);
                    bar.inc(1);
                }
                measured.extend(coming.map(Coming::row).transpose()?);
                anyhow::Ok(measured)
            });
            rows.extend(measured?);
        }
        bar.finish_and_clear();
        kept.iter().try_for_each(|path| fs::remove_file(path).with_context(|| path.display().to_string()))?;
        Ok(rows)
    }

    /// What all pictures of a scene have in common.
    pub(crate) fn words(&self, groom: &str, scene: &Scene) -> Result<Vec<String>> {
        let Setting { size, frames, .. } = self.setting;
        let size = format!("{}x{}", size[0], size[1]);
        let camera = scene.camera(&self.program.bounds(groom)?);
        let words = [groom, "--camera", &camera, "--size", &size].map(str::to_owned).to_vec();
        Ok([words, scene.motion(frames)].concat())
    }

    fn folder(&self, scene: &Scene) -> Result<PathBuf> {
        let Setting { size, samples, frames, .. } = self.setting;
        let folder = self.work.join(format!("{}x{}-{samples}-{frames}", size[0], size[1])).join(&scene.name);
        fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        Ok(folder)
    }

    /// The picture of the reference renderer, with 16 bits. It is drawn under another name first: what has its name is whole.
    fn reference(&self, folder: &Path, words: &[String], backend: &str) -> Result<PathBuf> {
        let (picture, drawn_with) = (folder.join("reference-16.png"), folder.join("reference.txt"));
        let typed = words.join(" ");
        let is_there = picture.exists() && fs::read_to_string(&drawn_with).is_ok_and(|text| text == typed);
        if is_there && !self.fresh {
            return Ok(picture);
        }
        let part = folder.join("reference-16.part.png");
        // Techniques are judged by what they make of visibility: the colours are theirs.
        let samples = self.setting.samples.to_string();
        let light = if self.is_light { "traced" } else { "given" };
        let more = ["--reference", "--reference-light", light, "--samples", &samples, "--backend", backend];
        let words = [words, &more.map(str::to_owned), &deep_to(&part)].concat();
        self.program.render(&words, &folder.join("reference.png"))?;
        fs::rename(&part, &picture).with_context(|| picture.display().to_string())?;
        fs::write(&drawn_with, typed).with_context(|| drawn_with.display().to_string())?;
        Ok(picture)
    }

    /// What the run before has measured, or draws the picture; it is compared while the next one is made.
    fn row<'scope>(&'scope self, threads: &'scope Scope<'scope, '_>, asked: Asked<'scope>) -> Result<Coming<'scope>> {
        let deep = asked.picture.with_extension("16.png");
        let on = ["--backend".to_owned(), asked.backend.to_owned()];
        let words = [asked.words, &asked.method.words, &on, &deep_to(&deep)].concat();
        let program = &self.program.stamp;
        let earlier = fs::read_to_string(asked.kept()).ok().and_then(|text| serde_json::from_str::<Kept>(&text).ok());
        if let Some(earlier) = earlier.filter(|kept| (&kept.program, &kept.words) == (program, &words) && !self.fresh) {
            return Ok(Coming::Kept(earlier.row));
        }
        let stats = self.program.measure(&words, &asked.picture)?;
        Ok(Coming::Compared(threads.spawn(move || self.compare(&asked, stats, words, &deep))))
    }

    fn compare(&self, asked: &Asked, stats: Stats, words: Vec<String>, deep: &Path) -> Result<Row> {
        let comparison = self.program.compare(deep, asked.reference)?;
        let row = Row {
            scene: asked.scene.name.clone(),
            method: asked.method.name.clone(),
            flip: comparison.flip_mean,
            psnr_db: comparison.psnr_db,
            largest: comparison.max_difference,
            passes: passes(&stats, self.is_light),
            fragments: stats.render.fragments,
            dropped: stats.render.dropped,
            bytes: if self.is_light { stats.render.shadow_bytes } else { stats.render.oit_bytes },
            backend: stats.backend,
            adapter: stats.adapter,
        };
        let kept = asked.kept();
        let text = serde_json::to_string(&Kept { program: self.program.stamp.clone(), words, row: row.clone() })?;
        fs::write(&kept, text).with_context(|| kept.display().to_string())?;
        Ok(row)
    }
}

/// A method on a scene and a backend.
struct Asked<'a> {
    scene: &'a Scene,
    method: &'a Method,
    backend: &'a str,
    /// What all pictures of the scene have in common.
    words: &'a [String],
    picture: PathBuf,
    reference: &'a Path,
}

impl Asked<'_> {
    /// Where its row is kept.
    fn kept(&self) -> PathBuf {
        self.picture.with_extension("json")
    }
}

/// A row that is known, or will be when its picture has been compared.
enum Coming<'scope> {
    Kept(Row),
    Compared(ScopedJoinHandle<'scope, Result<Row>>),
}

impl Coming<'_> {
    fn row(self) -> Result<Row> {
        match self {
            Self::Kept(row) => Ok(row),
            Self::Compared(thread) => thread.join().map_err(|_| anyhow!("the comparison has panicked"))?,
        }
    }
}

/// Has a picture drawn with 16 bits a channel too: of one of 8 bits the rounding alone is a mean FLIP of 0.006.
fn deep_to(path: &Path) -> [String; 2] {
    ["--deep-out".to_owned(), path.to_string_lossy().into_owned()]
}

/// Of the passes that draw hair in most of the frames. Those of the first frames alone are no part of what a frame takes, nor are those of shadows, which are the same
/// for all techniques, but where light is judged.
pub(crate) fn passes(stats: &Stats, is_light: bool) -> Vec<PassTime> {
    let is_judged =
        |label: &str| label.starts_with("hair.render.") && (is_light || !label.starts_with("hair.render.shadow_"));
    let is_usual = |pass: &&PassStats| is_judged(&pass.label) && 2 * pass.frames > stats.frames;
    stats
        .passes
        .iter()
        .filter(is_usual)
        .map(|pass| PassTime { label: pass.label.clone(), ms: pass.median_ms })
        .collect()
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;
    use crate::figures::Run;
    use crate::figures::tests::row;
    use crate::method::methods;
    use crate::scene::scenes;
    use crate::times;

    /// Notes what it is asked for, and answers as `tressfx` does.
    const ANSWERS: &str = r#"#!/bin/sh
echo "$*" >> "$(dirname "$0")/asked.txt"
case $1 in
info) echo '[{"bounds": {"min": [0, 0, 0], "max": [1, 1, 1]}}]' ;;
compare) echo '{"flip_mean": 0.25, "psnr_db": null, "max_difference": 9, "differing_share": 0.5}' ;;
render)
    case "$*" in *"--oit-k 4 "*) [ -e "$(dirname "$0")/broken" ] && echo "the device is lost" >&2 && exit 1 ;; esac
    while [ $# -gt 0 ]; do
        case $1 in
        --out | --deep-out) echo picture > "$2" ;;
        --stats) echo '{"backend": "wgpu", "adapter": "none", "frames": 2,
            "passes": [{"label": "hair.render.tile_bin", "median_ms": 1.0, "frames": 2},
                       {"label": "hair.render.fill", "median_ms": 5, "frames": 1},
                       {"label": "hair.sim.tressfx", "median_ms": 9, "frames": 2}],
            "render": {"fragments": 7, "dropped": 1, "oit_bytes": 5, "shadow_bytes": 3}}' > "$2" ;;
        esac
        shift
    done ;;
esac
"#;

    /// A folder with a program in it.
    struct Rig(PathBuf);

    impl Rig {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("tressfx-accuracy-{name}-{}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        fn build(&self, text: &str) {
            fs::write(self.0.join("tressfx"), text).unwrap();
            fs::set_permissions(self.0.join("tressfx"), fs::Permissions::from_mode(0o755)).unwrap();
        }

        fn measure_with(&self, fresh: bool) -> Measure {
            Measure::new(Program::new(&self.0.join("tressfx")).unwrap(), &self.0.join("work"), Extent::Quick, fresh)
        }

        /// Two methods on one scene, and how often a reference and a measurement were asked for.
        fn measure(&self, fresh: bool) -> (Result<Vec<Row>>, usize, usize) {
            let rows =
                self.measure_with(fresh).all(&scenes(Extent::Quick)[..1], &methods(Extent::Quick)[..2], &["wgpu"]);
            let asked = fs::read_to_string(self.0.join("asked.txt")).unwrap();
            fs::remove_file(self.0.join("asked.txt")).unwrap();
            let count = |word: &str| asked.lines().filter(|line| line.contains(word)).count();
            (rows, count("--reference"), count("--stats"))
        }
    }

    impl Drop for Rig {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn an_interrupted_run_goes_on_and_any_other_measures_anew() {
        let rig = Rig::new("anew");
        rig.build(ANSWERS);
        fs::write(rig.0.join("broken"), "").unwrap();
        let (error, references, measured) = rig.measure(false);
        assert!(error.unwrap_err().to_string().contains("the device is lost"));
        assert_eq!((references, measured), (1, 2), "the second one failed");
        fs::remove_file(rig.0.join("broken")).unwrap();
        let (rows, references, measured) = rig.measure(false);
        assert_eq!((references, measured), (0, 1));
        let rows = rows.unwrap();
        assert_eq!((rows[0].flip, rows[0].psnr_db, rows[0].largest, rows[0].ms()), (0.25, None, 9, Some(1.0)));
        assert_eq!((rows[1].fragments, rows[1].dropped, rows[1].bytes), (7, 1, 5));
        let (again, references, measured) = rig.measure(false);
        assert_eq!((again.unwrap(), references, measured), (rows.clone(), 0, 2), "it had come to its end");
        let (again, references, measured) = rig.measure(true);
        assert_eq!((again.unwrap(), references, measured), (rows, 1, 2));
        // What another program has measured is measured again.
        fs::write(rig.0.join("broken"), "").unwrap();
        assert!(rig.measure(false).0.is_err());
        fs::remove_file(rig.0.join("broken")).unwrap();
        rig.build(&format!("{ANSWERS}\n# built anew"));
        let (rows, references, measured) = rig.measure(false);
        assert_eq!((rows.unwrap().len(), references, measured), (2, 0, 2));
    }
    #[test]
    fn times_are_taken_anew_where_pictures_are_the_same() {
        let rig = Rig::new("times");
        rig.build(ANSWERS);
        let (scenes, methods) = (&scenes(Extent::Quick)[..1], &methods(Extent::Quick)[..3]);
        let row = |method: usize, fragments, ms| Row {
            scene: scenes[0].name.clone(),
            adapter: "none (an older driver)".into(),
            passes: vec![PassTime { label: "hair.render.tile_bin".into(), ms }],
            fragments,
            dropped: 1,
            bytes: 5,
            ..row(&methods[method].name, 0.125, ms)
        };
        let stored =
            vec![row(0, 7, 2.0), row(1, 8, 2.0), row(2, 7, 2.0), Row { scene: "elsewhere".into(), ..row(0, 7, 2.0) }];
        let run = |rows| Run { setting: Extent::Quick.setting(), rows, changes: Vec::new(), note: None };
        let anew = times::anew(&rig.measure_with(false), run(stored.clone()), scenes, &methods[..2]).unwrap();
        let mut now = stored.clone();
        now[0] = Row { adapter: "none".into(), ..row(0, 7, 1.0) };
        assert_eq!(anew, run(now), "another picture, another method and another scene stay");
        let elsewhere = run(vec![Row { adapter: "a GPU".into(), ..stored[0].clone() }]);
        let refused = times::anew(&rig.measure_with(false), elsewhere, scenes, methods).unwrap_err();
        assert!(refused.to_string().contains("cannot be compared"), "{refused}");
    }
}
