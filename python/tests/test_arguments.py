"""Arguments: any number of Python is one, text stays as it is, tables come from anywhere, and a mistake is told with its place."""

from __future__ import annotations

import decimal
import fractions
import pathlib
import types
from collections.abc import Callable

import numpy as np
import pytest
from conftest import MILL, UNITS, command

import abbe

T = np.arange(50) * 0.01
TABLE = {"time": T, "command.x": 10 * np.sin(T), "measured.x": 10 * np.sin(T) + 1e-3}


def placed(value: object) -> abbe.Calibration:
    """A stage with a curve that ends at a place, which may be any."""
    curve = {"axis": "X", "per": "mm", "unit": "um", "at": [0, value], "values": [0, 1]}
    return abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": [{"table": curve}]}})


def scaled(value: object) -> abbe.Calibration:
    """A stage whose error grows by so many um a mm."""
    curve = {"axis": "X", "per": "mm", "unit": "um", "coefficients": [0, value]}
    return abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": [{"polynomial": curve}]}})


def record(table: object = TABLE, **more: object) -> abbe.Recording:
    return abbe.Recording(table, **{"machine": "FX", "units": UNITS, **more})


@pytest.mark.parametrize(
    ("value", "number"),
    [
        (np.float64(0.1), 0.1),
        (np.float64(1e-17), 1e-17),
        (np.float32(0.1), float(np.float32(0.1))),
        (np.float16(0.5), 0.5),
        (np.longdouble(0.25), 0.25),
        (np.int64(3), 3.0),
        (np.uint8(3), 3.0),
        (np.array(2.5), 2.5),
        (np.array(2), 2.0),
        (decimal.Decimal("0.1"), 0.1),
        (fractions.Fraction(1, 4), 0.25),
        (10**30, 1e30),
    ],
    ids=lambda value: f"{type(value).__name__} {value}",
)
def test_any_number_is_that_number(value: object, number: float) -> None:
    assert f"at: [0, {number!r}]" in placed(value).text or f"at: [0, {value}]" in placed(value).text
    assert placed(value).error([[1.0]])[0, 0] == placed(number).error([[1.0]])[0, 0] != 0


def test_arrays_flags_and_whole_numbers_of_numpy() -> None:
    whole = {"axis": "X", "per": "mm", "unit": "um", "coefficients": np.array([0.0, 1.5])}
    dictionary = {"calibration": np.int64(1), "machine": np.str_("FX"), "errors": {np.str_("EXX"): [{"polynomial": whole}]}}
    assert abbe.Calibration(types.MappingProxyType(dictionary)).error([[2.0]])[0, 0] == 0.003
    table = TABLE | {"run": np.repeat([1, 2], 25)}
    assert record(table, holdout={"runs": [np.int64(2)]}).text.endswith("runs: [2]\n")
    assert record(table, holdout={"runs": np.array([2])}).text.endswith("runs: [2]\n")
    # What a flag is, a reader decides; here it is none of the numbers that are asked for.
    for flag in [np.bool_(True), np.array(True), True]:
        with pytest.raises(abbe.Error, match="`true`"):
            scaled(flag)
    mill = abbe.Calibration(MILL)
    plain = mill.map("XY", points=3, ranges={"X": (0, 100), "Y": (0, 200)}, at={"Z": -10})
    ranges = {"X": np.array([0, 100]), "Y": (np.float64(0), np.int64(200))}
    drawn = mill.map("XY", points=np.int64(3), ranges=ranges, at={"Z": np.array(-10)})
    assert all(np.array_equal(drawn[name], plain[name]) for name in plain)


@pytest.mark.parametrize("value", [object(), {1}, b"1", 1j, np.datetime64("2026-01-01"), float], ids=lambda value: type(value).__name__)
def test_what_has_no_place_in_a_file_is_told_with_its_place(value: object) -> None:
    with pytest.raises(abbe.Error) as caught:
        scaled(value)
    assert str(caught.value).startswith("error: calibration.errors.EXX[0].polynomial.coefficients[1] is of type ")


