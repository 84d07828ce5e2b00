//! Words in a drawing, which no browser breaks into lines. In: text and room. Out: lines, by an estimate of their width.

use super::ticks::count;

/// About how wide a letter of the drawing's text is.
const LETTER: f64 = 7.0;

/// About how wide a text is.
pub(super) fn width(text: &str) -> f64 {
    if text.is_empty() { 0.0 } else { LETTER * count(text.chars().count()) }
}

/// The text in lines that fit, broken at plain spaces; a single word that does not is left whole.
pub(super) fn lines(text: &str, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split([' ', '\n']).filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if width(line) + width(word) + LETTER <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The text as far as it fits, with an ellipsis for the rest.
pub(super) fn cut(text: &str, room: f64) -> String {
    if width(text) <= room {
        return text.to_owned();
    }
    let mut kept = String::new();
    for letter in text.chars() {
        if width(&kept) + 2.0 * LETTER > room {
            break;
        }
        kept.push(letter);
    }
    kept + "…"
}

#[cfg(test)]
mod tests {
    use super::{cut, lines, width};

    #[test]
    fn lines_fit_and_keep_every_word() {
        let text = "every 12th of 24 841 samples shown, held-out ones hollow";
        let broken = lines(text, 150.0);
        assert!(broken.len() > 1 && broken.iter().all(|line| width(line) <= 150.0));
        assert_eq!(broken.join(" "), text);
        assert!(width(&cut(text, 100.0)) <= 100.0);
    }
}
