//! Lists and descriptions that break the rules of the contract: for each kind of command a sound one, and one mistake a rule.
//!
//! Each is answered with an error that names command and mistake, and does nothing. What is not refused must run, without a
//! word from a validation layer: `random` makes lists of which nobody knows beforehand.

mod copies;
mod descriptions;
mod passes;
mod random;
mod world;

use tressfx_core::error::{Error, Result};
use tressfx_core::pass::{Command, PassList};

pub use descriptions::broken_descriptions;
pub use random::random_list;
pub use world::World;

/// A command that breaks one rule.
#[derive(Clone, Debug)]
pub struct Mistake {
    /// The rule.
    pub what: String,
    /// What breaks it.
    pub command: Command,
    /// Words of the answer.
    pub says: &'static str,
}

/// Mistakes, as they are found.
#[derive(Debug, Default)]
struct Mistakes(Vec<Mistake>);

impl Mistakes {
    fn add(&mut self, what: impl Into<String>, command: Command, says: &'static str) {
        self.0.push(Mistake { what: what.into(), command, says });
    }
}

/// A list with one mistake in it.
#[derive(Debug)]
pub struct Broken {
    /// The list.
    pub list: PassList,
    /// The mistake.
    pub mistake: Mistake,
    /// Which command it is.
    pub place: usize,
}

impl Broken {
    /// Holds an answer against the mistake: `None`, or what is wrong with the answer.
    pub fn complaint(&self, answer: &Result<()>) -> Option<String> {
        let Mistake { what, command, says } = &self.mistake;
        let begin = format!("command {}, {}", self.place, command.name());
        match answer {
            Err(Error::Rule { place, message }) if place.starts_with(&begin) && message.contains(says) => None,
            other => Some(format!("{what}: {other:?} does not say `{begin}` and `{says}`: {command:?}")),
        }
    }
}

/// Mistakes in commands that copy, clear and read back; those in passes as well where `passes` are asked for.
pub fn mistakes(world: &World, passes: bool) -> Vec<Mistake> {
    let mut found = Mistakes::default();
    copies::mistakes(world, &mut found);
    if let Some(passes) = passes.then_some(world.passes.as_ref()).flatten() {
        passes::mistakes(world, passes, &mut found);
    }
    found.0
}

/// Lists of a mistake: alone, after sound commands, among them.
pub fn broken_lists(world: &World, mistakes: Vec<Mistake>) -> Vec<Broken> {
    let each = |mistake: Mistake| {
        let sound = world.sound();
        (0..3).map(move |variant| {
            let before = if variant == 0 { &[][..] } else { sound.commands() };
            let after = if variant == 2 { sound.commands() } else { &[] };
            let commands = [before, std::slice::from_ref(&mistake.command), after].concat();
            Broken { list: sound.with_commands(commands), mistake: mistake.clone(), place: before.len() }
        })
    };
    mistakes.into_iter().flat_map(each).collect()
}
