//! `abbe.Recording`. In: a recording file, or a table in memory and what a recording file would say of it. Out: its columns as arrays, and
//! what a diagnosis starts from.

use std::path::PathBuf;

use model_dsl::source::SourceFile;
use numpy::PyArray1;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use recording::{Header, Instrument};
use workshop::named::Files;
use workshop::recorded::{self, Recorded};

use crate::arguments::{self, Entries};
use crate::calibration::Calibration;
use crate::columns::Table;
use crate::error::{Heard, raised, working, wrong};
use crate::file::{self, Text};
use crate::machine::Machine;

/// What people call a table in memory.
const TABLE: &str = "<table>";

/// What was measured on a machine, and all that it names: its machine, and the calibration that it counts on.
///
/// `Recording("circle.yaml")` reads a recording file. `Recording(table, machine=..., units=..., setup=...)` takes a table in memory:
/// anything with `__arrow_c_stream__` (pandas, polars, pyarrow ...), or a dict of arrays. Its columns are named as the channels of a
/// recording file are: `time`, `run`, `command.x`, `actual.x`, `measured.x`, `deviation`, `temperature.spindle`, `load.feed`; or
/// `channels` gives the column of each channel, `{"command.x": "x_cmd"}`. `units` gives the unit of each channel or column; a column that
/// is named as a channel is one, and needs its unit. All others of the arguments are the keys of a recording file. Files that they name are counted from the current folder. A column of dates and
/// times is a time too, counted from its first; a column `run` is the channel `run`; what is missing (null, NaN) was not measured.
///
/// >>> import abbe, numpy as np
/// >>> t = np.arange(200) * 0.01
/// >>> x = 50 - 50 * np.cos(np.pi * t)
/// >>> table = {"time": t, "command.x": x, "measured.x": x + 0.005 * np.sign(np.sin(np.pi * t))}
/// >>> stage = abbe.Recording(table, machine="FX", units={"time": "s", "command.x": "mm", "measured.x": "mm"})
/// >>> stage.rows, stage.channels
/// (200, ['time', 'run', 'command.x', 'measured.x'])
#[pyclass(module = "abbe", frozen)]
pub(crate) struct Recording {
    recorded: Recorded,
    text: Text,
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (source, *, machine = None, units = None, channels = None, setup = None, instrument = None,
                        calibration = None, constants = None, holdout = None, title = None))]
    #[expect(clippy::too_many_arguments, reason = "each is a name for the caller")]
    fn new(
        source: &Bound<'_, PyAny>,
        machine: Option<&Bound<'_, PyAny>>,
        units: Option<Entries<'_>>,
        channels: Option<Entries<'_>>,
        setup: Option<Entries<'_>>,
        instrument: Option<&str>,
        calibration: Option<&Bound<'_, PyAny>>,
        constants: Option<Entries<'_>>,
        holdout: Option<Entries<'_>>,
        title: Option<&Bound<'_, PyString>>,
    ) -> PyResult<Self> {
        let py = source.py();
        let is_file = source.is_instance_of::<PyString>() || source.hasattr("__fspath__")?;
        let said = machine.is_some() || units.is_some() || channels.is_some() || setup.is_some();
        let said = said || instrument.is_some() || calibration.is_some() || constants.is_some();
        if is_file && (said || holdout.is_some() || title.is_some()) {
            return Err(wrong(
                py,
                "a recording file says all that the other arguments say\nhelp: give the file alone, or a table with them",
            ));
        }
        if is_file {
            return Self::of_file(py, file::path(source)?);
        }
        let table = Table::read(source)?;
        let head = PyDict::new(py);
        head.set_item("recording", 1)?;
        if let Some(title) = title {
            head.set_item("title", title)?;
        }
        let machine = machine.ok_or_else(|| {
            wrong(py, "a table does not say what machine it is of\nhelp: machine=... takes a machine file, a shipped machine's name or a topology word")
        })?;
        head.set_item("machine", Machine::name_of(machine)?)?;
        if let Some(calibration) = calibration {
            head.set_item("calibration", calibration_named(calibration)?)?;
        }
        if let Some(constants) = constants {
            head.set_item("constants", constants.0)?;
        }
        head.set_item("instrument", instrument.unwrap_or("position"))?;
        head.set_item("data", "memory")?;
        head.set_item("channels", channels_of(py, channels.as_ref(), units.as_ref(), &table.names())?)?;
        for (key, value) in [("setup", setup), ("holdout", holdout)] {
            if let Some(Entries(value)) = value {
                head.set_item(key, value)?;
            }
        }
        let source = SourceFile::new("<recording>", file::written(&head, "recording")?);
        Self::of_table(py, Text { source, path: PathBuf::from("recording") }, &table)
    }

    /// The recording file; `<recording>` for a table.
    #[getter]
    fn file(&self) -> &str {
        self.text.source.name()
    }

    /// The recording file as text; for a table the one that would say the same.
    #[getter]
    fn text(&self) -> &str {
        self.text.source.text()
    }

    /// Its title, or None.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.recorded.recording.title.as_deref()
    }

    /// What measured: `position`, `ballbar`, `linear`, `straightness`, `angular` or `probe`.
    #[getter]
    fn instrument(&self) -> &'static str {
        match self.recorded.recording.instrument {
            Instrument::Position => "position",
            Instrument::Ballbar { .. } => "ballbar",
            Instrument::Linear(_) => "linear",
            Instrument::Straightness(_) => "straightness",
            Instrument::Angular { .. } => "angular",
            Instrument::Probe => "probe",
        }
    }

    /// The machine that was recorded.
    #[getter]
    fn machine(&self, py: Python<'_>) -> PyResult<Machine> {
        let name = Files::of(&self.recorded, &self.text.path).machine;
        Machine::named(py, &name, self.text.folder())
    }

    /// How many rows it has.
    #[getter]
    fn rows(&self) -> usize {
        self.recorded.recording.time.len()
    }

    /// The names of its channels.
    #[getter]
    fn channels(&self) -> Vec<String> {
        self.named().into_iter().map(|(name, _)| name).collect()
    }

    /// What a reader of results should know of the data, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.recorded.recording.notes.clone()
    }

    /// A channel as an array (rows,): s since the first row, mm, rad, degC or the unit of a load; NaN where nothing was measured.
    fn __getitem__<'py>(&self, py: Python<'py>, channel: &str) -> PyResult<Bound<'py, PyAny>> {
        if channel == "run" {
            return Ok(PyArray1::from_slice(py, &self.recorded.recording.run).into_any());
        }
        let found = self.named().into_iter().find(|(name, _)| name == channel);
        match found {
            Some((_, values)) => Ok(PyArray1::from_slice(py, values).into_any()),
            None => {
                let all = self.channels().join(", ");
                Err(PyKeyError::new_err(format!("there is no channel `{channel}`; there are {all}")))
            }
        }
    }

    /// All channels by name, as arrays: what `pandas.DataFrame` and `polars.DataFrame` take.
    ///
    /// >>> import abbe
    /// >>> table = {"time": [0.0, 1.0], "command.x": [0.0, 10.0], "measured.x": [0.0, 10.002]}
    /// >>> stage = abbe.Recording(table, machine="FX", units={"time": "s", "command.x": "mm", "measured.x": "mm"})
    /// >>> stage.columns()["measured.x"]
    /// array([ 0.   , 10.002])
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for name in self.channels() {
            columns.set_item(&name, self.__getitem__(py, &name)?)?;
        }
        Ok(columns)
    }

    fn __len__(&self) -> usize {
        self.rows()
    }

    fn __repr__(&self) -> String {
        let machine = &self.recorded.equations.machine;
        format!("<abbe.Recording of {machine}: {}, {} rows, {}>", self.instrument(), self.rows(), self.file())
    }
}

