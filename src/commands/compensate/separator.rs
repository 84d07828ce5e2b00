//! What stands between the cells. In: the first bytes of a table. Out: a comma, a semicolon or a tab, told by the header; or why this is no
//! table of text.

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
        let header = first.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let has = |separator: Self| header.contains(&separator.byte());
        let found = [Self::Comma, Self::Semicolon, Self::Tab].into_iter().find(|separator| has(*separator));
        Ok(found.unwrap_or(Self::Comma))
    }
}

fn refused(what: &str, help: &str) -> Failure {
    Failure::no(format!("error: standard input is {what}\nhelp: {help}"))
}
