//! A document as it is read: whatever is of another kind than expected is not there, and what nobody asked for is
//! known in the end.

use serde_json::Value;
use std::cell::RefCell;
use std::collections::HashSet;
use std::ops::RangeInclusive;

/// What says nothing about what is shown, or says it twice.
const IRRELEVANT: [&str; 10] = [
    "name",
    "extras",
    "asset",
    "min",
    "max",
    "target",
    "mimeType",
    "doubleSided",
    "extensionsUsed",
    "extensionsRequired",
];

/// The values that were asked for, by their addresses.
#[derive(Default)]
pub(super) struct Marks(RefCell<HashSet<usize>>);

/// A value of the document.
#[derive(Clone, Copy)]
pub(super) struct Json<'a> {
    value: &'a Value,
    marks: &'a Marks,
}

fn address(value: &Value) -> usize {
    std::ptr::from_ref(value).addr()
}

impl<'a> Json<'a> {
    pub fn new(value: &'a Value, marks: &'a Marks) -> Self {
        Self { value, marks }
    }

    /// What stands under a key.
    pub fn get(self, key: &str) -> Option<Self> {
        Some(self.peek(key)?.mark())
    }

    /// What stands under a key, which is not read by that.
    fn peek(self, key: &str) -> Option<Self> {
        let value = self.value.get(key)?;
        Some(Self { value, ..self })
    }

    /// What stands under a key as something that `read` makes of it. What cannot be made into it stays unread.
    fn get_as<T>(self, key: &str, read: impl Fn(Self) -> Option<T>) -> Option<T> {
        let json = self.peek(key)?;
        let read = read(json)?;
        json.mark();
        Some(read)
    }

    /// What an extension adds here.
    pub fn extension(self, name: &str) -> Option<Self> {
        self.get("extensions")?.get(name)
    }

    /// Whether an extension adds something here, which is not read by that.
    pub fn has_extension(self, name: &str) -> bool {
        let extensions = self.get("extensions");
        extensions.is_some_and(|extensions| extensions.value.get(name).is_some())
    }

