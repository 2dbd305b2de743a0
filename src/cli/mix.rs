//! `glassbox merge --gain`: another mix of a picture whose light is kept apart.

use super::Failure;
use super::merge::Merge;
use super::output::{check_room, say, tell};
use super::shown::read_output;
use crate::io::{LightLayers, Limits, PictureFormat, check_picture, layer_name, write_rendered};
use crate::scene::Output;
use bevy::math::Vec3;
use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

/// `Lamp=2` or `Lamp=2,1,.5`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Gain {
    light: String,
    factor: Vec3,
    /// As it was given.
    text: String,
}

impl FromStr for Gain {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const FORM: &str =
            "it is written LIGHT=FACTOR or LIGHT=RED,GREEN,BLUE, for example Lamp=2 or Lamp=2,1,.5";
        let (light, factor) = text.rsplit_once('=').ok_or(FORM)?;
        let number = |text: &str| -> Result<f32, String> {
            let number: f32 = text.trim().parse().map_err(|_| FORM.to_owned())?;
            // Asked so that NaN is refused too.
            match number >= 0.0 && number.is_finite() {
                true => Ok(number),
                false => Err(format!(
                    "`{}` is no factor: that is a number from 0 to {:e}",
                    text.trim(),
                    f32::MAX
                )),
            }
        };
        let parts: Vec<f32> = factor.split(',').map(number).collect::<Result<_, _>>()?;
        let factor = match parts[..] {
            [one] => Vec3::splat(one),
            [red, green, blue] => Vec3::new(red, green, blue),
            _ => return Err(FORM.into()),
        };
        Ok(Self {
            light: light.trim().to_owned(),
            factor,
            text: text.trim().to_owned(),
        })
    }
}

/// Mixes the one file that is given.
pub(super) fn run(args: &Merge, format: PictureFormat) -> Result<(), Failure> {
    let [file] = &args.parts[..] else {
        return Err(Failure::Usage(format!(
            "--gain mixes one picture that `render --lights-separately` wrote, and {} are given",
            args.parts.len()
        )));
    };
    let limits = Limits {
        memory: args.memory.budget(),
        ..Limits::default()
    };
    let mut lights = LightLayers::read(file, &limits)?;
    let size = lights.picture.size();
    let [width, height] = size.to_array().map(u64::from);
    check_picture(&args.output, width, height).map_err(Failure::of_output)?;
    let layers = match format {
        // The picture itself beside its layers.
        PictureFormat::Exr => 1 + lights.layers.len() as u64,
        _ => 1,
    };
    let bytes = format.picture_bytes(width, height).saturating_mul(layers);
    check_room(&args.output, bytes, args.quiet)?;
    let factors = factors(file, &lights, &args.gain)?;
    let output = output_of(file, &lights)?;
    let clamped = lights.mix(&factors);
    let given: Vec<&str> = args.gain.iter().map(|gain| gain.text.as_str()).collect();
    let given = given.join(" ");
    if format == PictureFormat::Exr {
        lights.write(&args.output, &format!("Mix: {given}"))?;
    } else {
        write_rendered(
            &args.output,
            &lights.picture,
            &output,
            &[("Mix", given.clone())],
        )?;
    }
    if clamped > 0 && !args.quiet {
        let text = format!(
            "{clamped} pixels are brighter than a file can say, and are as bright as it can"
        );
        tell("warning", text);
    }
    if args.quiet {
        return Ok(());
    }
    say(format_args!(
        "{}: {}x{}, {given}",
        args.output.display(),
        size.x,
        size.y
    ))
}

/// Of each layer that is named its factor.
fn factors(
    file: &Path,
    lights: &LightLayers,
    gains: &[Gain],
) -> Result<BTreeMap<String, Vec3>, Failure> {
    let mut factors = BTreeMap::new();
    for gain in gains {
        let name = layer_name(&gain.light);
        if !lights.layers.contains_key(&name) {
            let names: Vec<&str> = lights.layers.keys().map(String::as_str).collect();
            return Err(Failure::Usage(format!(
                "--gain {}: {} has no light `{}`; it has {}",
                gain.text,
                file.display(),
                gain.light,
                names.join(", ")
            )));
        }
        if factors.insert(name, gain.factor).is_some() {
            return Err(Failure::Usage(format!(
                "--gain {}: `{}` is given twice",
                gain.text, gain.light
            )));
        }
    }
    Ok(factors)
}

/// How the picture is shown: as the settings say that the file names.
fn output_of(file: &Path, lights: &LightLayers) -> Result<Output, Failure> {
    let mut lines = lights.comments.iter();
    let settings = lines.find_map(|line| line.strip_prefix("Settings: "));
    let words = settings.unwrap_or_default().split_whitespace();
    let words: Vec<&str> = words.filter(|word| word.starts_with("output.")).collect();
    Ok(read_output(file, &words.join(" "))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_a_factor_or_three_and_nothing_else() {
        let gain = |text: &str| text.parse::<Gain>();
        assert_eq!(gain("Lamp=2").unwrap().factor, Vec3::splat(2.0));
        let gain_of_colour = gain("a=b = 2, 1,.5").unwrap();
        assert_eq!(gain_of_colour.factor, Vec3::new(2.0, 1.0, 0.5));
        assert_eq!(gain_of_colour.light, "a=b");
        assert_eq!(gain("Lamp=0").unwrap().factor, Vec3::ZERO);
        assert_eq!(gain("Lamp=1e30").unwrap().factor, Vec3::splat(1e30));
        for text in ["Lamp", "Lamp=", "Lamp=x", "Lamp=1,2", "Lamp=1,2,3,4"] {
            let error = gain(text).unwrap_err();
            assert!(error.contains("LIGHT=FACTOR"), "{text}: {error}");
        }
        for text in [
            "Lamp=NaN",
            "Lamp=-1",
            "Lamp=inf",
            "Lamp=1,-0.5,1",
            "Lamp=1e39",
        ] {
            let error = gain(text).unwrap_err();
            assert!(error.contains("is no factor"), "{text}: {error}");
        }
    }
}
