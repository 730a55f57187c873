//! The scenes, as data.

use tressfx_render::{AutoDesc, Fill, PpllDesc, ShortCutDesc, Tail, Technique, TilesDesc};

/// From where hair is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Eye {
    /// Hair fills most of the picture.
    Middle,
    /// The same with depth that grows with the distance, and a far plane that is infinitely far.
    Standard,
    /// At a third of the distance.
    Near,
    /// At eight times the distance.
    Far,
    /// In the middle of the hair.
    Inside,
    /// The near plane cuts through it.
    Cut,
    /// Half of it is out of the picture.
    Aside,
    /// From straight above.
    Above,
    /// From near by, at 130 degrees.
    Wide,
    /// Parallel rays.
    Parallel,
    /// The head of the camera is tilted, and its picture mirrored.
    Rolled,
    /// It looks away: there is no hair in the picture.
    Away,
}

/// What all sections look like, beside their own colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    Default,
    /// Nothing is seen through a strand.
    Opaque,
    /// Everything is.
    Clear,
    /// Almost everything is.
    Faint,
    /// Opaque at the root, clear at the tip.
    Fading,
    /// Each strand has a brightness of its own.
    Varied,
    /// The tip has no width.
    Pointed,
    /// The tip is as wide as the root.
    Blunt,
    /// No width at all.
    NoWidth,
    /// Thinner than any hair.
    Thin,
    /// A quarter of the picture.
    Wide,
    /// Narrow highlights, shifted.
    Glossy,
    /// Fibres that scatter light as glass.
    Glass,
    /// Without light that is scattered, and without shadow.
    Flat,
}

/// What else is in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solid {
    Nothing,
    /// A triangle that goes slanted through the hair.
    Roof,
    /// A wall before all of it.
    Wall,
}

/// How techniques are set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    /// Sorted fragments of lists.
    k: u32,
    tail: Tail,
    cap: Option<u32>,
    nodes: Option<u64>,
    /// Layers of ShortCut.
    layers: u32,
    references: Option<u64>,
    closed_below: Option<f32>,
    /// Whether what is chosen automatically is tiles in the end, and not lists.
    pub(crate) grows_dense: bool,
}

const USUAL: Setting = Setting {
    k: 8,
    tail: Tail::Shaded,
    cap: None,
    nodes: None,
    layers: 3,
    references: None,
    closed_below: None,
    grows_dense: false,
};
const NONE: Setting = Setting { k: 0, layers: 1, ..USUAL };
const ONE: Setting = Setting { k: 1, layers: 2, ..USUAL };
const MANY: Setting = Setting { k: 32, layers: 8, ..USUAL };
const UNSHADED: Setting = Setting { k: 3, tail: Tail::Unshaded, layers: 4, ..USUAL };
const WEIGHTED: Setting = Setting { tail: Tail::Weighted, ..USUAL };
const WEIGHTED_CAPPED: Setting = Setting { k: 5, tail: Tail::Weighted, cap: Some(5), ..USUAL };
const NO_TAIL: Setting = Setting { k: 2, tail: Tail::None, layers: 5, ..USUAL };
const CAPPED: Setting = Setting { k: 4, cap: Some(2), ..USUAL };
const CAPPED_AT_NONE: Setting = Setting { cap: Some(0), ..USUAL };
const SMALL_POOL: Setting = Setting { nodes: Some(16 * 4000), ..USUAL };
const SMALL_BUDGET: Setting = Setting { references: Some(4 * 8000), ..USUAL };
const ENDLESS: Setting = Setting { closed_below: Some(0.0), ..USUAL };
const EARLY: Setting = Setting { closed_below: Some(0.3), ..USUAL };
const DENSE: Setting = Setting { grows_dense: true, ..USUAL };

/// What techniques can do beside, and how far apart those of one scene are: no two of a scene are the same.
pub(crate) const OTHERS: usize = 7;
const OTHER_STRIDE: usize = 3;

impl Setting {
    /// Whether what is chosen automatically is tiles: in the end, or from the beginning, since lists have far too few nodes.
    pub(crate) fn is_for_tiles(&self) -> bool {
        self.grows_dense || self.nodes.is_some()
    }

    /// Every technique, so set, and behind them what each can do beside: so many of these, another one first for each scene.
    pub(crate) fn techniques(&self, scene: usize, beside: usize) -> Vec<(&'static str, Technique)> {
        let [techniques, others] = self.all();
        let chosen = (0..beside).map(|i| others[(scene + OTHER_STRIDE * i) % others.len()]);
        techniques.into_iter().chain(chosen).collect()
    }

