//! The two kinds of URI that glTF uses: a relative path with `%` escapes, and data (RFC 2397), nearly always in base64.

use crate::io::file_name::unescaped;

/// The bytes of a `data:` URI; `None` where it is not one, or is damaged.
pub(super) fn data_of(uri: &str) -> Option<Vec<u8>> {
    if !is_data(uri) {
        return None;
    }
    let (head, text) = uri.split_once(',')?;
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Some(unescaped(text));
    }
    // As in any URI, what is no letter or digit may be escaped.
    let unescaped = text.contains('%').then(|| unescaped(text));
    let text = unescaped.as_deref().unwrap_or(text.as_bytes());
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut count) = (0_u32, 0);
    for &character in text {
        if character == b'=' || character.is_ascii_whitespace() {
            continue;
        }
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

/// The value of a base64 digit (RFC 4648, section 4, and section 5, which some libraries take).
fn digit(character: u8) -> Option<u8> {
    match character {
        b'A'..=b'Z' => Some(character - b'A'),
        b'a'..=b'z' => Some(character - b'a' + 26),
        b'0'..=b'9' => Some(character - b'0' + 52),
        b'+' | b'-' => Some(62),
        b'/' | b'_' => Some(63),
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
    const SCHEME: &str = "data:";
    let start = uri.get(..SCHEME.len());
    start.is_some_and(|start| start.eq_ignore_ascii_case(SCHEME))
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
        for uri in [
            "DATA:a;BASE64,Zm8=",
            "data:a;charset=utf-8;base64,Zm8%3D",
            "data:;base64,\n Z\tm8=\r\n",
        ] {
            assert_eq!(data_of(uri).as_deref(), Some(&b"fo"[..]), "{uri}");
        }
        assert_eq!(data_of("data:a;base64,-_-_"), data_of("data:a;base64,+/+/"));
        assert_eq!(data_of("data:a;base64,Zm9*"), None);
        assert_eq!(data_of("a;base64,Zm9v"), None);
    }

    #[test]
    fn data_without_base64_is_what_stands_there_and_its_escapes() {
        for uri in ["data:a,fo%89%00%2co", "DATA:,fo%89%00,o"] {
            assert_eq!(data_of(uri).as_deref(), Some(&b"fo\x89\0,o"[..]), "{uri}");
        }
    }

    #[test]
    fn escapes_in_paths_are_undone_and_lone_percent_signs_stay() {
        assert_eq!(path_of("a%20b%2Fc.png"), "a b/c.png");
        assert_eq!(path_of("100%"), "100%");
        assert_eq!(path_of("%zz"), "%zz");
        assert_eq!(path_of("a%FF.png"), "a%FF.png", "no text");
    }
}