impl Recording {
    /// A recording, or one that is read from its file.
    pub(crate) fn taken<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Self>> {
        if let Ok(recording) = given.cast::<Self>() {
            return Ok(recording.clone());
        }
        let what = "a recording is an abbe.Recording or the path of a recording file";
        Bound::new(given.py(), Self::of_file(given.py(), arguments::path(given, what)?)?)
    }

    /// One recording or several, each of which may be given by its file.
    pub(crate) fn all_taken<'py>(given: &Bound<'py, PyAny>) -> PyResult<Vec<Bound<'py, Self>>> {
        let is_path = given.is_instance_of::<PyString>() || given.hasattr("__fspath__")?;
        if is_path || given.cast::<Self>().is_ok() {
            return Ok(vec![Self::taken(given)?]);
        }
        if given.extract::<Entries<'_>>().is_ok() || given.hasattr("__arrow_c_stream__")? {
            let help = "help: abbe.Recording(table, machine=..., units=...) says it";
            return Err(wrong(given.py(), format!("a table does not say what its columns mean\n{help}")));
        }
        let Ok(all) = given.try_iter() else { return Ok(vec![Self::taken(given)?]) };
        all.map(|one| Self::taken(&one?)).collect()
    }

    /// Reads a file and its data.
    pub(crate) fn of_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let recorded = working(py, |heard| recorded::read(&path, heard))?;
        let source = recorded.source.clone();
        Ok(Self { recorded, text: Text { source, path } })
    }

    /// What was read, with the text that it was read from.
    pub(crate) fn of_recorded(recorded: Recorded, text: Text) -> Self {
        Self { recorded, text }
    }

    fn of_table(py: Python<'_>, text: Text, table: &Table<'_>) -> PyResult<Self> {
        let names = table.names();
        let heard = Heard::default();
        let data =
            |header: &Header| header.read_columns(TABLE, &names, |index| table.column(index, header, TABLE));
        let recorded = recorded::of(text.source.clone(), text.folder(), data, &heard);
        heard.say(py)?;
        Ok(Self { recorded: recorded.map_err(|failure| raised(py, &failure))?, text })
    }

    /// All that was read.
    pub(crate) fn recorded(&self) -> &Recorded {
        &self.recorded
    }

    /// The recording file, or where one of a table would stand.
    pub(crate) fn text_file(&self) -> &Text {
        &self.text
    }

    /// The channels of numbers by name; `run`, whose numbers are whole, stands with the times.
    fn named(&self) -> Vec<(String, &[f64])> {
        let recording = &self.recorded.recording;
        let mut all: Vec<(String, &[f64])> =
            vec![("time".to_owned(), &recording.time), ("run".to_owned(), &recording.time)];
        let letters = self.recorded.equations.axes.iter().map(|axis| axis.letter.to_lowercase());
        for (letter, axis) in letters.zip(&recording.axes) {
            for (what, values) in
                [("command", &axis.command), ("actual", &axis.actual), ("measured", &axis.measured)]
            {
                all.extend(values.as_deref().map(|values| (format!("{what}.{letter}"), values)));
            }
        }
        for (letter, values) in ["x", "y", "z"].into_iter().zip(&recording.measured) {
            all.extend(values.as_deref().map(|values| (format!("measured.{letter}"), values)));
        }
        all.extend(recording.deviation.as_deref().map(|values| ("deviation".to_owned(), values)));
        for (letter, values) in ["x", "y", "z"].into_iter().zip(recording.normal.iter().flatten()) {
            all.push((format!("normal.{letter}"), values));
        }
        for (what, channels) in [("temperature", &recording.temperatures), ("load", &recording.loads)] {
            all.extend(
                channels
                    .iter()
                    .map(|channel| (format!("{what}.{}", channel.name), channel.values.as_slice())),
            );
        }
        all
    }
}

