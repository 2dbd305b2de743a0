//! Numbers that JSON cannot say. Python's `json` writes them all the same, and reads them.

/// The text with `null` in the place of each; `None` where there are none.
pub(super) fn without_them(text: &[u8]) -> Option<Vec<u8>> {
    const NAMES: [&[u8]; 6] = [b"-Infinity", b"Infinity", b"-NaN", b"NaN", b"-inf", b"nan"];
    let mut mended = Vec::with_capacity(text.len());
    let mut found = false;
    let mut is_in_string = false;
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        let name = match is_in_string {
            true => None,
            false => NAMES.iter().find(|name| text[at..].starts_with(name)),
        };
        if let Some(name) = name {
            mended.extend(b"null");
            at += name.len();
            found = true;
            continue;
        }
        mended.push(byte);
        at += 1;
        match byte {
            b'"' => is_in_string = !is_in_string,
            b'\\' if is_in_string => {
                mended.extend(text.get(at));
                at += 1;
            }
            _ => {}
        }
    }
    found.then_some(mended)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_none_become_null_and_texts_stay() {
        for (text, expected) in [
            (r#"[NaN, -Infinity,Infinity]"#, Some("[null, null,null]")),
            (r#"{"NaN": nan}"#, Some(r#"{"NaN": null}"#)),
            (r#"{"a\"NaN": -1}"#, None),
            (r#"{"a\\": NaN}"#, Some(r#"{"a\\": null}"#)),
            (r#"["NaN"#, None),
            (r#"["\"#, None),
            ("", None),
        ] {
            let found = without_them(text.as_bytes());
            let found = found.map(|found| String::from_utf8(found).unwrap());
            assert_eq!(found.as_deref(), expected, "{text}");
        }
    }
}
