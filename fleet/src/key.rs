//! Keys: what a result was made from, as one number. In: files and texts. Out: 32 hexadecimal digits that change when any of them does.
//!
//! The sum is XXH3 of 128 bits, which the table format brings along: it tells files apart that differ by chance or by work, and is no
//! guard against a forger, who could as well write the result.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use twox_hash::XxHash3_128;

/// A sum on its way.
pub(crate) struct Sum(XxHash3_128);

/// The form of the results: another one makes all of them anew.
const FORM: &str = "1";

/// How much of a file is read at once.
const PIECE: usize = 1 << 16;

impl Sum {
    /// Begins with the version of Abbe and of the results' form.
    pub(crate) fn versioned() -> Self {
        Self(XxHash3_128::new()).text(env!("CARGO_PKG_VERSION")).text(FORM)
    }

    /// Adds a text; its length before it, so that neighbours cannot run into each other.
    pub(crate) fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }

    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.write(&(bytes.len() as u64).to_le_bytes());
        self.0.write(bytes);
        self
    }

    /// Adds what a file holds, or that it cannot be read.
    pub(crate) fn file(mut self, path: &Path) -> Self {
        let Ok(mut file) = File::open(path) else { return self.text("none") };
        let (mut piece, mut length) = (vec![0; PIECE], 0_u64);
        loop {
            match file.read(&mut piece) {
                Ok(0) => break,
                Ok(read) => {
                    length = length.saturating_add(read as u64);
                    self.0.write(piece.get(..read).unwrap_or_default());
                }
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(_) => return self.text("broken"),
            }
        }
        self.0.write(&length.to_le_bytes());
        self
    }

    /// The digits.
    pub(crate) fn digits(self) -> String {
        format!("{:032x}", self.0.finish_128())
    }
}

/// The sum of texts alone, whatever the version.
pub(crate) fn of_texts(texts: &[&str]) -> String {
    texts.iter().fold(Sum(XxHash3_128::new()), |sum, text| sum.text(text)).digits()
}

#[cfg(test)]
mod tests {
    use super::of_texts;

    #[test]
    fn texts_do_not_run_into_each_other() {
        assert_eq!(of_texts(&["a", "b"]), of_texts(&["a", "b"]));
        assert_ne!(of_texts(&["ab", ""]), of_texts(&["a", "b"]));
        assert_eq!(of_texts(&[]).len(), 32);
    }
}
