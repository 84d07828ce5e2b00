//! What stands between the cells. In: the first bytes of a table. Out: a comma, a semicolon or a tab, told by the header; or why this is no
//! table of text.

use recording::cells::told_separator;
use workshop::failure::Failure;

/// What stands between two cells, in what is read and in what is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
}

impl Separator {
    /// The byte that stands for it.
    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
        }
    }

    /// The separator of a table that begins with these bytes: a comma wherever its header has one.
    ///
    /// # Errors
    ///
    /// A workbook, and text that is not UTF-8.
    pub(super) fn of(first: &[u8]) -> Result<Self, Failure> {
        if first.starts_with(b"PK\x03\x04") {
            return Err(refused("a workbook (.xlsx) or another archive", "save the sheet as CSV"));
        }
        if first.starts_with(&[0xff, 0xfe]) || first.starts_with(&[0xfe, 0xff]) {
            return Err(refused("UTF-16", "save it as UTF-8"));
        }
        let mut lines = first.split(|byte| *byte == b'\n');
        let told = lines.clone().next().and_then(told_separator);
        if let Some(told) = told {
            let all = [Self::Comma, Self::Semicolon, Self::Tab];
            return Ok(all.into_iter().find(|separator| separator.byte() == told).unwrap_or(Self::Comma));
        }
        let is_header = |line: &&[u8]| !line.trim_ascii().is_empty() && !line.starts_with(b"#");
        let header = lines.find(is_header).unwrap_or_default();
        let has = |separator: Self| header.contains(&separator.byte());
        let found = [Self::Comma, Self::Semicolon, Self::Tab].into_iter().find(|separator| has(*separator));
        Ok(found.unwrap_or(Self::Comma))
    }
}

fn refused(what: &str, help: &str) -> Failure {
    Failure::no(format!("error: standard input is {what}\nhelp: {help}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_tells_what_separates() {
        for (first, expected) in [
            ("x,y\n1;5,2\n", Separator::Comma),
            ("x;y\n1,5;2\n", Separator::Semicolon),
            ("x\ty\n1,5\t2\n", Separator::Tab),
            ("x\n1,5\n", Separator::Comma),
            ("", Separator::Comma),
            ("# by hand, in May\n\nx;y\n1,5;2\n", Separator::Semicolon),
            ("sep=;\r\nx;y\r\n", Separator::Semicolon),
        ] {
            assert_eq!(Separator::of(first.as_bytes()).ok(), Some(expected), "{first:?}");
        }
    }

    #[test]
    fn what_is_no_text_in_utf_8_is_named() {
        let told = |first: &[u8]| Separator::of(first).err().unwrap().words().unwrap().text(false);
        assert!(told(b"PK\x03\x04\x14\0").contains("a workbook"));
        for first in [&b"\xff\xfex\0,\0"[..], b"\xfe\xff\0x\0,"] {
            assert!(told(first).contains("UTF-16") && told(first).contains("save it as UTF-8"));
        }
    }
}