    fn all(&self) -> [Vec<(&'static str, Technique)>; 2] {
        let &Self { k, tail, cap, layers, .. } = self;
        let mut lists = PpllDesc::default().k(k).tail(tail).cap(cap);
        lists.max_node_bytes = self.nodes.unwrap_or(lists.max_node_bytes);
        let mut tiles = TilesDesc::default();
        tiles.max_reference_bytes = self.references.unwrap_or(tiles.max_reference_bytes);
        tiles.closed_below = self.closed_below.unwrap_or(tiles.closed_below);
        let (mean, auto) = (ShortCutDesc::default().k(layers), AutoDesc::default().lists(lists).tiles(tiles));
        let dense = if self.grows_dense { 0.1 } else { auto.dense };
        let techniques = vec![
            ("lists", lists.into()),
            ("lists, raster", lists.fill(Fill::Raster).into()),
            ("mean", mean.into()),
            ("mean, raster", mean.fill(Fill::Raster).into()),
            ("in order", mean.ordered(true).into()),
            ("in order, raster", mean.ordered(true).fill(Fill::Raster).into()),
            ("tiles", tiles.into()),
            ("auto", auto.dense(dense).tiles_on_cpu(true).into()),
        ];
        let others: [(&'static str, Technique); OTHERS] = [
            ("lists, four places", lists.places(4).into()),
            ("lists, 16 places, raster", lists.places(16).fill(Fill::Raster).into()),
            ("lists, nothing hidden", lists.skips_hidden(true).into()),
            ("mean, nothing hidden, raster", mean.skips_hidden(true).fill(Fill::Raster).into()),
            ("tiles, four places", tiles.places(4).skips_hidden(true).into()),
            ("tiles, 16 places", tiles.places(16).into()),
            ("tiles, 64 places", tiles.places(64).into()),
        ];
        [techniques, others.to_vec()]
    }
}

/// One picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) grooms: &'static [&'static str],
    pub(crate) eye: Eye,
    pub(crate) look: Look,
    pub(crate) solid: Solid,
    pub(crate) size: [u32; 2],
    pub(crate) setting: Setting,
}

impl Scene {
    /// Whether there is hair to be seen.
    pub(crate) fn shows_hair(&self) -> bool {
        self.eye != Eye::Away && self.solid != Solid::Wall && ![Look::Clear, Look::NoWidth].contains(&self.look)
    }
}

const fn scene(
    name: &'static str,
    grooms: &'static [&'static str],
    (eye, look, solid): (Eye, Look, Solid),
    size: [u32; 2],
    setting: Setting,
) -> Scene {
    Scene { name, grooms, eye, look, solid, size, setting }
}

const CURLY: &[&str] = &["curly:200:24"];
const FUR: &[&str] = &["fur:600:5"];
const LONG: &[&str] = &["long:250:16"];
const STRAIGHT: &[&str] = &["straight:300:8"];
const FOLLOWED: &[&str] = &["wavy:80:12+2"];
const COLOURED: &[&str] = &["wavy:80:12 coloured+2"];
const LOOSE: &[&str] = &["loose"];
const THICK: &[&str] = &["dense"];
const TWO: &[&str] = &["loose", "other"];
const FOUR: &[&str] = &["loose", "curly:200:24", "other", "one strand"];

