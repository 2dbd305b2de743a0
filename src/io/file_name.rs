//! Names of files as scenes say them.
//!
//! A scene names a file by its path, and part of one by `#` and the part: `model.glb#texture0`. Names may hold
//! anything, so what a scene could not say, or what would mean something else on another system, stands as
//! `%` and two hexadecimal digits for a byte, as in a URI (RFC 3986, section 2.1): `\`, `:`, bytes that are no
//! UTF-8, `%` itself before two such digits, and a `#` that would begin a part. All else stands as it is.
//!
//! Scenes that were written by hand say `%` and mean it: a path is first taken as it stands, and its escapes are
//! undone where there is no such file.

use std::ffi::{OsStr, OsString};
use std::path::{Component, Path, PathBuf};

/// How the path of a picture begins that Glassbox generates.
pub(crate) const BUILTIN: &str = "builtin:";

/// A picture's path, and the part of the file after its last `#`: `texture` and a number, `alpha`, or both with a dot
/// between. Any other `#` belongs to the path, and the part is empty.
pub(crate) fn split_fragment(path: &str) -> (&str, &str) {
    match path.rsplit_once('#') {
        Some((file, part)) if is_part(part) => (file, part),
        _ => (path, ""),
    }
}

fn is_part(part: &str) -> bool {
    let texture = part.strip_suffix(".alpha").unwrap_or(part);
    let number = texture.strip_prefix("texture");
    part == "alpha"
        || number.is_some_and(|n| !n.is_empty() && n.bytes().all(|byte| byte.is_ascii_digit()))
}

/// A file's name, one part of a path, as a scene says it.
pub(crate) fn encoded(name: &OsStr) -> String {
    let mut out = String::with_capacity(name.len());
    let bytes = name.as_encoded_bytes();
    let mut done = 0;
    for chunk in bytes.utf8_chunks() {
        for character in chunk.valid().chars() {
            let after = &bytes[done + character.len_utf8()..];
            match character {
                '\\' | ':' => escape(&mut out, character as u8),
                '%' if hex(after).is_some() => escape(&mut out, b'%'),
                _ => out.push(character),
            }
            done += character.len_utf8();
        }
        for &byte in chunk.invalid() {
            escape(&mut out, byte);
        }
        done += chunk.invalid().len();
    }
    let (file, part) = split_fragment(&out);
    if !part.is_empty() {
        out = format!("{file}%23{part}");
    }
    out
}

fn escape(out: &mut String, byte: u8) {
    out.push_str(&format!("%{byte:02X}"));
}

/// The byte that the first two letters say.
fn hex(text: &[u8]) -> Option<u8> {
    let digits = text.get(..2)?;
    if !digits.iter().all(u8::is_ascii_hexdigit) {
        return None;
    }
    let digits = std::str::from_utf8(digits).ok()?;
    u8::from_str_radix(digits, 16).ok()
}

/// Undoes the escapes of a path; `None` where it has none, or where what one stands for is no part of a name here:
/// nothing that is escaped leads to another folder.
pub(crate) fn decoded(path: &str) -> Option<PathBuf> {
    let escaped = |i: usize| path.as_bytes()[i] == b'%' && hex(&path.as_bytes()[i + 1..]).is_some();
    if !(0..path.len()).any(escaped) {
        return None;
    }
    let mut out = PathBuf::from(if path.starts_with('/') { "/" } else { "" });
    for part in path.split('/').filter(|part| !part.is_empty()) {
        let name = decoded_name(part)?;
        let mut parts = Path::new(&name).components();
        let is_name = matches!(
            (parts.next(), parts.next()),
            (Some(Component::Normal(only)), None) if only == name
        );
        if !is_name && name != part {
            return None;
        }
        out.push(name);
    }
    Some(out)
}

fn decoded_name(part: &str) -> Option<OsString> {
    let bytes = unescaped(part);
    if bytes.contains(&0) {
        return None;
    }
    of_bytes(bytes)
}

/// The bytes of a text in which `%` and two hexadecimal digits stand for one; what is no escape stays.
pub(crate) fn unescaped(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        match hex(after).filter(|_| first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    bytes
}

#[cfg(unix)]
fn of_bytes(bytes: Vec<u8>) -> Option<OsString> {
    Some(std::os::unix::ffi::OsStringExt::from_vec(bytes))
}

#[cfg(not(unix))]
fn of_bytes(bytes: Vec<u8>) -> Option<OsString> {
    String::from_utf8(bytes).ok().map(OsString::from)
}

/// The path of a file in a model file, where no picture is generated.
pub(crate) fn of_file(path: String) -> String {
    match path.starts_with(BUILTIN) {
        true => format!("./{path}"),
        false => path,
    }
}

/// Whether a path can stand in a line of an OBJ or MTL file, where nothing is escaped, and be read again.
pub(crate) fn fits_a_line(path: &str) -> bool {
    let is_clean = !path.contains(|c: char| c.is_control() || c == '\\');
    // What begins with a dash is an option there.
    is_clean && !path.is_empty() && path.trim() == path && !path.starts_with('-')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_file_can_have_inside_is_a_part_of_it() {
        for (path, file, part) in [
            ("a.glb#texture0", "a.glb", "texture0"),
            ("a#b.glb#texture12.alpha", "a#b.glb", "texture12.alpha"),
            ("a#b.png#alpha", "a#b.png", "alpha"),
            ("a#b.png", "a#b.png", ""),
            ("#.png", "#.png", ""),
            ("a.glb#texture", "a.glb#texture", ""),
            ("a.glb#texture1b", "a.glb#texture1b", ""),
        ] {
            assert_eq!(split_fragment(path), (file, part), "{path}");
        }
    }

    #[test]
    fn what_a_scene_could_not_say_is_escaped_and_all_else_stands_as_it_is() {
        for (name, said) in [
            ("a b#c.png", "a b#c.png"),
            (" größe\n.obj", " größe\n.obj"),
            ("100%.png", "100%.png"),
            ("a%20b", "a%2520b"),
            ("a\\b:c", "a%5Cb%3Ac"),
            ("a#alpha", "a%23alpha"),
        ] {
            assert_eq!(encoded(OsStr::new(name)), said);
            let back = decoded(said).unwrap_or_else(|| said.into());
            assert_eq!(back, Path::new(name));
        }
    }

    #[cfg(unix)]
    #[test]
    fn bytes_that_are_no_text_come_back() {
        use std::os::unix::ffi::OsStrExt;
        let name = OsStr::from_bytes(b"a\xff%\xc3.obj");
        let said = encoded(name);
        assert_eq!(said, "a%FF%%C3.obj");
        assert_eq!(decoded(&said).unwrap(), Path::new(name));
    }

    #[test]
    fn nothing_that_is_escaped_leads_elsewhere() {
        for path in [
            "%2e%2e/a", "a/%2E%2e", "a%2Fb", "%2Fetc/a", "a%00b", "%2e/a",
        ] {
            assert_eq!(decoded(path), None, "{path}");
        }
        assert_eq!(decoded("../%41"), Some("../A".into()));
        assert_eq!(decoded("a/./b"), None, "nothing is escaped in it");
    }
}
