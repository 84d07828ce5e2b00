//! Tables of other libraries. In: an object with `__arrow_c_stream__` (pandas, polars, pyarrow, DuckDB ...). Out: the names of its columns,
//! and the numbers of each.
//!
//! Arrow's interface is one of C: the stream is handed over by a pointer in a capsule. This is the only place of the package with unsafe
//! code of its own.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{
    ArrowPrimitiveType, Date32Type, Date64Type, Decimal128Type, DurationMicrosecondType,
    DurationMillisecondType, DurationNanosecondType, DurationSecondType, Float16Type, Float32Type,
    Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, TimestampMicrosecondType,
    TimestampMillisecondType, TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatch, RecordBatchReader};
use arrow_schema::{DataType, TimeUnit};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

use crate::columns::Values;
use crate::error::wrong;

/// The name that Arrow gives to capsules of streams.
const STREAM: &std::ffi::CStr = c"arrow_array_stream";

/// Reads all batches of a stream.
pub(crate) fn read(table: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Part)>> {
    let py = table.py();
    let capsule = table.call_method0("__arrow_c_stream__")?;
    let capsule = capsule.cast::<PyCapsule>()?;
    let reader = reader(capsule)?;
    let schema = reader.schema();
    let batches: Result<Vec<RecordBatch>, _> = reader.collect();
    let batches = batches.map_err(|error| wrong(py, format!("the table cannot be read: {error}")))?;
    let columns = schema.fields().iter().enumerate().map(|(number, field)| {
        let parts = batches.iter().filter_map(|batch| batch.columns().get(number)).map(Arc::clone).collect();
        (field.name().clone(), Part { kind: field.data_type().clone(), parts })
    });
    Ok(columns.collect())
}

#[expect(unsafe_code, reason = "Arrow's interface for other libraries is one of C")]
fn reader(capsule: &Bound<'_, PyCapsule>) -> PyResult<RecordBatchStreamReader> {
    let stream = capsule.pointer_checked(Some(STREAM))?.cast::<FFI_ArrowArrayStream>();
    // SAFETY: a capsule of this name holds a pointer to a valid stream, as Arrow's PyCapsule interface says; the stream is moved out of
    // it, which leaves a released one behind, and the capsule is held by the caller meanwhile.
    let reader = unsafe { RecordBatchStreamReader::from_raw(stream.as_ptr()) };
    reader.map_err(|error| wrong(capsule.py(), format!("the table cannot be read: {error}")))
}

/// One column, batch by batch.
pub(crate) struct Part {
    kind: DataType,
    parts: Vec<ArrayRef>,
}

impl Part {
    /// What it holds. Whole numbers beyond 2^53 lose their last digits, as they do in the text of a table.
    pub(crate) fn values(&self) -> Values {
        use DataType::{Duration, Timestamp};
        use TimeUnit::{Microsecond, Millisecond, Nanosecond, Second};
        match &self.kind {
            DataType::Null => Values::Numbers(vec![f64::NAN; self.parts.iter().map(|part| part.len()).sum()]),
            DataType::Boolean => Values::Numbers(self.booleans()),
            DataType::Int8 => self.numbers::<Int8Type>(f64::from),
            DataType::Int16 => self.numbers::<Int16Type>(f64::from),
            DataType::Int32 => self.numbers::<Int32Type>(f64::from),
            DataType::Int64 => self.numbers::<Int64Type>(|value| value as f64),
            DataType::UInt8 => self.numbers::<UInt8Type>(f64::from),
            DataType::UInt16 => self.numbers::<UInt16Type>(f64::from),
            DataType::UInt32 => self.numbers::<UInt32Type>(f64::from),
            DataType::UInt64 => self.numbers::<UInt64Type>(|value| value as f64),
            DataType::Float16 => self.numbers::<Float16Type>(f64::from),
            DataType::Float32 => self.numbers::<Float32Type>(f64::from),
            DataType::Float64 => self.numbers::<Float64Type>(|value| value),
            // Databases give their literals so: 0.01 is 1 with the scale 2.
            DataType::Decimal128(_, scale) => {
                let one = 10_f64.powi(i32::from(*scale));
                self.numbers::<Decimal128Type>(|value| value as f64 / one)
            }
            DataType::Date32 => self.times::<Date32Type>(86_400_000_000_000),
            DataType::Date64 => self.times::<Date64Type>(1_000_000),
            Timestamp(Second, _) => self.times::<TimestampSecondType>(1_000_000_000),
            Timestamp(Millisecond, _) => self.times::<TimestampMillisecondType>(1_000_000),
            Timestamp(Microsecond, _) => self.times::<TimestampMicrosecondType>(1_000),
            Timestamp(Nanosecond, _) => self.times::<TimestampNanosecondType>(1),
            Duration(Second) => self.times::<DurationSecondType>(1_000_000_000),
            Duration(Millisecond) => self.times::<DurationMillisecondType>(1_000_000),
            Duration(Microsecond) => self.times::<DurationMicrosecondType>(1_000),
            Duration(Nanosecond) => self.times::<DurationNanosecondType>(1),
            other => Values::Other(format!("holds {other}, not numbers")),
        }
    }

    fn numbers<T: ArrowPrimitiveType>(&self, number: impl Fn(T::Native) -> f64) -> Values {
        let parts = self.parts.iter().filter_map(|part| part.as_primitive_opt::<T>());
        let numbers = parts.flat_map(|part| part.iter().map(|value| value.map_or(f64::NAN, &number)));
        Values::Numbers(numbers.collect())
    }

    fn booleans(&self) -> Vec<f64> {
        let number = |value: Option<bool>| value.map_or(f64::NAN, |value| if value { 1.0 } else { 0.0 });
        let parts = self.parts.iter().filter_map(|part| part.as_boolean_opt());
        parts.flat_map(|part| part.iter().map(number)).collect()
    }

    /// Times from counts of so many nanoseconds.
    fn times<T: ArrowPrimitiveType<Native: Into<i128>>>(&self, each: i128) -> Values {
        let parts = self.parts.iter().filter_map(|part| part.as_primitive_opt::<T>());
        // Neither factor is beyond 2^64: the product is within 2^128.
        let time = |value: T::Native| value.into().saturating_mul(each);
        Values::Times(parts.flat_map(|part| part.iter().map(|value| value.map(time))).collect())
    }
}