/// All of them.
#[rustfmt::skip]
pub(crate) const SCENES: &[Scene] = &[
    // Grooms.
    scene("curly", CURLY, (Eye::Middle, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("fur", FUR, (Eye::Middle, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("long", LONG, (Eye::Middle, Look::Default, Solid::Nothing), [96, 160], USUAL),
    scene("straight", STRAIGHT, (Eye::Middle, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("strands that follow guides", FOLLOWED, (Eye::Middle, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("a look of its own", COLOURED, (Eye::Middle, Look::Default, Solid::Nothing), [128, 96], USUAL),
    scene("a look of its own, as glass", COLOURED, (Eye::Middle, Look::Glass, Solid::Nothing), [128, 96], USUAL),
    scene("loose", LOOSE, (Eye::Middle, Look::Wide, Solid::Nothing), [160, 96], USUAL),
    scene("dense", THICK, (Eye::Middle, Look::Blunt, Solid::Nothing), [128, 96], USUAL),
    scene("some of the strands and vertices", &["some", "other"], (Eye::Middle, Look::Varied, Solid::Nothing), [128, 96], USUAL),
    scene("one strand", &["one strand"], (Eye::Middle, Look::Wide, Solid::Nothing), [64, 64], USUAL),
    scene("two vertices", &["two vertices"], (Eye::Middle, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("most vertices", &["most vertices"], (Eye::Middle, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("all in one depth", &["one depth"], (Eye::Parallel, Look::Varied, Solid::Nothing), [96, 96], MANY),
    scene("all in one depth, some sorted", &["one depth"], (Eye::Parallel, Look::Faint, Solid::Nothing), [96, 96], ONE),
    scene("towards the eye", &["towards the eye"], (Eye::Middle, Look::Wide, Solid::Nothing), [96, 96], USUAL),
    scene("strands without length", &["points"], (Eye::Middle, Look::Wide, Solid::Nothing), [64, 64], USUAL),
    scene("strands without length among others", &["points", "other"], (Eye::Middle, Look::Blunt, Solid::Nothing), [64, 64], USUAL),
    // Eyes.
    scene("curly from near by", CURLY, (Eye::Near, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("curly from far away", CURLY, (Eye::Far, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("curly from inside", CURLY, (Eye::Inside, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("fur from near by", FUR, (Eye::Near, Look::Varied, Solid::Nothing), [160, 96], ENDLESS),
    scene("fur from far away", FUR, (Eye::Far, Look::Varied, Solid::Nothing), [160, 96], MANY),
    scene("fur from inside", FUR, (Eye::Inside, Look::Varied, Solid::Nothing), [160, 96], ONE),
    scene("long from near by", LONG, (Eye::Near, Look::Faint, Solid::Nothing), [128, 96], USUAL),
    scene("long from far away", LONG, (Eye::Far, Look::Faint, Solid::Nothing), [160, 96], USUAL),
    scene("long from inside", LONG, (Eye::Inside, Look::Faint, Solid::Nothing), [128, 96], USUAL),
    scene("behind the camera", CURLY, (Eye::Away, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("behind the camera, dense", THICK, (Eye::Away, Look::Wide, Solid::Roof), [96, 64], MANY),
    scene("partly out of the picture", LONG, (Eye::Aside, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("fur partly out of the picture", FUR, (Eye::Aside, Look::Opaque, Solid::Nothing), [93, 61], EARLY),
    scene("cut by the near plane", THICK, (Eye::Cut, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("curls cut by the near plane", CURLY, (Eye::Cut, Look::Blunt, Solid::Nothing), [160, 96], NO_TAIL),
    scene("from above", STRAIGHT, (Eye::Above, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("a wide angle", FUR, (Eye::Wide, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("parallel rays", CURLY, (Eye::Parallel, Look::Default, Solid::Nothing), [160, 96], UNSHADED),
    scene("tilted and mirrored", FOLLOWED, (Eye::Rolled, Look::Default, Solid::Nothing), [160, 96], USUAL),
    scene("depth that grows", LONG, (Eye::Standard, Look::Default, Solid::Nothing), [160, 96], USUAL),
    // Looks.
    scene("opaque", CURLY, (Eye::Middle, Look::Opaque, Solid::Nothing), [128, 96], USUAL),
    scene("clear", CURLY, (Eye::Middle, Look::Clear, Solid::Nothing), [128, 96], USUAL),
    scene("faint", THICK, (Eye::Middle, Look::Faint, Solid::Nothing), [96, 64], ENDLESS),
    scene("fading to the tip", STRAIGHT, (Eye::Middle, Look::Fading, Solid::Nothing), [128, 96], USUAL),
    scene("varied", THICK, (Eye::Middle, Look::Varied, Solid::Nothing), [128, 96], USUAL),
    scene("pointed", FUR, (Eye::Near, Look::Pointed, Solid::Nothing), [128, 96], USUAL),
    scene("without width", LONG, (Eye::Middle, Look::NoWidth, Solid::Nothing), [128, 96], USUAL),
    scene("thin", THICK, (Eye::Middle, Look::Thin, Solid::Nothing), [128, 96], USUAL),
    scene("wide", LOOSE, (Eye::Near, Look::Wide, Solid::Nothing), [64, 48], USUAL),
    scene("wide from inside", LOOSE, (Eye::Inside, Look::Wide, Solid::Nothing), [96, 64], USUAL),
    scene("glossy", CURLY, (Eye::Near, Look::Glossy, Solid::Nothing), [128, 96], USUAL),
    scene("glass", CURLY, (Eye::Near, Look::Glass, Solid::Nothing), [128, 96], USUAL),
    scene("glass from inside", LONG, (Eye::Inside, Look::Glass, Solid::Roof), [128, 96], USUAL),
    scene("flat", FUR, (Eye::Middle, Look::Flat, Solid::Nothing), [128, 96], USUAL),
    // Before and behind something opaque.
    scene("through a roof", CURLY, (Eye::Middle, Look::Default, Solid::Roof), [160, 96], USUAL),
    scene("dense through a roof", THICK, (Eye::Middle, Look::Varied, Solid::Roof), [128, 96], MANY),
    scene("through a roof, depth that grows", FUR, (Eye::Standard, Look::Default, Solid::Roof), [160, 96], USUAL),
    scene("through a roof from near by", LONG, (Eye::Near, Look::Default, Solid::Roof), [160, 96], CAPPED),
    scene("behind a wall", CURLY, (Eye::Middle, Look::Default, Solid::Wall), [160, 96], USUAL),
    scene("behind a wall, small pool", THICK, (Eye::Middle, Look::Default, Solid::Wall), [96, 64], SMALL_POOL),
    // Several grooms.
    scene("two grooms", TWO, (Eye::Middle, Look::Blunt, Solid::Nothing), [160, 96], USUAL),
    scene("two grooms through a roof", TWO, (Eye::Middle, Look::Varied, Solid::Roof), [160, 96], ONE),
    scene("four grooms", FOUR, (Eye::Middle, Look::Varied, Solid::Nothing), [160, 96], MANY),
    scene("four grooms from inside", FOUR, (Eye::Inside, Look::Faint, Solid::Roof), [128, 96], USUAL),
    // Sizes.
    scene("one pixel", CURLY, (Eye::Middle, Look::Wide, Solid::Nothing), [1, 1], USUAL),
    scene("one row", CURLY, (Eye::Inside, Look::Default, Solid::Nothing), [301, 1], USUAL),
    scene("one column", LONG, (Eye::Inside, Look::Default, Solid::Nothing), [1, 299], USUAL),
    scene("less than a tile", FUR, (Eye::Middle, Look::Default, Solid::Nothing), [7, 5], MANY),
    scene("a pixel more than tiles", STRAIGHT, (Eye::Middle, Look::Default, Solid::Nothing), [97, 65], USUAL),
    scene("a pixel less than tiles", FUR, (Eye::Aside, Look::Default, Solid::Roof), [95, 63], USUAL),
    // Settings.
    scene("nothing sorted", CURLY, (Eye::Middle, Look::Varied, Solid::Nothing), [128, 96], NONE),
    scene("dense, nothing sorted", THICK, (Eye::Middle, Look::Default, Solid::Roof), [128, 96], NONE),
    scene("one sorted", LONG, (Eye::Middle, Look::Varied, Solid::Nothing), [128, 96], ONE),
    scene("many sorted", THICK, (Eye::Middle, Look::Faint, Solid::Nothing), [96, 64], MANY),
    scene("a weighted tail", THICK, (Eye::Middle, Look::Default, Solid::Nothing), [128, 96], WEIGHTED),
    scene("a weighted tail without nodes", THICK, (Eye::Middle, Look::Default, Solid::Nothing), [96, 96], WEIGHTED_CAPPED),
    scene("a tail without light", THICK, (Eye::Middle, Look::Default, Solid::Nothing), [128, 96], UNSHADED),
    scene("no tail", FUR, (Eye::Middle, Look::Faint, Solid::Nothing), [128, 96], NO_TAIL),
    scene("capped", THICK, (Eye::Middle, Look::Varied, Solid::Nothing), [128, 96], CAPPED),
    scene("capped at nothing", CURLY, (Eye::Near, Look::Default, Solid::Nothing), [128, 96], CAPPED_AT_NONE),
    scene("small pool", THICK, (Eye::Middle, Look::Varied, Solid::Nothing), [96, 64], SMALL_POOL),
    scene("small pool, two grooms", TWO, (Eye::Near, Look::Wide, Solid::Nothing), [93, 61], SMALL_POOL),
    scene("small budget", THICK, (Eye::Middle, Look::Varied, Solid::Nothing), [64, 48], SMALL_BUDGET),
    scene("small budget, long", LONG, (Eye::Middle, Look::Faint, Solid::Roof), [61, 45], SMALL_BUDGET),
    scene("closed early", THICK, (Eye::Middle, Look::Default, Solid::Nothing), [128, 96], EARLY),
    scene("never closed", LONG, (Eye::Middle, Look::Opaque, Solid::Nothing), [128, 96], ENDLESS),
    scene("lists, then tiles", FUR, (Eye::Middle, Look::Faint, Solid::Roof), [61, 45], DENSE),
    scene("lists, then tiles, two grooms", TWO, (Eye::Near, Look::Varied, Solid::Nothing), [64, 48], DENSE),
];
