//! Compilers of others that a shader must get through. Metal's runs on Apple's machines only.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// When this is set, a compiler that is not installed is an error: `cargo xtask test` installs them.
const REQUIRED: &str = "TRESSFX_SHADER_COMPILERS";

/// A language that something checks.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Compiler {
    /// `spirv-val`.
    Spirv,
    /// `glslangValidator`.
    Glsl,
    /// `glslangValidator`.
    Essl,
    /// The HLSL front end of `glslangValidator`.
    Hlsl,
}

impl Compiler {
    pub(crate) const ALL: [Self; 4] = [Self::Spirv, Self::Glsl, Self::Essl, Self::Hlsl];

    pub(crate) fn language(self) -> &'static str {
        match self {
            Self::Spirv => "spirv",
            Self::Glsl => "glsl",
            Self::Essl => "essl",
            Self::Hlsl => "hlsl",
        }
    }

    fn program(self) -> &'static str {
        match self {
            Self::Spirv => "spirv-val",
            Self::Glsl | Self::Essl | Self::Hlsl => "glslangValidator",
        }
    }

    /// Compiles a file; an error is what was said, with the name of the file.
    pub(crate) fn compile(self, file: &Path, stage: &str, entry_point: &str) -> Result<(), String> {
        match self {
            Self::Spirv => self.run(&["--target-env", "vulkan1.3"], file),
            Self::Glsl | Self::Essl => self.run(&["-S", stage], file),
            Self::Hlsl => {
                let readable = file.with_extension("glslang.hlsl");
                fs::write(&readable, without_zero_arrays(&fs::read_to_string(file).unwrap())).unwrap();
                // It reads HLSL only where it is to make SPIR-V of it.
                let spirv = file.with_extension("glslang.spv");
                self.run(&["-V", "-D", "-e", entry_point, "-S", stage, "-o", spirv.to_str().unwrap()], &readable)
            }
        }
    }

    fn run(self, words: &[&str], file: &Path) -> Result<(), String> {
        let output = Command::new(self.program()).args(words).arg(file).output().unwrap();
        let said = [&output.stdout[..], &output.stderr].concat();
        let message = || format!("{} {words:?} {}: {}", self.program(), file.display(), String::from_utf8_lossy(&said));
        if output.status.success() { Ok(()) } else { Err(message()) }
    }
}

/// HLSL makes an array of zeros by a cast, `(float4[8])0`, and so does naga. glslang does not know that cast, alone of all
/// that naga writes: it gets a constant instead.
fn without_zero_arrays(hlsl: &str) -> String {
    let mut constants = String::new();
    let mut text = hlsl.to_owned();
    while let Some(end) = text.find("])0") {
        let start = text[..end].rfind('(').unwrap();
        let (element, count) = text[start + 1..end].split_once('[').unwrap();
        let name = format!("zeros_{element}_{count}");
        let zeros = vec![format!("({element})0"); count.parse().unwrap()].join(", ");
        let constant = format!("static const {element} {name}[{count}] = {{ {zeros} }};\n");
        if !constants.contains(&constant) {
            constants += &constant;
        }
        text.replace_range(start..end + 3, &name);
    }
    constants + &text
}

/// Whether there is a compiler. Where there is none, that is said past what the test framework holds back.
pub(crate) fn installed(compiler: Compiler) -> bool {
    let program = compiler.program();
    if Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok() {
        return true;
    }
    assert!(std::env::var_os(REQUIRED).is_none(), "{REQUIRED} is set, but there is no {program}");
    let language = compiler.language();
    let _ = writeln!(std::io::stderr(), "skipped: no {program}, so that no compiler reads the {language} shaders");
    false
}
