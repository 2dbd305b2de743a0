//! The flags that change render settings, for every command that renders or builds trees.

use super::Failure;
use super::set::{Assignment, parse_size};
use super::set_entity::set_on_entity;
use crate::scene::{Builder, Property, RenderSettings, SETTINGS, range_problems};
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy::reflect::GetPath;
use clap::{Args, ValueEnum};
use std::fmt::Write;

/// Settings that replace those of the scene.
#[derive(Args)]
pub(super) struct SettingArgs {
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    pub size: Option<UVec2>,
    /// Samples of each pixel (effects may ask for more); the most with an error or a time to stop at
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// Chooses the random numbers
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<u32>,
    /// Any setting by its path (`glassbox render --help` lists them), or a component of an entity
    /// (`Lamp/PointLamp.intensity=3`); may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Assignment>,
    /// Threads to work on (default: all of the machine's)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// The builders as the command line names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum BuilderArg {
    /// No tree: every ray tests every triangle
    None,
    /// Half of the triangles on either side
    Median,
    /// Binned surface area heuristic
    Sah,
    /// obvhs: merges neighbours bottom-up, then improves the tree
    Ploc,
}

impl BuilderArg {
    pub const ALL: [Self; 4] = [Self::None, Self::Median, Self::Sah, Self::Ploc];

    /// As `bvh` calls it.
    pub fn of_tree(self) -> crate::bvh::Builder {
        match self {
            Self::None => crate::bvh::Builder::None,
            Self::Median => crate::bvh::Builder::Median,
            Self::Sah => crate::bvh::Builder::Sah,
            Self::Ploc => crate::bvh::Builder::Ploc,
        }
    }

    /// The setting's value.
    pub fn builder(self) -> Builder {
        match self {
            Self::None => Builder::None,
            Self::Median => Builder::Median,
            Self::Sah => Builder::Sah,
            Self::Ploc => Builder::Ploc,
        }
    }
}

impl SettingArgs {
    /// Refuses what would be wrong for any scene, before one is opened for nothing. What is about entities is checked
    /// when they are there, and so are ranges where something changes what the scene has.
    pub fn check(&self) -> Result<(), Failure> {
        self.check_said_once(&[
            ("--size", "size", self.size.is_some()),
            ("--spp", "spp", self.spp.is_some()),
            ("--seed", "seed", self.seed.is_some()),
        ])?;
        let mut settings = RenderSettings::default();
        for assignment in self.of_settings() {
            assignment.check(&mut settings)?;
        }
        if self.of_settings().any(Assignment::is_change) {
            return Ok(());
        }
        self.apply_settings(&mut RenderSettings::default())
    }

    fn of_settings(&self) -> impl Iterator<Item = &Assignment> {
        self.set.iter().filter(|set| !set.is_of_entity())
    }

    /// Refuses a `--set` of what a flag of its own says, too: one of the two would count for nothing. A flag, its setting,
    /// and whether it is given.
    pub fn check_said_once(&self, flags: &[(&str, &str, bool)]) -> Result<(), Failure> {
        let is_set = |path: &str| self.set.iter().any(|set| set.parts().0 == path);
        match flags.iter().find(|(_, path, given)| *given && is_set(path)) {
            Some((flag, path, _)) => Err(Failure::Usage(format!(
                "{flag} and --set {path} say the same: give one of them"
            ))),
            None => Ok(()),
        }
    }

    /// Writes the flags into a scene. Values out of range are an error.
    pub fn apply(&self, world: &mut World) -> Result<(), Failure> {
        for assignment in self.set.iter().filter(|set| set.is_of_entity()) {
            set_on_entity(world, assignment)?;
        }
        self.apply_settings(&mut world.resource_mut::<RenderSettings>())
    }

    /// Whether one of the flags says how many samples a pixel has.
    pub fn give_spp(&self) -> bool {
        self.spp.is_some() || self.set.iter().any(|set| set.parts().0 == "spp")
    }

    fn apply_settings(&self, settings: &mut RenderSettings) -> Result<(), Failure> {
        let before = range_problems(settings);
        for assignment in self.of_settings() {
            assignment.apply(settings)?;
        }
        if let Some(size) = self.size {
            settings.size = size;
        }
        if let Some(spp) = self.spp {
            settings.spp = spp;
        }
        if let Some(seed) = self.seed {
            settings.seed = seed;
        }
        // What the scene itself has wrong is not the command line's fault.
        match range_problems(settings)
            .into_iter()
            .find(|problem| !before.contains(problem))
        {
            Some(problem) => Err(Failure::Usage(problem.to_string())),
            None => Ok(()),
        }
    }
}