/// The name of a calibration: of an object its file.
fn calibration_named(calibration: &Bound<'_, PyAny>) -> PyResult<String> {
    let Ok(known) = calibration.cast::<Calibration>() else {
        let what = "a calibration is an abbe.Calibration or a path";
        return Ok(arguments::path(calibration, what)?.display().to_string());
    };
    let path = known.get().path();
    if path.is_file() {
        return Ok(path.display().to_string());
    }
    Err(wrong(
        calibration.py(),
        "the calibration is no file yet, which a recording could name\nhelp: write it first, with calibration.write(path)",
    ))
}

/// The first words of the names of channels.
const CHANNELS: [&str; 9] =
    ["time", "run", "deviation", "command", "actual", "measured", "normal", "temperature", "load"];

/// `channels` of the recording file: for each channel its column and unit. A column that is named as a channel is one.
fn channels_of<'py>(
    py: Python<'py>,
    given: Option<&Entries<'py>>,
    units: Option<&Entries<'py>>,
    names: &[String],
) -> PyResult<Bound<'py, PyDict>> {
    let channels = PyDict::new(py);
    let mut columns = Vec::new();
    for (channel, column) in Entries::pairs(given, "channels")? {
        if let Ok(Entries(entry)) = column.extract() {
            channels.set_item(channel, entry)?;
            continue;
        }
        let column = arguments::text(&column, &format!("`channels[\"{channel}\"]`"))?;
        let unit = Entries::at(units, &channel)?.or(Entries::at(units, &column)?);
        channels.set_item(&channel, entry(py, &column, unit)?)?;
        columns.push(column);
    }
    let with_units = Entries::pairs(units, "units")?;
    let named = with_units.into_iter().map(|(name, unit)| (name, Some(unit)));
    let is_channel = |name: &&String| name.split('.').next().is_some_and(|word| CHANNELS.contains(&word));
    let others = names.iter().filter(is_channel).map(|name| (name.clone(), None));
    for (name, unit) in named.chain(others) {
        if !channels.contains(&name)? && !columns.contains(&name) {
            channels.set_item(&name, entry(py, &name, unit)?)?;
        }
    }
    Ok(channels)
}

fn entry<'py>(
    py: Python<'py>,
    column: &str,
    unit: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("column", column)?;
    if let Some(unit) = unit.filter(|unit| !unit.is_none()) {
        entry.set_item("unit", unit)?;
    }
    Ok(entry)
}