def test_numbers_that_are_none_and_keys_that_are_no_text() -> None:
    for value in [np.nan, np.inf, None, np.ma.masked_array([1.0], [True])[0]]:
        with pytest.raises(abbe.Error) as caught:
            scaled(value)
        assert (caught.value.spans[0]["file"], caught.value.spans[0]["line"]) == ("<calibration>", 4)
    with pytest.raises(abbe.Error, match=r"a key of calibration\.errors is text, found 3 \(int\)"):
        abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {3: "3 um"}})
    endless: list[object] = []
    endless.append(endless)
    with pytest.raises(abbe.Error, match="too deeply"):
        scaled(endless)


STRANGE = ["null", "Null", "~", "yes", "no", "on", "y", "True", "1e3", "1_000", "0x10", "0o7", ".inf", ".nan", "12:30:00", "2026-01-01", "3", "+1", "-", "- a", "--- a", "a: b", "a #b", "#x"]
STRANGE += ["'q'", '"q"', "\\", "&a", "*a", "!t", "{", "[", "|", ">", "%x", "@x", "<<", "=", "?", "...", " x", "x ", "\tx", "a\nb", "\x00x", "a\u2028b", "a\x85b", "\ufeffx", "é µ 😀"]


@pytest.mark.parametrize("text", STRANGE, ids=ascii)
def test_text_stays_as_it_is(text: str, tmp_path: pathlib.Path) -> None:
    recording = record(title=text)
    assert recording.title == text
    (tmp_path / "written.yaml").write_text(recording.text)
    (tmp_path / "memory").write_text("time,command.x,measured.x\n0,0,0\n1,1,1\n")
    assert abbe.Recording(tmp_path / "written.yaml").title == text
    yaml = pytest.importorskip("yaml")
    # A reader of YAML 1.1, which takes more words for something else.
    assert yaml.safe_load(recording.text)["title"] == text


def test_columns_are_named_with_blanks_too() -> None:
    renamed = {f" {name} ": values for name, values in TABLE.items()}
    assert np.array_equal(record(renamed)["measured.x"], TABLE["measured.x"])
    with pytest.raises(abbe.Error, match=r"recording\.title holds a letter"):
        record(title="\ud800")


def layouts() -> dict[str, np.ndarray]:
    """The same positions, in ways in which arrays can lie."""
    plain = np.arange(12.0).reshape(4, 3)
    packed = np.zeros(4, dtype=[("flag", "u1"), ("at", "f8", (3,))])
    packed["at"] = plain
    shifted = np.frombuffer(b"\0" + plain.tobytes(), dtype="u1")[1:].view("f8").reshape(4, 3)
    objects = plain.astype(object)
    objects[0, 0] = decimal.Decimal(0)
    same = {"fortran": np.asfortranarray(plain), "backwards": plain[::-1][::-1], "packed": packed["at"], "shifted": shifted, "big-endian": plain.astype(">f8")}
    return same | {"whole": plain.astype(np.int32), "float32": plain.astype(np.float32), "objects": objects, "masked": np.ma.masked_array(plain, False)}


@pytest.mark.parametrize("name", layouts())
def test_positions_in_any_layout(name: str) -> None:
    mill = abbe.Calibration(MILL)
    given = layouts()[name]
    assert np.array_equal(mill.error(given), mill.error(np.arange(12.0).reshape(4, 3)))


@pytest.mark.parametrize("kind", ["dict", "pandas", "polars", "pyarrow"])
def test_tables_of_positions_are_taken_by_their_names(kind: str) -> None:
    mill = abbe.Calibration(MILL)
    positions = np.random.default_rng(1).uniform(0, 400, (30, 3))
    table: object = {letter: positions[:, mill.axes.index(letter)] for letter in ["Z", "Y", "X"]}
    if kind != "dict":
        module = pytest.importorskip(kind)
        table = module.table(table) if kind == "pyarrow" else module.DataFrame(table)
    assert np.array_equal(mill.error(table), mill.error(positions))
    with pytest.raises(abbe.Error, match="`positions` has no column `Z`"):
        mill.error({"x": [1.0], "y": [2.0]})


