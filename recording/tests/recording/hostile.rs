//! Files of other programs that were made to do harm: they end in an answer or a mistake, soon, and without filling memory.

use std::path::PathBuf;

use crate::common::{book_of, header};

const TEXT: &str = "recording: 1
machine: FX
instrument: position
data: x
channels: {time: {column: t, unit: s}, run: {column: n}, measured.x: {column: x, unit: mm}}
";

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/recording/written").join(name))
        .unwrap()
}

fn sheet() -> String {
    TEXT.replace("data: x", "data: {file: x, sheet: run}")
}

/// The workbook of openpyxl with one of its files written anew.
fn book(part: &str, new: impl Fn(String) -> Vec<u8>) -> Vec<u8> {
    book_of("openpyxl.xlsx", part, new)
}

/// The sheet that is read.
const SHEET: &str = "xl/worksheets/sheet2.xml";

#[test]
fn a_small_workbook_that_unpacks_to_a_large_one() {
    let large = book("xl/styles.xml", |_| vec![b' '; 300 << 20]);
    assert!(large.len() < 1 << 20);
    let error = header(&sheet()).read_bytes("x.xlsx", large).unwrap_err().to_string();
    assert!(error.contains("more than 256 MiB when unpacked"), "{error}");
}

/// Without numbers nobody can tell in which row the names stand.
#[test]
fn a_sheet_without_numbers_tells_what_to_write() {
    let text = |sheet: String| sheet.replace(" t=\"n\"><v>", " t=\"str\"><v>a").into_bytes();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("no-numbers.xlsx");
    std::fs::write(&path, book("xl/worksheets/sheet1.xml", text)).unwrap();
    let error = abbe_recording::column_names(&path).unwrap_err().to_string();
    assert!(
        error.contains("no row of column names above its numbers") && error.contains("header: 7"),
        "{error}"
    );
}

#[test]
fn cells_that_stand_nowhere() {
    for (from, to) in [
        ("r=\"C3\"", "r=\"XFD1048576\""),
        ("r=\"C3\"", "r=\"ZZZZZZZZZ1\""),
        ("r=\"C3\"", "r=\"A4294967297\""),
        ("r=\"C3\"", "r=\"A99999999999999999999\""),
        ("r=\"C3\"", "r=\"C\""),
        ("r=\"C3\"", "r=\"A1\""),
        ("r=\"C3\"", "r=\"\""),
        ("r=\"C3\"", "s=\"99999999\" t=\"s\""),
        ("<row r=\"3\"", "<row r=\"0\""),
        ("<row r=\"3\"", "<row r=\"4294967296\""),
        ("<sheetData>", "<sheetData"),
        ("</sheetData>", ""),
    ] {
        let hostile = book(SHEET, |text| {
            assert!(text.contains(from), "{text}");
            text.replace(from, to).into_bytes()
        });
        // What counts is that there is an end, and no panic.
        if let Err(error) = header(&sheet()).read_bytes("x.xlsx", hostile) {
            assert!(error.to_string().starts_with("error: x.xlsx"), "{error}");
        }
    }
}

/// A bit of each byte is turned, and the file is cut off there.
#[test]
fn files_with_a_flaw() {
    for name in [
        "polars-zstd.parquet",
        "polars-lz4.parquet",
        "fastparquet.parquet",
        "pyarrow-pages-2.parquet",
        "openpyxl.xlsx",
    ] {
        let whole = bytes(name);
        let header = header(if name.ends_with("xlsx") { sheet() } else { TEXT.to_owned() }.as_str());
        for at in 4..whole.len() {
            let mut flawed = whole.clone();
            flawed[at] ^= 1 << (at % 8);
            // Many bits are those of numbers, or of what is not read: what is read then is still a table.
            if let Ok(read) = header.read_bytes(name, flawed) {
                let columns = [Some(read.run.len()), read.measured[0].as_ref().map(Vec::len)];
                assert!(
                    columns.into_iter().flatten().all(|rows| rows == read.time.len()),
                    "{name}: bit of {at}"
                );
                assert!(read.time.is_sorted_by(|one, next| one < next), "{name}: bit of {at}");
            }
            // Both formats say at their end where everything is.
            assert!(header.read_bytes(name, whole[..at].to_vec()).is_err(), "{name}: {at} bytes of it");
        }
    }
}
