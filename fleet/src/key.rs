//! Keys: what a result was made from, as one number. In: files and texts. Out: 32 hexadecimal digits that change when any of them does.
//!
//! The sum is XXH3 of 128 bits, which the table format brings along: it tells files apart that differ by chance or by work, and is no
//! guard against a forger, who could as well write the result.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use twox_hash::XxHash3_128;

/// A sum on its way.
pub(crate) struct Sum(XxHash3_128);

/// The form of the results: another one makes all of them anew.
const FORM: &str = "3";

/// How much of a file is read at once, in bytes: as much as a pipe of Linux holds.
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

    /// Adds what a file holds. A file that is missing, or a device without an end, counts as a content of its own.
    ///
    /// # Errors
    ///
    /// Where a file that is there cannot be read now and may be another time: it is locked, the network is slow, memory is short.
    pub(crate) fn file(self, path: &Path) -> io::Result<Self> {
        match fs::metadata(path).and_then(|there| there.is_file().then(|| File::open(path)).transpose()) {
            Ok(Some(mut file)) => self.content(&mut file),
            Ok(None) => Ok(self.text("no file")),
            Err(error) if is_lasting(&error) => Ok(self.text("none")),
            Err(error) => Err(error),
        }
    }

    fn content(mut self, file: &mut File) -> io::Result<Self> {
        let (mut piece, mut length) = (vec![0; PIECE], 0_u64);
        loop {
            match file.read(&mut piece) {
                Ok(0) => break,
                Ok(read) => {
                    length = length.saturating_add(read as u64);
                    self.0.write(piece.get(..read).unwrap_or_default());
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.0.write(&length.to_le_bytes());
        Ok(self)
    }

    /// The digits.
    pub(crate) fn digits(self) -> String {
        format!("{:032x}", self.0.finish_128())
    }
}

/// Whether an error is of the name itself, which stays until somebody changes the files: all others may pass.
fn is_lasting(error: &io::Error) -> bool {
    use ErrorKind::{InvalidFilename, InvalidInput, IsADirectory, NotADirectory, NotFound};
    matches!(error.kind(), NotFound | NotADirectory | IsADirectory | InvalidFilename | InvalidInput)
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
