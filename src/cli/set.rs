//! `--set key=value`: any setting by its reflected path.

use super::Failure;
use super::similar::unknown;
use crate::inspect::InspectSettings;
use crate::scene::schema::{Unit, typed_number};
use crate::scene::{Property, RenderSettings};
use bevy::color::LinearRgba;
use bevy::math::{UVec2, Vec2, Vec3};
use bevy::reflect::enums::{DynamicEnum, DynamicVariant, VariantInfo};
use bevy::reflect::{GetPath, PartialReflect, Reflect, TypeInfo, Typed};
use std::fmt;
use std::str::FromStr;

/// `key=value` as it stands on the command line. The value of `spp*=2` begins with its sign: `*=2`.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    key: String,
    value: String,
}

/// The signs of which one before `=` changes what there is.
const SIGNS: [char; 4] = ['+', '-', '*', '/'];

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let places = text.match_indices('=').map(|(place, _)| place);
        let first = places.clone().next();
        let first = first.ok_or("it is written key=value, for example max_depth=8")?;
        // Names of entities may hold the sign themselves.
        let mut places = places.rev();
        let place = places.find(|&place| names_component(key_and_sign(&text[..place]).0));
        let place = place.unwrap_or(first);
        let (key, sign) = key_and_sign(&text[..place]);
        let value = text[place + 1..].trim();
        let value = match sign {
            "" => value.to_owned(),
            sign => format!("{sign}={value}"),
        };
        Ok(Self {
            key: key.to_owned(),
            value,
        })
    }
}

/// What stands before `=`, without the sign of a change, and that sign or nothing.
fn key_and_sign(text: &str) -> (&str, &str) {
    let text = text.trim();
    match text.strip_suffix(SIGNS) {
        Some(key) => (key.trim_end(), &text[key.len()..]),
        None => (text, ""),
    }
}

/// Whether it ends as `Lamp/PointLamp.intensity` does: with a component, and a path in it.
fn names_component(key: &str) -> bool {
    let is_of_path = |c: char| c.is_alphanumeric() || "._[]".contains(c);
    key.rsplit_once('/').is_some_and(|(_, path)| {
        path.starts_with(char::is_uppercase) && path.chars().all(is_of_path)
    })
}

impl fmt::Display for Assignment {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let between = if self.is_change() { "" } else { "=" };
        write!(f, "{}{between}{}", self.key, self.value)
    }
}

impl Assignment {
    /// Its parts: what is set, and to what.
    pub fn parts(&self) -> (&str, &str) {
        (&self.key, &self.value)
    }

    /// Whether it is about a component of an entity: `Lamp/PointLamp.intensity=3`.
    pub fn is_of_entity(&self) -> bool {
        self.key.contains('/')
    }

    /// Whether it changes what there is, so that what comes of it is known with the scene alone: `spp*=2`.
    pub fn is_change(&self) -> bool {
        let after = self.value.strip_prefix(SIGNS);
        after.is_some_and(|after| after.starts_with('='))
    }

    /// Writes the value into settings that need not be the scene's: an error is what is wrong with any.
    pub fn check(&self, settings: &mut RenderSettings) -> Result<(), Failure> {
        let written = self.apply(settings);
        let is_whole = |field: &dyn PartialReflect| {
            field.try_downcast_ref::<u32>().is_some() || field.try_downcast_ref::<u64>().is_some()
        };
        match settings.reflect_path(self.key.as_str()) {
            // Whether a whole number comes of it, and one that is not below 0, depends on what there is.
            Ok(field) if self.is_change() && is_whole(field) => {
                let number = typed_number(&self.value, Unit::NONE, 1.0, 1.0);
                number.map(|_| ()).or(written)
            }
            _ => written,
        }
    }

    /// Writes the value into the settings. Ranges are checked afterwards, all together.
    pub fn apply(&self, settings: &mut RenderSettings) -> Result<(), Failure> {
        self.write_into(settings, "--set", "glassbox render --help")
    }

