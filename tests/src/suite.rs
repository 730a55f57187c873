//! What every backend must do, one case a promise of the contract. [`suite!`](crate::suite!) makes tests of them.
//!
//! A case says what it needs. On a backend whose caps do not have that it is skipped, and says so; it never just passes.

mod bindings;
mod caps;
mod cases;
mod contract;
mod depth;
mod draws;
mod formats;
mod hair;
mod hazards;
mod kernels;
mod packed;
mod raster_hazards;
mod rules;
mod scale;
mod shaders;
mod stale;
mod state;
mod subject;
mod textures;

use std::cell::RefCell;
use std::fmt::{self, Display};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use tressfx_core::backend::{Backend, Run};
use tressfx_core::error::Error;

pub use cases::CASES;
use subject::Subject;
/// What a case may need of a device.
pub use tressfx_core::error::Need;

/// Makes a fresh backend.
pub(crate) type Make<'a> = &'a (dyn Fn() -> Result<Box<dyn Run>, String> + Sync);

/// One promise of the contract.
#[derive(Clone, Copy)]
pub struct Case {
    /// Its name, `group::promise`.
    pub name: &'static str,
    /// What it asks of a device.
    pub needs: &'static [Need],
    run: fn(&mut Subject),
}

/// How a case ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The promise holds.
    Passed,
    /// The device lacks this; nothing is known.
    Skipped(Need),
    /// The promise is broken: where the assertion stands, and what it said.
    Failed(String),
}

impl Display for Outcome {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Passed => out.write_str("passed"),
            Self::Skipped(need) => write!(out, "skipped: needs {need}"),
            Self::Failed(why) => write!(out, "failed: {why}"),
        }
    }
}

impl Case {
    /// Runs the case on a fresh backend that `make` makes.
    pub fn outcome<B: Run + 'static, E: Display>(&self, make: impl Fn() -> Result<B, E> + Sync) -> Outcome {
        note_places();
        let attempt = catch_unwind(AssertUnwindSafe(|| self.attempt(&boxed(make))));
        match attempt {
            Ok(Ok(None)) => Outcome::Passed,
            Ok(Ok(Some(need))) => Outcome::Skipped(need),
            Ok(Err(error)) => Outcome::Failed(error),
            Err(panic) => Outcome::Failed(format!("{}: {}", PLACE.take(), words(&*panic))),
        }
    }

    /// Runs the case, or says which of its needs is not met; an error is one of making the backend.
    fn attempt(&self, make: Make) -> Result<Option<Need>, String> {
        let backend = make()?;
        if let Err(Error::Unsupported { need, .. }) = backend.caps().check("suite", self.needs) {
            return Ok(Some(need));
        }
        (self.run)(&mut Subject::new(backend, make));
        Ok(None)
    }
}

/// Runs all cases; the backends are made by `make`, one or two for each case.
pub fn report<B: Run + 'static, E: Display>(make: impl Fn() -> Result<B, E> + Sync) -> Vec<(&'static str, Outcome)> {
    CASES.iter().map(|case| (case.name, case.outcome(&make))).collect()
}

/// Holds that what was skipped is what the backend says that it lacks.
///
/// # Errors
/// The cases that were skipped for something which the backend has.
pub fn promises(backend: &dyn Backend, outcomes: &[(&'static str, Outcome)]) -> Result<(), String> {
    let broken = outcomes.iter().filter_map(|(name, outcome)| match outcome {
        Outcome::Skipped(need) => {
            backend.caps().check("suite", &[*need]).is_ok().then(|| format!("{name}: skipped, but there are {need}\n"))
        }
        _ => None,
    });
    let broken: String = broken.collect();
    if broken.is_empty() { Ok(()) } else { Err(broken) }
}

/// Runs the case of a name as a test: it panics where the promise is broken, or where the device denies what is not among
/// `lacks`, and prints where it is skipped.
///
/// Where no backend can be made and `TRESSFX_NO_GPU` says that this is known, the case is skipped as well.
///
/// # Panics
/// Where the promise is broken, or no backend can be made.
pub fn test<B: Run + 'static, E: Display>(name: &str, make: impl Fn() -> Result<B, E> + Sync, lacks: &[Need]) {
    let case = CASES.iter().find(|case| case.name == name).expect("the macro only names cases that there are");
    match case.attempt(&boxed(make)) {
        Ok(None) => {}
        Ok(Some(need)) if lacks.contains(&need) => say_skipped(name, &format!("needs {need}")),
        Ok(Some(need)) => panic!("{name} is skipped: it needs {need}, and nobody said that the backend lacks that"),
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => say_skipped(name, &error),
        Err(error) => panic!("{error}"),
    }
}

/// Says so past the capture of test output: what did not run must be seen.
pub fn say_skipped(name: &str, why: &str) {
    let _ = writeln!(std::io::stderr(), "{name}: skipped: {why}");
}

fn boxed<B: Run + 'static, E: Display>(
    make: impl Fn() -> Result<B, E> + Sync,
) -> impl Fn() -> Result<Box<dyn Run>, String> + Sync {
    move || match make() {
        Ok(backend) => Ok(Box::new(backend)),
        Err(error) => Err(error.to_string()),
    }
}

thread_local! {
    /// Where this thread has panicked last.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Has every panic note its place, so that a failure says which assertion it was.
fn note_places() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            PLACE.set(info.location().map(|at| format!("{}:{}", at.file(), at.line())).unwrap_or_default());
            before(info);
        }));
    });
}

/// What a panic said.
fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without words").to_owned()
}

/// One `#[test]` for each case of the suite.
///
/// Takes a closure without arguments that makes a fresh backend: `Result<impl Run, impl Display>`. It is called from
/// many threads, once or twice for each case. A backend that lacks something on purpose says so; else a case that cannot run
/// fails.
///
/// ```ignore
/// tressfx_conformance::suite!(|| MyBackend::headless());
/// tressfx_conformance::suite!(|| MyCopies::new(), lacks: [Compute, Raster]);
/// ```
#[macro_export]
macro_rules! suite {
    ($make:expr) => {
        $crate::suite!($make, lacks: []);
    };
    ($make:expr, lacks: [$($need:ident),*]) => {
        #[allow(clippy::redundant_closure, reason = "a closure is what is asked for, whatever it calls")]
        fn test_of_suite(name: &str) {
            $crate::suite::test(name, $make, &[$($crate::suite::Need::$need),*]);
        }
        $crate::each_case!($crate::one_test_each);
    };
}

/// Tests that call `test_of_suite` beside them.
#[doc(hidden)]
#[macro_export]
macro_rules! one_test_each {
    ($($group:ident { $($case:ident: [$($need:ident)*];)* })*) => {$(
        mod $group {$(
            #[test]
            fn $case() {
                super::test_of_suite(concat!(stringify!($group), "::", stringify!($case)));
            }
        )*}
    )*};
}
