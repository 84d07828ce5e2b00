"""Writes the tables of this folder, each as its program writes it: polars, pyarrow, pandas, openpyxl, XlsxWriter,
DuckDB, fastparquet, h5py, SciPy, npTDMS, asammdf. Not run by the tests: what it wrote is kept. `halsampler.txt` is LinuxCNC's and
not of this script; its test says of what it is.

The table is the same in all: 40 rows, 50 ms apart from 2026-07-30T23:15:17.123456 (UTC) on; x is a quarter of the row's
number, missing in row 7 where the format can say so; n is the run, 1 and then 2 from row 20 on.
"""

import datetime
import pathlib

import asammdf
import duckdb
import fastparquet
import h5py
import nptdms
import numpy
import openpyxl
import pandas
import polars
import scipy.io
import xlsxwriter

folder = pathlib.Path(__file__).parent
rows = range(40)
begin = datetime.datetime(2026, 7, 30, 23, 15, 17, 123456)
when = [begin + datetime.timedelta(milliseconds=50 * row) for row in rows]
t = [0.05 * row for row in rows]
n = [1 if row < 20 else 2 for row in rows]
x = [None if row == 7 else 0.25 * row for row in rows]
plain = {"when": when, "t": t, "n": n, "x": x}

frame = polars.DataFrame(plain, schema_overrides={"n": polars.UInt8, "x": polars.Float32})
for packing in ["zstd", "snappy", "gzip", "lz4", "uncompressed"]:
    frame.write_parquet(folder / f"polars-{packing}.parquet", compression=packing)

# Dates with a zone in ns; pages of version 2; packed by zstd.
pandas_frame = pandas.DataFrame(plain)
pandas_frame["when"] = pandas_frame["when"].dt.tz_localize("UTC").dt.as_unit("ns")
pandas_frame["ns"] = pandas_frame["when"].astype("int64")
pandas_frame.to_parquet(
    folder / "pyarrow-pages-2.parquet", compression="zstd", data_page_version="2.0", index=False, row_group_size=16
)
# Dates as Spark wrote them once, in 96 bits.
pandas_frame.to_parquet(folder / "pyarrow-brotli.parquet", compression="brotli", index=False)
pandas_frame.drop(columns="ns").to_parquet(
    folder / "pyarrow-int96.parquet", use_deprecated_int96_timestamps=True, index=False
)
duckdb.sql(
    f"copy (select * from pandas_frame) to '{folder / 'duckdb.parquet'}' (format parquet, codec zstd)"
)
fastparquet.write(str(folder / "fastparquet.parquet"), pandas_frame.drop(columns="ns"), compression="GZIP")

book = openpyxl.Workbook()
notes = book.active
notes.title = "notes"
notes.append(["when", "t", "n", "x"])
notes.append(["measured by hand", 0, 1, "none"])
sheet = book.create_sheet("run")
sheet.append(["when", "t", "n", "x [mm]"])
for row in zip(when, t, n, x):
    sheet.append(row)
for row in rows:
    sheet.cell(row + 2, 1).number_format = "yyyy-mm-dd hh:mm:ss.000"
book.save(folder / "openpyxl.xlsx")

# Three rows of a title above the names; the date and the time of day in two columns; what Excel counts from 1904.
book = xlsxwriter.Workbook(folder / "xlsxwriter.xlsx", {"date_1904": True})
sheet = book.add_worksheet()
sheet.write(0, 0, "position of X")
sheet.write(2, 0, "# machine 7")
for column, name in enumerate(["date", "time", "n", "x"]):
    sheet.write(4, column, name)
day, hour = book.add_format({"num_format": "dd.mm.yyyy"}), book.add_format({"num_format": "hh:mm:ss.000"})
for row in rows:
    sheet.write_datetime(5 + row, 0, when[row].date(), day)
    sheet.write_datetime(5 + row, 1, when[row].time(), hour)
    sheet.write(5 + row, 2, n[row])
    if x[row] is not None:
        sheet.write(5 + row, 3, x[row])
book.close()

# What LibreOffice and Excel write in a German system; what a logger writes.
frame = pandas.DataFrame(plain)
frame.to_csv(folder / "comma.csv", sep=";", decimal=",", index=False)
frame.assign(date=frame["when"].dt.date, time=frame["when"].dt.time).drop(columns="when").to_csv(
    folder / "tabs.txt", sep="\t", index=False
)
# Encoder counts of 0.5 um.
frame.assign(x=(frame["x"] / 0.0005).astype("Int64")).to_csv(folder / "counts.csv", index=False)
# numpy.savetxt has no header.
numpy.savetxt(folder / "savetxt.txt", numpy.array([list(rows), n, [0.0 if one is None else one for one in x]]).T)

# What is not read.
with h5py.File(folder / "h5py.h5", "w") as file:
    file["t"] = t
scipy.io.savemat(folder / "scipy.mat", {"t": t})
with nptdms.TdmsWriter(folder / "nptdms.tdms") as file:
    file.write_segment([nptdms.ChannelObject("group", "t", numpy.array(t))])
mdf = asammdf.MDF()
mdf.append(asammdf.Signal(numpy.array(t), numpy.array(t), name="t"))
mdf.save(folder / "asammdf.mf4", overwrite=True)
mdf.close()

# A row of units, a date and a time of day in two cells, a time without its date, and a time that has been running for more than a day.
book = openpyxl.Workbook()
sheet = book.active
sheet.append(["day", "clock", "ran", "x"])
sheet.append(["#unit", None, None, None, "um"])
for row in range(3):
    clock = None if row == 1 else datetime.time(10, 0, row)
    sheet.append([datetime.date(2026, 7, 9), clock, datetime.timedelta(hours=30, seconds=row), 0.25 * row])
for cells in sheet.iter_rows(min_row=3, min_col=3, max_col=3):
    cells[0].number_format = "[h]:mm:ss"
book.save(folder / "openpyxl-clock.xlsx")
