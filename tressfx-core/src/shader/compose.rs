//! Many WGSL files become one: imports are followed, features and constants are filled in.

use std::fmt;

use wesl::{CompileOptions, ModulePath, NoMangler, VirtualResolver};

use crate::error::{Error, Label, Result};

/// A WGSL file: the name that others import it by (`package::name`), and its text.
pub type Module = (&'static str, &'static str);

/// The modules that core offers to every shader.
pub fn shared_modules() -> &'static [Module] {
    &[("grid", include_str!("../../shaders/grid.wgsl")), ("hash", include_str!("../../shaders/hash.wgsl"))]
}

/// Where a shader comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaderSource {
    /// The kernel's label, such as `hair.sim.tressfx`.
    pub label: Label,
    /// The module with the entry points.
    pub root: Module,
    /// The modules that it may import, beside those of core.
    pub library: &'static [Module],
}

/// What a shader is compiled for: a scene without wind runs a kernel without wind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Specialization {
    features: Vec<(&'static str, bool)>,
    constants: Vec<(&'static str, u32)>,
}

impl Specialization {
    /// Nothing special.
    pub fn new() -> Self {
        Self::default()
    }

    /// Says whether code under `@if(name)` stays.
    #[must_use]
    pub fn feature(mut self, name: &'static str, on: bool) -> Self {
        self.features.push((name, on));
        self
    }

    /// Gives `package::constants::name` a value.
    #[must_use]
    pub fn constant(mut self, name: &'static str, value: u32) -> Self {
        self.constants.push((name, value));
        self
    }

    /// Features, and whether they are on.
    pub fn features(&self) -> &[(&'static str, bool)] {
        &self.features
    }

    /// Constants and their values.
    pub fn constants(&self) -> &[(&'static str, u32)] {
        &self.constants
    }

    fn constants_module(&self) -> String {
        self.constants.iter().map(|(name, value)| format!("const {name}: u32 = {value}u;\n")).collect()
    }
}

impl fmt::Display for Specialization {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let features = self.features.iter().filter(|(_, on)| *on).map(|(name, _)| (*name).to_owned());
        let constants = self.constants.iter().map(|(name, value)| format!("{name}={value}"));
        out.write_str(&features.chain(constants).collect::<Vec<_>>().join(" "))
    }
}

fn path(name: &str) -> ModulePath {
    format!("package::{name}").parse().expect("module names are identifiers")
}

/// The text of one WGSL module with everything that the root needs, and nothing else.
pub(super) fn compose(source: &ShaderSource, specialization: &Specialization) -> Result<String> {
    let mut resolver = VirtualResolver::new();
    for (name, text) in shared_modules().iter().chain(source.library).chain([&source.root]) {
        resolver.add_module(path(name), (*text).into());
    }
    resolver.add_module(path("constants"), specialization.constants_module().into());
    // naga validates the whole.
    let mut options = CompileOptions { validate: false, ..CompileOptions::default() };
    for (name, on) in &specialization.features {
        options.features.flags.insert((*name).to_owned(), (*on).into());
    }
    // A feature that nobody decided on is a mistake, not a default.
    options.features.default = wesl::Feature::Error;
    wesl::compile_sourcemap(&path(source.root.0), &resolver, &NoMangler, &options)
        .map(|result| result.to_string())
        .map_err(|error| Error::Shader { label: source.label, message: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::{Shader, SlotKind};

    const STRAND: Module = ("strand", "fn half(x: f32) -> f32 { return x * 0.5; }");

    fn source(text: &'static str) -> ShaderSource {
        ShaderSource { label: "test.kernel", root: ("kernel", text), library: &[STRAND] }
    }

    const KERNEL: &str = "
        import package::grid::{thread_index, GROUP};
        import package::strand::half;
        import package::constants::COUNT;

        struct Params { scale: f32, offset: f32 }

        @group(0) @binding(0) var<uniform> params: Params;
        @group(0) @binding(1) var<storage, read> input: array<f32>;
        @group(0) @binding(3) var<storage, read_write> output: array<f32>;

        @compute @workgroup_size(GROUP)
        fn kernel(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
            let i = thread_index(group, groups, lane);
            if (i >= COUNT) { return; }
            var x = params.scale;
            @if(halve) { x = half(input[i]); }
            output[i] = x;
        }";

    #[test]
    fn a_feature_that_is_off_leaves_no_binding_behind() {
        let compile = |halve| {
            let specialization = Specialization::new().feature("halve", halve).constant("COUNT", 7);
            Shader::new(&source(KERNEL), &specialization).unwrap()
        };
        let names = |shader: &Shader| shader.slots.iter().map(|slot| slot.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&compile(false)), ["params", "output"]);
        let with = compile(true);
        assert_eq!(names(&with), ["params", "input", "output"]);
        assert_eq!(with.features, "halve COUNT=7");
        assert_eq!(with.slots[0].kind, SlotKind::Uniform);
        assert_eq!(with.slots[0].min_bytes, 8);
        assert_eq!(with.slots[1].kind, SlotKind::Read);
        assert_eq!((with.slots[2].kind, with.slots[2].binding), (SlotKind::ReadWrite, 3));
        assert_eq!(with.storage_buffers(), 2);
    }

    #[test]
    fn a_feature_that_nobody_decided_on_is_an_error() {
        let error = Shader::new(&source(KERNEL), &Specialization::new().constant("COUNT", 1)).unwrap_err();
        assert!(error.to_string().contains("halve"), "{error}");
    }

    #[test]
    fn a_mistake_in_the_wgsl_is_an_error_with_its_place() {
        let error = Shader::new(
            &source("fn kernel() -> u32 { return 1.5; }\n@compute @workgroup_size(1) fn main() { let x = kernel(); }"),
            &Specialization::new(),
        )
        .unwrap_err();
        assert!(error.to_string().starts_with("test.kernel: "), "{error}");
        let error = Shader::new(
            &source("import package::nowhere::nothing;\n@compute @workgroup_size(1) fn main() { nothing(); }"),
            &Specialization::new(),
        )
        .unwrap_err();
        assert!(error.to_string().contains("nowhere"), "{error}");
    }

    crate::gpu_struct! {
        /// As in the kernel above.
        struct Params {
            /// Scale.
            pub scale: f32,
            /// Offset.
            pub offset: f32,
        }
    }

    mod swapped {
        crate::gpu_struct! {
            /// Not as in the kernel above.
            pub(super) struct Params {
                /// Offset.
                pub offset: f32,
                /// Scale.
                pub scale: f32,
            }
        }
    }

    #[test]
    fn a_struct_that_differs_from_its_wgsl_is_found() {
        let specialization = Specialization::new().feature("halve", false).constant("COUNT", 1);
        let shader = Shader::new(&source(KERNEL), &specialization).unwrap();
        shader.check_layout::<Params>().unwrap();
        let error = shader.check_layout::<swapped::Params>().unwrap_err();
        assert!(error.contains("offset"), "{error}");
    }
}