    /// Writes the value into what is drawn.
    pub fn apply_gizmo(&self, settings: &mut InspectSettings) -> Result<(), Failure> {
        self.write_into(settings, "--gizmo", "glassbox inspect --help")
    }

    fn write_into<T: Reflect + Typed>(
        &self,
        settings: &mut T,
        flag: &str,
        help: &str,
    ) -> Result<(), Failure> {
        let key = &self.key;
        let all = Property::all(T::type_info());
        let property = Property::of(T::type_info(), key);
        let field = settings.reflect_path_mut(key.as_str()).ok();
        let (Some(property), Some(field)) = (property, field) else {
            let paths = all.iter().map(|property| property.path.as_str());
            let text = unknown(&format!("{flag} {key}"), "setting", key, paths);
            return Err(Failure::Usage(format!("{text} (all: {help})")));
        };
        set_value(field, &property, &self.value)
            .map_err(|why| Failure::Usage(format!("{flag} {self}: {why}")))
    }
}

/// Writes a value, as text, into what is at a path; on failure, what would have been right.
pub(super) fn set_value(
    field: &mut dyn PartialReflect,
    property: &Property,
    value: &str,
) -> Result<(), String> {
    if let TypeInfo::Struct(info) = property.kind
        && !is_value(field)
    {
        let fields = info.field_names().join(", ");
        return Err(format!(
            "it is a group; choose one of its settings: {fields}"
        ));
    }
    let unit = property
        .quantity
        .map_or(Unit::NONE, |quantity| quantity.unit);
    // What is kept is what is written: radians where nothing else is said.
    let number = |text: &str, before: f32| -> Result<f32, String> {
        // Exact where f64 is not; NaN and what is too large are refused with the range.
        if let Ok(number) = text.trim().parse() {
            return Ok(number);
        }
        let number = typed_number(text, unit, 1.0, f64::from(before));
        number
            .map(|number| number as f32)
            .map_err(|why| format!("wanted a number: {why}"))
    };
    // `*=2` changes each of the numbers that there are, `*=1,1,2` each by its own.
    let numbers = |before: &[f32]| -> Result<Vec<f32>, String> {
        let (sign, listed) = value.split_at(value.find('=').map_or(0, |at| at + 1));
        let mut parts: Vec<&str> = listed.split(',').collect();
        if parts.len() == 1 && !sign.is_empty() {
            parts = vec![parts[0]; before.len()];
        }
        if parts.len() != before.len() {
            return Err(format!(
                "wanted {} numbers, with commas between",
                before.len()
            ));
        }
        let all = parts.iter().zip(before);
        all.map(|(part, before)| number(&format!("{sign}{part}"), *before))
            .collect()
    };
    let whole = |before: u64, most: u64, wanted: &str| {
        // Exact where f64 is not.
        if let Ok(number) = value.parse::<u64>()
            && number <= most
        {
            return Ok(number);
        }
        let number = typed_number(value, unit, 1.0, before as f64);
        let number = number
            .ok()
            .filter(|number| number.fract() == 0.0 && *number >= 0.0 && *number <= most as f64);
        number
            .map(|number| number as u64)
            .ok_or_else(|| format!("wanted {wanted}"))
    };
    if let Some(place) = field.try_downcast_mut::<bool>() {
        *place = value.parse().map_err(|_| "wanted true or false")?;
    } else if let Some(place) = field.try_downcast_mut::<u32>() {
        let wanted = "a whole number from 0 to 4294967295";
        let number = whole((*place).into(), u32::MAX.into(), wanted)?;
        *place = u32::try_from(number).map_err(|_| format!("wanted {wanted}"))?;
    } else if let Some(place) = field.try_downcast_mut::<u64>() {
        *place = whole(*place, u64::MAX, "a whole number")?;
    } else if let Some(place) = field.try_downcast_mut::<f32>() {
        *place = number(value, *place)?;
    } else if let Some(place) = field.try_downcast_mut::<UVec2>() {
        *place = parse_size(value).map_err(|wanted| format!("wanted {wanted}"))?;
    } else if let Some(place) = field.try_downcast_mut::<Vec2>() {
        *place = Vec2::from_slice(&numbers(&place.to_array())?);
    } else if let Some(place) = field.try_downcast_mut::<Vec3>() {
        *place = Vec3::from_slice(&numbers(&place.to_array())?);
    } else if let Some(place) = field.try_downcast_mut::<LinearRgba>() {
        let numbers = numbers(&[place.red, place.green, place.blue])?;
        *place = LinearRgba::rgb(numbers[0], numbers[1], numbers[2]);
    } else {
        set_choice(field, value)?;
    }
    Ok(())
}