/// Refuses settings of a scene that nothing can be rendered with.
pub(super) fn check_scene(name: &str, settings: &RenderSettings) -> Result<(), Failure> {
    match range_problems(settings).first() {
        Some(problem) => Err(Failure::Scene(format!("{name}: settings: {problem}"))),
        None => Ok(()),
    }
}

/// The list of all settings for `--help`.
pub(super) fn list() -> String {
    let defaults = RenderSettings::default();
    let mut text = String::from("Settings for --set (path, default, range):\n");
    text += &table(&SETTINGS, &defaults);
    text += "\nA component of an entity by its name: --set Lamp/PointLamp.intensity=3. Numbers are sums, with units: \
             2*10cm, 30deg, +=1/2.\n";
    text
}

/// A line for each property: its path, its value, what it does, and what it may be.
pub(super) fn table(properties: &[Property], values: &impl GetPath) -> String {
    let rows: Vec<[String; 4]> = properties
        .iter()
        .map(|property| {
            [
                property.path.clone(),
                property.value_text(values),
                property.range_text(),
                property.says.clone(),
            ]
        })
        .collect();
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let (path, default) = (width(0), width(1));
    let mut text = String::new();
    for row in &rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  {:path$}  {:default$}  {} ({})",
            row[0], row[1], row[3], row[2]
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::FromArgMatches;

    fn args(flags: &[&str]) -> SettingArgs {
        let command = SettingArgs::augment_args(clap::Command::new("glassbox"));
        let words = ["glassbox"].iter().chain(flags);
        let matches = command.try_get_matches_from(words).unwrap();
        SettingArgs::from_arg_matches(&matches).unwrap()
    }

    #[test]
    fn a_change_of_what_the_scene_has_is_judged_with_the_scene() {
        let mut world = World::new();
        let mut scene = RenderSettings::default();
        (scene.sampling.time, scene.spp) = (60.0, 1000);
        world.insert_resource(scene);
        for (flags, done) in [
            (&["--set", "sampling.time-=59.5"][..], true),
            (&["--set", "spp-=999"], true),
            (&["--set", "spp/=1000"], true),
            (&["--set", "spp-=1000"], false),
            (&["--set", "spp-=1001"], false),
            (&["--set", "sampling.time-=61"], false),
            (&["--set", "spp=0", "--set", "spp+=4"], true),
        ] {
            let args = args(flags);
            assert!(args.check().is_ok(), "{flags:?}");
            let mut world_now = World::new();
            world_now.insert_resource(world.resource::<RenderSettings>().clone());
            assert_eq!(args.apply(&mut world_now).is_ok(), done, "{flags:?}");
        }
        // Wrong for any scene.
        for flags in [
            ["--set", "spp*=many"],
            ["--set", "spp/=0"],
            ["--set", "sampling.tim-=1"],
            ["--set", "sampling.time*=x"],
            ["--set", "features.shadows*=2"],
            ["--set", "spp=0"],
        ] {
            assert!(args(&flags).check().is_err(), "{flags:?}");
        }
    }

    #[test]
    fn samples_of_a_pixel_are_given_by_either_flag() {
        for (flags, given) in [
            (&["--spp", "8"][..], true),
            (&["--set", "spp=8"], true),
            (&["--set", "spp*=2"], true),
            (&["--set", "seed=8"], false),
            (&[], false),
        ] {
            assert_eq!(args(flags).give_spp(), given, "{flags:?}");
        }
    }

    #[test]
    fn what_two_flags_say_is_refused() {
        for (flags, says) in [
            (&["--spp", "8", "--set", "spp=8"][..], Some("--set spp")),
            (&["--size", "8x8", "--set", "size=9x9"], Some("--set size")),
            (&["--set", "seed*=2", "--seed", "3"], Some("--set seed")),
            (&["--spp", "8", "--set", "seed=3"], None),
            (&["--set", "spp=8", "--set", "spp*=2"], None),
        ] {
            let why = args(flags).check().err().map(|failure| {
                assert!(matches!(failure, Failure::Usage(_)), "{flags:?}");
                failure.to_string()
            });
            assert_eq!(why.is_some(), says.is_some(), "{flags:?}: {why:?}");
            let holds = |says| why.as_ref().is_some_and(|why| why.contains(says));
            assert!(says.is_none_or(holds), "{flags:?}: {why:?}");
        }
    }

    #[test]
    fn the_list_names_every_setting_with_its_default_and_range() {
        let list = list();
        for setting in SETTINGS.iter() {
            let line = list
                .lines()
                .find(|line| line.trim_start().starts_with(&format!("{} ", setting.path)))
                .unwrap_or_else(|| panic!("{} is not in the list", setting.path));
            assert!(line.contains(&setting.range_text()), "{line}");
            assert!(
                line.contains(&setting.value_text(&RenderSettings::default())),
                "{line}"
            );
        }
    }
}
