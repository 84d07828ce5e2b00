//! Pages of Parquet that are packed by zstd.
//!
//! In: a column of a group of rows. Out: its pages, unpacked. The library's own way to zstd is a compiler of C and a
//! library in C; here its pages are read as if they were not packed, and unpacked by a decoder in Rust. All other ways of
//! packing are left to the library.

use std::io::Read;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::Compression;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::ChunkReader;
use parquet::file::serialized_reader::SerializedPageReader;
use ruzstd::decoding::StreamingDecoder;

/// A larger page is refused: writers make pages of 1 MiB, and a page is unpacked as a whole.
const LARGEST_PAGE: u64 = 1 << 28;

/// The pages of a column in `rows` rows.
pub(super) fn pages_of<R: ChunkReader + 'static>(
    file: &Arc<R>,
    column: &ColumnChunkMetaData,
    rows: usize,
) -> Result<Box<dyn PageReader>, ParquetError> {
    if !matches!(column.compression(), Compression::ZSTD(_)) {
        return Ok(Box::new(SerializedPageReader::new(Arc::clone(file), column, rows, None)?));
    }
    let plain = column.clone().into_builder().set_compression(Compression::UNCOMPRESSED).build()?;
    let packed = SerializedPageReader::new(Arc::clone(file), &plain, rows, None)?;
    Ok(Box::new(Unpacked { packed }))
}

/// Pages that are unpacked as they are read.
struct Unpacked<R: ChunkReader> {
    packed: SerializedPageReader<R>,
}

impl<R: ChunkReader> PageReader for Unpacked<R> {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        self.packed.get_next_page()?.map(unpacked).transpose()
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        self.packed.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        self.packed.skip_next_page()
    }
}

impl<R: ChunkReader> Iterator for Unpacked<R> {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

fn unpacked(mut page: Page) -> Result<Page, ParquetError> {
    match &mut page {
        Page::DataPage { buf, .. } | Page::DictionaryPage { buf, .. } => *buf = unzstd(&[], buf)?,
        Page::DataPageV2 { buf, def_levels_byte_len, rep_levels_byte_len, is_compressed, .. } => {
            // The levels before the values are never packed.
            let levels = usize::try_from(u64::from(*def_levels_byte_len) + u64::from(*rep_levels_byte_len));
            let parts = levels.ok().and_then(|levels| buf.split_at_checked(levels));
            let (levels, values) = parts.ok_or_else(|| broken("a page ends among its levels"))?;
            if *is_compressed && !values.is_empty() {
                *buf = unzstd(levels, values)?;
            }
        }
    }
    Ok(page)
}

/// What stands before, and behind it what was packed.
fn unzstd(before: &[u8], packed: &[u8]) -> Result<Bytes, ParquetError> {
    let mut all = before.to_vec();
    let mut decoder = StreamingDecoder::new(packed).map_err(broken)?;
    decoder.by_ref().take(LARGEST_PAGE).read_to_end(&mut all).map_err(broken)?;
    let most = usize::try_from(LARGEST_PAGE).unwrap_or(usize::MAX);
    if all.len() >= most {
        return Err(broken("a page is larger than 256 MiB"));
    }
    Ok(Bytes::from(all))
}

fn broken(why: impl std::fmt::Display) -> ParquetError {
    ParquetError::General(why.to_string())
}