/// One of the names of an enum.
fn set_choice(field: &mut dyn PartialReflect, value: &str) -> Result<(), String> {
    let Some(TypeInfo::Enum(info)) = field.get_represented_type_info() else {
        return Err("it is another kind of value than the command line can write".into());
    };
    let units = info
        .iter()
        .filter(|variant| matches!(variant, VariantInfo::Unit(_)));
    let names: Vec<&str> = units.map(|variant| variant.name()).collect();
    let name = names
        .iter()
        .find(|name| name.eq_ignore_ascii_case(value))
        .ok_or_else(|| format!("wanted one of {}", names.join(", ")))?;
    field
        .try_apply(&DynamicEnum::new(*name, DynamicVariant::Unit))
        .map_err(|error| error.to_string())
}

/// A struct that is written as a whole.
fn is_value(field: &dyn PartialReflect) -> bool {
    field.try_downcast_ref::<UVec2>().is_some()
        || field.try_downcast_ref::<Vec2>().is_some()
        || field.try_downcast_ref::<Vec3>().is_some()
        || field.try_downcast_ref::<LinearRgba>().is_some()
}

/// `WxH`, both whole numbers; whether they are in range is not asked here.
pub(super) fn parse_size(text: &str) -> Result<UVec2, String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X', ','])?;
        Some(UVec2::new(
            width.trim().parse().ok()?,
            height.trim().parse().ok()?,
        ))
    };
    parse().ok_or_else(|| "WxH in pixels, for example 800x600".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Builder, SETTINGS};

    fn set(text: &str) -> Result<RenderSettings, String> {
        let mut settings = RenderSettings::default();
        let assignment: Assignment = text.parse()?;
        assignment
            .apply(&mut settings)
            .map_err(|failure| failure.to_string())?;
        Ok(settings)
    }

    #[test]
    fn every_row_of_the_table_can_be_set_to_another_value_and_read_back() {
        for setting in SETTINGS.iter() {
            let default = setting.value_text(&RenderSettings::default());
            let choices = setting.choices();
            let other = match setting.kind {
                kind if kind.is::<u32>() => "7".to_owned(),
                kind if kind.is::<f32>() => "2.5".to_owned(),
                kind if kind.is::<bool>() => (default != "true").to_string(),
                kind if kind.is::<UVec2>() => "3x4".to_owned(),
                _ => {
                    let other = choices.iter().find(|choice| choice.name != default);
                    other.unwrap().name.to_lowercase()
                }
            };
            let settings = set(&format!("{}={other}", setting.path)).unwrap();
            let value = setting.value_text(&settings);
            assert!(
                value.eq_ignore_ascii_case(&other),
                "{}: {value}",
                setting.path
            );
        }
    }

    #[test]
    fn numbers_are_sums_have_units_and_change_what_there_was() {
        assert_eq!(set("spp=2*8").unwrap().spp, 16);
        assert_eq!(
            set("spp*=2").unwrap().spp,
            2 * RenderSettings::default().spp
        );
        assert_eq!(set("sampling.time=2min").unwrap().sampling.time, 120.0);
        assert_eq!(set("output.exposure-=1/2").unwrap().output.exposure, -0.5);
        for (text, part) in [
            ("sampling.time=2m", "“m” is no unit here"),
            ("output.exposure=1/0", "divided by 0"),
            ("spp=1/2", "a whole number"),
        ] {
            let error = set(text).unwrap_err();
            assert!(error.contains(part), "`{text}` gives `{error}`");
        }
    }

    #[test]
    fn names_of_entities_may_hold_what_parts_key_and_value() {
        for (text, key, value) in [
            ("spp=1/2", "spp", "1/2"),
            ("jitter *= 0.5", "jitter", "*=0.5"),
            ("spp=+=3", "spp", "+=3"),
            ("a=b/PointLamp.intensity=3", "a=b/PointLamp.intensity", "3"),
            (
                "a/B=c/Phong.diffuse-=0.1,0,0",
                "a/B=c/Phong.diffuse",
                "-=0.1,0,0",
            ),
            (
                "Lamp/Transform.translation.x = 1/2",
                "Lamp/Transform.translation.x",
                "1/2",
            ),
            ("Lamp/lens.samples=3", "Lamp/lens.samples", "3"),
        ] {
            let assignment: Assignment = text.parse().unwrap();
            assert_eq!(assignment.parts(), (key, value), "{text}");
        }
        let told = |text: &str| text.parse::<Assignment>().unwrap().to_string();
        assert_eq!(told("jitter*=0.5"), "jitter*=0.5");
        assert_eq!(told("jitter=0.5"), "jitter=0.5");
        let error = set("jitter*=0.3").unwrap_err();
        assert!(error.starts_with("--set jitter*=0.3: "), "{error}");
    }

    #[test]
    fn a_change_of_a_vector_changes_each_of_its_numbers() {
        let property = Property {
            kind: Vec3::type_info(),
            ..Property::of(RenderSettings::type_info(), "output.exposure").unwrap()
        };
        let color = LinearRgba::rgb(4.0, 2.0, 1.0);
        let set = |value: &str| {
            let (mut place, mut shade) = (Vec3::new(4.0, 2.0, 1.0), color);
            set_value(&mut place, &property, value)?;
            set_value(&mut shade, &property, value)?;
            assert_eq!(shade, LinearRgba::rgb(place.x, place.y, place.z));
            Ok::<_, String>(place)
        };
        assert_eq!(set("*=0.5,0.5,2"), Ok(Vec3::new(2.0, 1.0, 2.0)));
        assert_eq!(set("*=0.5"), Ok(Vec3::new(2.0, 1.0, 0.5)));
        assert_eq!(set("+=0, 1 ,0"), Ok(Vec3::new(4.0, 3.0, 1.0)));
        assert_eq!(set("0,1,0"), Ok(Vec3::Y));
        for bad in ["*=1,2", "1", "*="] {
            assert!(set(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn parts_of_a_vector_have_paths_too() {
        assert_eq!(set("size.x=5").unwrap().size.x, 5);
        assert_eq!(set("tree.builder=SAH").unwrap().tree.builder, Builder::Sah);
    }

    #[test]
    fn what_cannot_be_set_says_what_would_be_right() {
        for (text, part) in [
            ("shadows=false", "features.shadows"),
            ("max_dept=3", "max_depth"),
            ("features.shadow=true", "features.shadows"),
            (
                "features=true",
                "choose one of its settings: shading, mirrors",
            ),
            ("spp=many", "a whole number"),
            ("spp=-1", "a whole number"),
            ("features.shadows=1", "true or false"),
            ("size=0", "WxH"),
            ("tree.builder=fast", "one of None, Median, Sah, Ploc"),
            ("spp", "key=value"),
            ("=3", "choose one of its settings"),
        ] {
            let error = set(text).unwrap_err();
            assert!(error.contains(part), "`{text}` gives `{error}`");
        }
    }
}