def test_times_of_all_kinds() -> None:
    """Dates and times with a time zone, over the hour that is left out in spring."""
    pandas = pytest.importorskip("pandas")
    zoned = pandas.Series(pandas.Timestamp("2026-03-29 01:59:59.9", tz="Europe/Berlin") + pandas.to_timedelta(T, unit="s"))
    times = {"zoned": zoned, "naive": zoned.dt.tz_convert("UTC").dt.tz_localize(None)}
    times["objects"] = np.array([one.to_pydatetime() for one in times["naive"]], dtype=object)
    times["spans"] = zoned - zoned[0]
    for name, time in times.items():
        for table in [TABLE | {"time": time}, pandas.DataFrame(TABLE | {"time": time})]:
            assert np.allclose(record(table)["time"], T, rtol=0, atol=2e-9), name
    with pytest.raises(abbe.Error, match="`time`.*the row has no time"):
        record(TABLE | {"time": zoned.where(zoned.index != 3)})
    with pytest.raises(abbe.Error, match="`measured.x` holds times"):
        record(TABLE | {"measured.x": zoned})
    with pytest.raises(abbe.Error, match="holds objects: number 4, counted from 0, is 'a'"):
        record(TABLE | {"measured.x": np.array([1.0, None, np.nan, decimal.Decimal(1), "a"] * 10, dtype=object)})


def test_columns_of_databases() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    numbers = [decimal.Decimal(number).scaleb(-2) for number in range(50)]
    days = pyarrow.array(np.arange("2026-01-01", "2026-02-20", dtype="M8[D]"))
    table = pyarrow.table(TABLE | {"time": days, "command.x": pyarrow.array(numbers), "measured.x": pyarrow.array(T.astype(np.float16))})
    recording = record(table)
    assert recording["command.x"].tolist() == [number / 100 for number in range(50)]
    assert recording["time"].tolist() == [86400.0 * day for day in range(50)]
    assert np.array_equal(recording["measured.x"], T.astype(np.float16).astype(float))


def test_missing_and_masked_numbers_were_not_measured() -> None:
    pandas = pytest.importorskip("pandas")
    mask = np.arange(50) == 7
    nullable = pandas.array(np.where(mask, None, TABLE["measured.x"]), dtype="Float64")
    for column in [np.ma.masked_array(TABLE["measured.x"], mask), nullable, list(np.where(mask, None, TABLE["measured.x"]))]:
        assert np.array_equal(np.isnan(record(TABLE | {"measured.x": column})["measured.x"]), mask)
    with pytest.raises(abbe.Error, match="row 0, counted from 0"):
        abbe.Calibration(MILL).error(np.ma.masked_array([[1.0, 2.0, 3.0]], [[False, True, False]]))


def test_a_column_that_is_named_as_a_channel_is_not_left_out() -> None:
    with pytest.raises(abbe.Error, match="`measured.y` needs a unit") as caught:
        record(TABLE | {"measured.y": T})
    assert caught.value.code == "E0610"
    assert record(TABLE | {"remark": T}).channels == ["time", "run", "command.x", "measured.x"]


def test_functions_take_the_names_of_files(root: pathlib.Path) -> None:
    ballbar = "recordings/postech-ballbar/recording.yaml"
    assert abbe.evaluate(pathlib.Path(ballbar)).json == command("evaluate", ballbar, "--format", "json")
    assert abbe.simulate(MILL, ballbar).rows == abbe.Recording(ballbar).rows
    assert "X" in abbe.export("isg", MILL).text


