//! What the tests share: machines, and the steps of reading in one call.

use std::io::{Cursor, Read, Write};
use std::path::PathBuf;

use abbe_recording::{DataError, Header, Recording, calibration_of, machine_of, read_header};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::{compile, compile_word, yaml};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// A lathe without Y, its Z slide on the part's branch.
const LATHE: &str = "abbe: 1
name: lathe
sensitive: [X, Z]
chain:
  workpiece:
    - slide: Z
      along: -Z
  tool:
    - slide: X
      along: +X
    - tool: tip
      offset: [Xt, 0, Zt]
";

/// The equations of a topology word, or of the lathe.
fn equations(machine: &str) -> Option<Equations> {
    let mut diagnostics = Diagnostics::new();
    let compiled = match machine {
        "lathe" => compile(&SourceFile::new("lathe.yaml", LATHE), &mut diagnostics),
        word => compile_word(word, &mut diagnostics),
    };
    compiled.map(|compiled| compiled.equations)
}

/// The header of a recording file, and all findings with the text that each marks.
pub(crate) fn read(text: &str) -> (Option<Header>, Vec<(Diagnostic, String)>) {
    let source = SourceFile::new("recording.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let header = yaml::read(&source, &mut diagnostics).and_then(|root| {
        let machine = machine_of(&root, &mut diagnostics)?;
        // Where the text is arbitrary, so is the machine that it names.
        let equations = equations(&machine.value).or_else(|| equations("XYFZ"))?;
        let header = read_header(&root, &equations, &mut diagnostics);
        assert!(header.as_ref().is_none_or(|header| header.calibration == calibration_of(&root)));
        header
    });
    let marked = diagnostics.into_iter().map(|one| {
        let text = source.slice(one.span).to_owned();
        (one, text)
    });
    (header, marked.collect())
}

/// A header without findings.
pub(crate) fn header(text: &str) -> Header {
    let (header, found) = read(text);
    assert!(found.is_empty(), "{found:#?}\nin\n{text}");
    header.unwrap()
}

/// A recording from its two texts.
pub(crate) fn recording(text: &str, data: &str) -> Result<Recording, DataError> {
    header(text).read_csv("data.csv", data.as_bytes())
}

/// Bytes as gzip packs them.
pub(crate) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// A workbook of the folder `written` with one of its files written anew.
pub(crate) fn book_of(file: &str, part: &str, new: impl Fn(String) -> Vec<u8>) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/recording/written").join(file);
    let mut old = ZipArchive::new(Cursor::new(std::fs::read(path).unwrap())).unwrap();
    let mut book = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for number in 0..old.len() {
        let mut file = old.by_index(number).unwrap();
        let name = file.name().unwrap().to_string();
        let mut text = Vec::new();
        file.read_to_end(&mut text).unwrap();
        if name == part {
            text = new(String::from_utf8(text).unwrap());
        }
        book.start_file(name, options).unwrap();
        book.write_all(&text).unwrap();
    }
    book.finish().unwrap().into_inner()
}
