//! Text in double quotes. In: any text. Out: the same as YAML and JSON alike read it back. It exists so that all files are written alike.

/// A text in double quotes; what ends a line or may not stand in a file is escaped.
pub fn quoted(text: &str) -> String {
    let mut written = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => written.extend(['\\', character]),
            '\n' => written.push_str("\\n"),
            hidden if hidden.is_control() || is_unprintable(hidden) => {
                written.push_str(&format!("\\u{:04x}", u32::from(hidden)));
            }
            plain => written.push(plain),
        }
    }
    written.push('"');
    written
}

/// What YAML does not take as it stands, control characters aside; all of it fits four digits.
fn is_unprintable(character: char) -> bool {
    matches!(character, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    #[test]
    fn strings_are_escaped() {
        assert_eq!(super::quoted("a\"b\\c\nµ\u{7}\u{2028}"), r#""a\"b\\c\nµ\u0007\u2028""#);
    }
}