MISTAKES: dict[str, tuple[Callable[[], object], str]] = {
    "unit": (lambda: record(units=UNITS | {"command.x": "furlong"}), "unknown unit `furlong`"),
    "unit of another kind": (lambda: record(units=UNITS | {"command.x": "deg"}), "`command.x` must be a length"),
    "no column": (lambda: record({"time": T, "measured.x": T}), "no column `command.x`"),
    "no columns": (lambda: record({}), "no columns"),
    "no rows": (lambda: record({name: values[:0] for name, values in TABLE.items()}), "no row"),
    "two dimensions": (lambda: record(TABLE | {"command.x": T[:, None]}), r"`command.x` has the shape \(50, 1\)"),
    "one number": (lambda: record(TABLE | {"command.x": 3}), r"`command.x` has the shape \(\)"),
    "text": (lambda: record(TABLE | {"command.x": ["1.5"] * 50}), "`command.x` holds <U3"),
    "an axis": (lambda: record(TABLE | {"command.q": T}, units=UNITS | {"command.q": "mm"}), "did you mean `command.x`"),
    "an array": (lambda: record(np.zeros((3, 3))), "found ndarray"),
    "a number": (lambda: abbe.Recording(3), "found int"),
    "a number for a calibration": (lambda: abbe.Calibration(3), "path or a dictionary, found int"),
    "a number for a machine": (lambda: abbe.Machine(3), "found int"),
    "a file that is not there": (lambda: abbe.Recording("nope.yaml"), "cannot read nope.yaml"),
    "a calibration": (lambda: abbe.Recording(MILL), "this is a calibration file"),
    "a table to diagnose": (lambda: abbe.diagnose(TABLE), "does not say what its columns mean"),
    "a calibration to diagnose": (lambda: abbe.diagnose(abbe.Calibration(MILL)), "found Calibration"),
    "positions": (lambda: abbe.Calibration(MILL).error(np.zeros((3, 2))), r"`positions` has the shape \(3, 2\), not \(n, 3\)"),
    "NaN": (lambda: abbe.Calibration(MILL).error([[0, np.nan, 0]]), "row 0"),
    "a position beyond any machine": (lambda: abbe.Calibration(MILL).error([[0, 0, 0], [0, 2e12, 0]]), "row 1, .* of Y is farther"),
    "text for positions": (lambda: abbe.Calibration(MILL).error("abc"), "`positions` holds <U3"),
    "complex numbers": (lambda: abbe.Calibration(MILL).error([[1, 2, 3j]]), "`positions` holds complex128"),
    "dates": (lambda: abbe.Calibration(MILL).error(np.zeros((1, 3), "M8[s]")), "`positions` holds datetime64"),
    "rows of many lengths": (lambda: abbe.Calibration(MILL).error([[1, 2, 3], [1]]), "`positions` is no array of numbers"),
    "a range": (lambda: abbe.Calibration(MILL).map("XY", ranges={"X": ("a", 1)}), r'`ranges\["X"\]` is a number, found str'),
    "three ends": (lambda: abbe.Calibration(MILL).map("XY", ranges={"X": (1, 2, 3)}), r'`ranges\["X"\]` is two numbers'),
    "points": (lambda: abbe.Calibration(MILL).map("XY", points=-1), "`points` is a whole number"),
    "a constant": (lambda: abbe.Machine("FX").levers(constants={"Zt": "50 mm"}), r'`constants\["Zt"\]` is a number, found str'),
    "lengths": (lambda: abbe.Machine("XYFZ").levers(x=[1, 2], y=[1, 2, 3]), r"`y` has the shape \(3,\), not \(2,\)"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told(name: str, root: pathlib.Path) -> None:
    call, told = MISTAKES[name]
    with pytest.raises(abbe.Error, match=told):
        call()


def test_options_are_told_as_arguments(tmp_path: pathlib.Path) -> None:
    stage = scaled(1)
    stage.write(tmp_path / "stage.yaml")
    with pytest.raises(abbe.Error, match="replace it with force=True"):
        stage.write(tmp_path / "stage.yaml")
    with pytest.raises(abbe.Error, match="give its travel with ranges Z"):
        abbe.Calibration(MILL).map("XY", at={"Z": 1e6})


def test_a_simulation_goes_over_no_file_that_it_reads(tmp_path: pathlib.Path) -> None:
    own = tmp_path / "stage.yaml"
    scaled(1).write(own)
    before = own.read_text()
    path = {"path": 1, "line": {"axis": "X", "from": "0 mm", "to": "20 mm"}, "feed": "1000 mm/min", "rate": "100 Hz", "instrument": "position"}
    with pytest.raises(abbe.Error, match="is one of the files that this command reads"):
        abbe.simulate(abbe.Calibration(own), path, output=own, force=True)
    assert own.read_text() == before
