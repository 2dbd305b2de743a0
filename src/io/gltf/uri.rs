//! The two kinds of URI that glTF uses: a relative path with `%` escapes, and data in base64.

use crate::io::file_name::unescaped;

/// The bytes of a `data:` URI in base64; `None` where it is not one, or is damaged.
pub(super) fn data_of(uri: &str) -> Option<Vec<u8>> {
    let (head, text) = uri.strip_prefix("data:")?.split_once(',')?;
    if !head.ends_with(";base64") {
        return None;
    }
    let text = text.trim_end_matches('=');
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut count) = (0_u32, 0);
    for &character in text.as_bytes() {
        bits = bits << 6 | u32::from(digit(character)?);
        count += 6;
        if count >= 8 {
            count -= 8;
            // The upper bits were written before.
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

/// The value of a base64 digit (RFC 4648, section 4).
fn digit(character: u8) -> Option<u8> {
    match character {
        b'A'..=b'Z' => Some(character - b'A'),
        b'a'..=b'z' => Some(character - b'a' + 26),
        b'0'..=b'9' => Some(character - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}

/// The path that a URI stands for, as scenes say it: `%20` becomes a space, and so on. What is no escape stays,
/// and escapes that are no text too.
pub(super) fn path_of(uri: &str) -> String {
    String::from_utf8(unescaped(uri)).unwrap_or_else(|_| uri.to_owned())
}

/// Whether a URI is data.
pub(super) fn is_data(uri: &str) -> bool {
    uri.starts_with("data:")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_length_decodes() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYmFy", "foobar"),
        ] {
            let uri = format!("data:application/octet-stream;base64,{text}");
            assert_eq!(data_of(&uri).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(data_of("data:a;base64,Zm9*"), None);
    }

    #[test]
    fn escapes_in_paths_are_undone_and_lone_percent_signs_stay() {
        assert_eq!(path_of("a%20b%2Fc.png"), "a b/c.png");
        assert_eq!(path_of("100%"), "100%");
        assert_eq!(path_of("%zz"), "%zz");
        assert_eq!(path_of("a%FF.png"), "a%FF.png", "no text");
    }
}
