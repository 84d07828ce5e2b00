//! Text inside markup. In: any text. Out: the same text as it may stand between tags and in attributes of HTML and SVG, where
//! it is asked for with the signs of print.

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

/// Text of a report in markup: what a terminal shows as `um`, `urad` and `+-` becomes `\u{b5}m`, `\u{b5}rad` and `\u{b1}`. Every
/// page writes its sentences and numbers with this, so that no line has both spellings. It is not for commands and files.
pub fn printed(text: &str) -> String {
    let text = escape(text).replace(" +- ", " \u{b1} ");
    let mut shown = String::with_capacity(text.len());
    for (number, piece) in text.split(' ').enumerate() {
        if number > 0 {
            shown.push(' ');
        }
        let end = piece.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(piece.len());
        match piece.split_at_checked(end) {
            Some((unit @ ("um" | "urad"), rest)) => {
                shown.push('\u{b5}');
                shown.push_str(unit.trim_start_matches('u'));
                shown.push_str(rest);
            }
            _ => shown.push_str(piece),
        }
    }
    shown
}

/// A verdict as people write it: the word of programs, `left-out-physics`, has a dash before its last part too.
pub fn spoken(verdict: &str) -> String {
    verdict.rsplit_once('-').map_or_else(|| verdict.to_owned(), |(first, last)| format!("{first} {last}"))
}

#[cfg(test)]
mod tests {
    use super::{escape, printed, spoken};

    #[test]
    fn units_and_intervals_have_the_signs_of_print_and_other_words_stay() {
        assert_eq!(
            printed("5.1 -> 0.60 um, c_1 2 +- 1 um/m; 9 urad (8 um) <umber> sum"),
            "5.1 -&gt; 0.60 \u{b5}m, c_1 2 \u{b1} 1 \u{b5}m/m; 9 \u{b5}rad (8 \u{b5}m) &lt;umber&gt; sum"
        );
    }

    #[test]
    fn verdicts_are_told_as_people_write_them() {
        let told = ["adequate", "left-out-physics", "not-repeatable"].map(spoken);
        assert_eq!(told, ["adequate", "left-out physics", "not repeatable"]);
    }

    #[test]
    fn nothing_that_markup_reads_is_left() {
        assert_eq!(escape("a<b & \"c\">\u{0}"), "a&lt;b &amp; &quot;c&quot;&gt; ");
    }
}
