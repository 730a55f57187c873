//! The programs of tests: cargo builds them, and some run at once. Cargo runs one after the other, and many of them have one thread of work at a time: a
//! software driver computes on the thread that asks.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::Instant;

use serde_json::Value;

/// Programs that run at once; each of them runs as many tests as there are cores.
const AT_ONCE: usize = 2;

/// A program with tests.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Program {
    /// Its package and its own name.
    name: String,
    path: PathBuf,
    /// That of the package: tests find files from there.
    folder: PathBuf,
}

impl Program {
    /// What a line of cargo's messages says, if it is about a program with tests.
    fn of(message: &Value) -> Option<Self> {
        let is_test = message["reason"] == "compiler-artifact" && message["profile"]["test"] == true;
        let path = message["executable"].as_str().filter(|_| is_test)?;
        let folder = Path::new(message["manifest_path"].as_str()?).parent()?;
        let package = folder.file_name()?.to_string_lossy();
        let name = format!("{package}/{}", message["target"]["name"].as_str()?);
        Some(Self { name, path: path.into(), folder: folder.to_owned() })
    }

    /// Runs it, shows what it says once it is over, and tells whether all its tests passed.
    fn passes(&self, words: &[&str], environment: &[(&str, &str)]) -> bool {
        let mut command = Command::new(&self.path);
        command.current_dir(&self.folder).args(words).envs(environment.iter().copied()).stdin(Stdio::null());
        let begin = Instant::now();
        match command.output() {
            Ok(output) => {
                let said = [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).concat();
                println!("{}, {:.1} s{said}", self.name, begin.elapsed().as_secs_f64());
                output.status.success()
            }
            Err(error) => {
                println!("{}: {error}", self.name);
                false
            }
        }
    }
}

/// Builds all tests of the workspace.
pub(crate) fn build(cargo: &mut Command) -> Result<Vec<Program>, String> {
    cargo.args(["test", "--workspace", "--no-run", "--message-format=json-render-diagnostics"]);
    let output = cargo.stderr(Stdio::inherit()).output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(format!("cargo test --workspace --no-run: {}", output.status));
    }
    let messages: Vec<Value> = serde_json::Deserializer::from_slice(&output.stdout)
        .into_iter()
        .collect::<Result<_, _>>()
        .map_err(|error| format!("what cargo says of the programs that it has built: {error}"))?;
    let mut programs: Vec<_> = messages.iter().filter_map(Program::of).collect();
    programs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(programs)
}

/// Runs programs to their end, also where one fails.
pub(crate) fn run(programs: &[Program], words: &[&str], environment: &[(&str, &str)]) -> Result<(), String> {
    let (next, failed) = (Mutex::new(programs.iter()), Mutex::new(Vec::new()));
    let take_turns = || {
        // The lock is not held while a program runs.
        while let Some(program) = { next.lock().expect("no thread panics").next() } {
            if !program.passes(words, environment) {
                failed.lock().expect("no thread panics").push(program.name.as_str());
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(take_turns);
        }
    });
    let failed = failed.into_inner().expect("no thread panics");
    if failed.is_empty() { Ok(()) } else { Err(format!("tests failed in {}", failed.join(", "))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(name: &str) -> Program {
        Program { name: name.into(), path: "/bin/sh".into(), folder: std::env::temp_dir() }
    }

    #[test]
    fn a_program_is_what_cargo_has_built_with_tests() {
        let line = |test: bool| {
            serde_json::json!({
                "reason": "compiler-artifact", "manifest_path": "/w/tests/Cargo.toml", "profile": { "test": test },
                "target": { "name": "scene" }, "executable": "/w/target/debug/deps/scene-1",
            })
        };
        let program = Program {
            name: "tests/scene".into(),
            path: "/w/target/debug/deps/scene-1".into(),
            folder: "/w/tests".into(),
        };
        assert_eq!(Program::of(&line(true)), Some(program));
        assert_eq!(Program::of(&line(false)), None);
        assert_eq!(Program::of(&serde_json::json!({ "reason": "build-finished" })), None);
    }

    #[cfg(unix)]
    #[test]
    fn all_run_and_those_that_fail_are_named() {
        assert_eq!(run(&[shell("good")], &["-c", "test \"$COLOR\" = red"], &[("COLOR", "red")]), Ok(()));
        let error = run(&[shell("bad"), shell("more")], &["-c", "exit 1"], &[]).unwrap_err();
        assert!(error.contains("bad") && error.contains("more"), "{error}");
        let missing = Program { name: "missing".into(), path: "/nowhere".into(), folder: "/".into() };
        assert_eq!(run(&[missing], &[], &[]), Err("tests failed in missing".into()));
    }
}