    /// The elements of a list; none where there is none.
    pub fn list(self, key: &str) -> impl ExactSizeIterator<Item = Self> + 'a {
        let list = self.get_as(key, |list| list.value.as_array());
        let list = list.map_or(&[][..], Vec::as_slice);
        list.iter().map(move |value| Self { value, ..self })
    }

    /// One element of a list.
    pub fn element(self, key: &str, index: usize) -> Option<Self> {
        let value = self.get_as(key, |list| list.value.as_array())?.get(index)?;
        Some(Self { value, ..self }.mark())
    }

    /// What is read is the element itself.
    pub fn mark(self) -> Self {
        self.marks.0.borrow_mut().insert(address(self.value));
        self
    }

    /// All that stands in it is known, and left out.
    pub fn mark_all(self) {
        self.mark();
        let list = self.value.as_array().into_iter().flatten();
        let values = self.value.as_object().into_iter().flatten();
        for value in list.chain(values.map(|(_, value)| value)) {
            Self { value, ..self }.mark_all();
        }
    }

    /// This value as an index or a count. Some programs write `4.0`.
    pub fn whole(self) -> Option<usize> {
        let float = || {
            let value = self.value.as_f64()?;
            // Above this not every integer is a float.
            let is_whole = (0.0..9e15).contains(&value) && value.fract() == 0.0;
            is_whole.then_some(value as u64)
        };
        let value = self.value.as_u64().or_else(float)?;
        usize::try_from(value).ok()
    }

    /// An index or a count under a key.
    pub fn index(self, key: &str) -> Option<usize> {
        self.get_as(key, Self::whole)
    }

    /// An index under a key that is one of these: others mean nothing.
    pub fn one_of(self, key: &str, known: &[usize]) -> Option<usize> {
        self.get_as(key, |json| {
            json.whole().filter(|index| known.contains(index))
        })
    }

    /// Whether a number under a key, or one of a list there, lies outside a range. It is not read by that.
    pub fn is_outside(self, key: &str, range: RangeInclusive<f64>) -> bool {
        let Some(value) = self.value.get(key) else {
            return false;
        };
        let list = value.as_array().map(Vec::as_slice);
        let mut numbers = list
            .unwrap_or(std::slice::from_ref(value))
            .iter()
            .filter_map(Value::as_f64);
        numbers.any(|number| !range.contains(&number))
    }

    /// A number under a key, finite.
    pub fn number(self, key: &str) -> Option<f32> {
        self.get_as(key, Self::finite)
    }

    fn finite(self) -> Option<f32> {
        let value = self.value.as_f64()? as f32;
        value.is_finite().then_some(value)
    }

    /// As many numbers under a key, all finite.
    pub fn numbers<const N: usize>(self, key: &str) -> Option<[f32; N]> {
        self.get_as(key, |json| json.all_finite()?.try_into().ok())
    }

    /// All numbers under a key; `None` where one is none.
    pub fn all_numbers(self, key: &str) -> Option<Vec<f32>> {
        self.get_as(key, Self::all_finite)
    }

    fn all_finite(self) -> Option<Vec<f32>> {
        let list = self.value.as_array()?;
        let number = |value| Self { value, ..self }.finite();
        list.iter().map(number).collect()
    }

    /// Text under a key.
    pub fn text(self, key: &str) -> Option<&'a str> {
        self.get_as(key, Self::as_text)
    }

    /// Whether this is true.
    pub fn is_true(self, key: &str) -> bool {
        self.get_as(key, |json| json.value.as_bool()) == Some(true)
    }

    /// Whether this is a list.
    pub fn is_list(self) -> bool {
        self.value.is_array()
    }

    /// Text itself.
    pub fn as_text(self) -> Option<&'a str> {
        self.value.as_str()
    }

    /// The object that was written by this program, whole.
    pub fn value(self) -> &'a Value {
        self.value
    }

    /// Calls back with the path and the key of everything that stands in what was read and was not read itself.
    /// Elements of lists that nothing refers to are unused, not unread.
    pub fn for_each_unread(self, report: &mut dyn FnMut(&str, &str)) {
        self.unread_below(&mut String::new(), report);
    }

    // As deep as the parser follows: 128 levels.
    fn unread_below(self, path: &mut String, report: &mut dyn FnMut(&str, &str)) {
        let length = path.len();
        let is_read = |value| self.marks.0.borrow().contains(&address(value));
        if let Some(list) = self.value.as_array() {
            for (index, value) in list.iter().enumerate() {
                if is_read(value) {
                    path.push_str(&format!("[{index}]"));
                    Self { value, ..self }.unread_below(path, report);
                    path.truncate(length);
                }
            }
        }
        for (key, value) in self.value.as_object().into_iter().flatten() {
            if IRRELEVANT.contains(&key.as_str()) || value.is_null() {
                continue;
            }
            if !path.is_empty() {
                path.push('.');
            }
            path.push_str(key);
            match (is_read(value), key.as_str()) {
                (true, _) | (_, "extensions") => Self { value, ..self }.unread_below(path, report),
                (false, key) => report(path, key),
            }
            path.truncate(length);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unread(document: &str, read: impl Fn(Json)) -> Vec<(String, String)> {
        let value: Value = serde_json::from_str(document).unwrap();
        let marks = Marks::default();
        let json = Json::new(&value, &marks);
        read(json);
        let mut unread = Vec::new();
        json.for_each_unread(&mut |path, key| unread.push((path.to_owned(), key.to_owned())));
        unread
    }

    #[test]
    fn what_was_not_read_is_known_and_what_is_unused_is_not_meant() {
        let document = r#"{ "asset": {}, "animations": [1], "materials": [
            { "name": "a", "color": [1, 2], "extensions": { "ONE": {}, "TWO": { "x": 1, "y": 2 } } },
            { "unused": 1 }] }"#;
        let unread = unread(document, |json| {
            let material = json.element("materials", 0).unwrap();
            assert_eq!(material.numbers("color"), Some([1.0, 2.0]));
            let two = material.extension("TWO").unwrap();
            assert_eq!(two.number("x"), Some(1.0));
        });
        let paths: Vec<&str> = unread.iter().map(|(path, _)| path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "animations",
                "materials[0].extensions.ONE",
                "materials[0].extensions.TWO.y"
            ]
        );
    }

    #[test]
    fn what_is_of_another_kind_than_it_has_to_be_is_unread() {
        let document = r#"{ "index": -1, "number": "1", "numbers": [1, 2], "all": [1, "x"], "text": 1, "flag": 1,
            "list": {}, "elements": 1, "nothing": null, "good": 1 }"#;
        let unread = unread(document, |json| {
            json.index("index");
            json.number("number");
            json.numbers::<3>("numbers");
            json.all_numbers("all");
            json.text("text");
            json.is_true("flag");
            assert_eq!(json.list("list").len(), 0);
            json.element("elements", 0);
            json.index("nothing");
            // One of two ways is enough.
            json.text("good");
            json.index("good");
        });
        let mut paths: Vec<&str> = unread.iter().map(|(path, _)| path.as_str()).collect();
        paths.sort_unstable();
        let all = "all elements flag index list number numbers text";
        assert_eq!(paths.join(" "), all);
    }

    #[test]
    fn what_is_of_another_kind_is_not_there() {
        let value: Value = serde_json::from_str(
            r#"{ "a": 4.0, "b": -1, "c": 1.5, "d": "x", "e": [1, "x"], "f": 1e300, "g": 18446744073709551615 }"#,
        )
        .unwrap();
        let marks = Marks::default();
        let json = Json::new(&value, &marks);
        assert_eq!(json.index("a"), Some(4));
        for key in ["b", "c", "d", "e", "f", "none"] {
            assert_eq!(json.index(key), None, "{key}");
        }
        assert_eq!(json.index("g"), usize::try_from(u64::MAX).ok());
        assert_eq!(json.number("f"), None);
        assert_eq!(json.numbers::<2>("e"), None);
        assert_eq!(json.list("d").len(), 0);
    }
}
