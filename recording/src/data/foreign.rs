//! Files of other programs that hold tables and are not read: what they are, and how to make a table of them.

/// A kind of file that is told by the bytes at its beginning.
struct Kind {
    begins: &'static [u8],
    what: &'static str,
    help: &'static str,
}

/// Lines of Python; `x.parquet` is what the recording file then names.
const HDF5: &str = "convert it to a table, in Python: `pandas.read_hdf(\"x.h5\").to_parquet(\"x.parquet\")`, or, if h5py wrote it, `f = h5py.File(\"x.h5\"); pandas.DataFrame({k: f[k][:] for k in [\"t\", \"x\"]}).to_parquet(\"x.parquet\")`";
const MAT: &str = "convert it to a table, in Python: `m = scipy.io.loadmat(\"x.mat\"); pandas.DataFrame({k: m[k].ravel() for k in [\"t\", \"x\"]}).to_parquet(\"x.parquet\")`";
const MAT_73: &str = "convert it to a table, in Python: `f = h5py.File(\"x.mat\"); pandas.DataFrame({k: f[k][()].ravel() for k in [\"t\", \"x\"]}).to_parquet(\"x.parquet\")`";
const TDMS: &str = "convert it to a table, in Python: `nptdms.TdmsFile.read(\"x.tdms\").as_dataframe(time_index=True).reset_index().to_parquet(\"x.parquet\")`";
const MDF: &str = "convert it to a table, in Python: `asammdf.MDF(\"x.mf4\").to_dataframe().reset_index().to_parquet(\"x.parquet\")`";
const OLD_EXCEL: &str =
    "save it as `.xlsx`, or, in Python: `pandas.read_excel(\"x.xls\").to_parquet(\"x.parquet\")`";
const FEATHER: &str =
    "convert it to Parquet, in Python: `pandas.read_feather(\"x.feather\").to_parquet(\"x.parquet\")`";
const NUMPY: &str = "convert it to a table, in Python: `pandas.DataFrame(numpy.load(\"x.npy\"), columns=[\"t\", \"x\"]).to_parquet(\"x.parquet\")`";
const SQLITE: &str = "convert it to a table, in Python: `pandas.read_sql(\"select * from name\", sqlite3.connect(\"x.db\")).to_parquet(\"x.parquet\")`";
const UTF_8: &str = "save the table as CSV in UTF-8";
const PACKED: &str = "unpack it, or compress it with gzip";

/// The kinds that people have been given.
const KINDS: [Kind; 16] = [
    Kind { begins: b"\xff\xfe", what: "text in UTF-16", help: UTF_8 },
    Kind { begins: b"\xfe\xff", what: "text in UTF-16", help: UTF_8 },
    Kind { begins: b"\x89HDF\r\n\x1a\n", what: "an HDF5 file", help: HDF5 },
    Kind { begins: b"MATLAB 7.3 MAT-file", what: "a MAT file of version 7.3, which is HDF5", help: MAT_73 },
    Kind { begins: b"MATLAB 5.0 MAT-file", what: "a MAT file", help: MAT },
    Kind { begins: b"TDSm", what: "a TDMS file", help: TDMS },
    Kind { begins: b"MDF     ", what: "an MDF file", help: MDF },
    Kind { begins: b"UnFinMF ", what: "an unfinished MDF file", help: MDF },
    Kind {
        begins: b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        what: "a workbook in the old format, or a locked one",
        help: OLD_EXCEL,
    },
    Kind { begins: b"ARROW1", what: "an Arrow file (Feather)", help: FEATHER },
    Kind { begins: b"\x93NUMPY", what: "a NumPy file", help: NUMPY },
    Kind { begins: b"SQLite format 3\0", what: "an SQLite database", help: SQLITE },
    Kind { begins: b"\x28\xb5\x2f\xfd", what: "compressed with zstd", help: PACKED },
    Kind { begins: b"\xfd7zXZ\0", what: "compressed with xz", help: PACKED },
    Kind { begins: b"BZh", what: "compressed with bzip2", help: PACKED },
    Kind { begins: b"7z\xbc\xaf\x27\x1c", what: "compressed with 7-Zip", help: PACKED },
];

/// What a file is that is not read, and how to make a table of it, from its first bytes; nothing where it may be a table.
pub fn foreign(start: &[u8]) -> Option<(&'static str, &'static str)> {
    let kind = KINDS.iter().find(|kind| start.starts_with(kind.begins))?;
    Some((kind.what, kind.help))
}
