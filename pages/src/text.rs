//! Text inside markup. In: any text. Out: the same text as it may stand between tags and in attributes of HTML and SVG.

/// Text with the characters that markup reads replaced; control characters, which no browser shows, become spaces.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push('\n'),
            control if control.is_control() => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn nothing_that_markup_reads_is_left() {
        assert_eq!(escape("a<b & \"c\">\u{0}"), "a&lt;b &amp; &quot;c&quot;&gt; ");
    }
}
