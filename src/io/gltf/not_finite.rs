//! Numbers that JSON cannot say, which Python's `json` writes all the same, and such as no float holds.

/// The text with `null` in the place of each; `None` where there are none.
pub(super) fn without_them(text: &[u8]) -> Option<Vec<u8>> {
    const NAMES: [&[u8]; 6] = [b"-Infinity", b"Infinity", b"-NaN", b"NaN", b"-inf", b"nan"];
    let mut mended = Vec::with_capacity(text.len());
    let mut found = false;
    let mut is_in_string = false;
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        let rest = if is_in_string { &[] } else { &text[at..] };
        let name = NAMES.iter().find(|name| rest.starts_with(name));
        let number = &rest[..number_length(rest)];
        let length = match name {
            Some(name) => name.len(),
            None if is_too_large(number) => number.len(),
            None => 0,
        };
        if length > 0 {
            mended.extend(b"null");
            at += length;
            found = true;
            continue;
        }
        // A number as a whole: its digits are no numbers of their own.
        let length = number.len().max(1);
        mended.extend(&text[at..at + length]);
        at += length;
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

/// How many bytes of a text are the number that it begins with.
fn number_length(text: &[u8]) -> usize {
    let is_one = text
        .first()
        .is_some_and(|first| first.is_ascii_digit() || *first == b'-');
    let is_in_it = |byte: &&u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    if is_one {
        text.iter().take_while(is_in_it).count()
    } else {
        0
    }
}

fn is_too_large(number: &[u8]) -> bool {
    let number = std::str::from_utf8(number).ok();
    number
        .and_then(|number| number.parse().ok())
        .is_some_and(f64::is_infinite)
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
            ("[1e400,-1E+999, 11e307]", Some("[null,null, 11e307]")),
            (r#"["1e400", 1e-400]"#, None),
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
