//! Machines for the tests. In: a topology word and errors as a calibration file has them. Out: what an export begins with.

use abbe_exchange::controller::{Export, Format, Geometry, Options, Refused, Space, Wanted, export};
use abbe_exchange::controller::{Kind, Unit};
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::{compile, yaml};

/// A machine with its numbers.
pub(crate) struct Machine {
    pub(crate) equations: Equations,
    pub(crate) calibration: Calibration,
}

impl Machine {
    /// A machine file's text and a calibration's, from `errors:` on or before it.
    pub(crate) fn new(machine: &str, rest: &str) -> Self {
        let source = SourceFile::new("machine", machine);
        let equations = compile(&source, &mut Diagnostics::new()).unwrap().equations;
        let constants = equations.constants.iter().map(|constant| constant.name.to_string());
        let given = constants.map(|name| format!("{name}: {} mm", if name == "Zt" { 150 } else { 20 }));
        let constants = given.collect::<Vec<_>>().join(", ");
        let text = format!("calibration: 1\nmachine: m\nconstants: {{{constants}}}\n{rest}");
        let source = SourceFile::new("calibration", text);
        let mut diagnostics = Diagnostics::new();
        let root = yaml::read(&source, &mut diagnostics).unwrap();
        match calibration::read(&root, &equations.names(), &mut diagnostics) {
            Some(calibration) => Self { equations, calibration },
            None => panic!("{}", render(&source, &diagnostics, false)),
        }
    }

    /// A topology word with errors, each a line `EXX: ...`.
    pub(crate) fn of(word: &str, errors: &[String]) -> Self {
        let errors: String = errors.iter().map(|error| format!("  {error}\n")).collect();
        Self::new(&format!("abbe: 1\nname: m\ntopology: {word}\n"), &format!("errors:\n{errors}"))
    }

    pub(crate) fn geometry(&self) -> Geometry<'_> {
        Geometry::new(&self.equations, &self.calibration)
    }

    /// A workspace of 500, 300 and 200 mm about the zero.
    pub(crate) fn space(&self) -> Space {
        self.space_with(&[("X", [-100.0, 400.0]), ("Y", [-200.0, 100.0]), ("Z", [-100.0, 100.0])])
    }

    pub(crate) fn space_with(&self, ranges: &[(&str, [f64; 2])]) -> Space {
        let there = |letter: &str| self.equations.axes.iter().any(|axis| axis.letter == letter);
        let ranges = ranges
            .iter()
            .filter(|(letter, _)| there(letter))
            .map(|(letter, range)| ((*letter).to_owned(), *range));
        let wanted = Wanted { ranges: ranges.collect(), reference: Vec::new() };
        Space::new(&self.equations, &self.calibration, &wanted).unwrap()
    }

    pub(crate) fn export(&self, format: Format, options: &Options) -> Result<Export, Refused> {
        export(&self.geometry(), &self.space(), format, options)
    }
}

/// Nothing said by the user but the counts of three motors.
pub(crate) fn options() -> Options {
    Options {
        points: None,
        kind: Kind::Trim,
        unit: Unit::MM,
        sense: None,
        tables: 8,
        names: Vec::new(),
        counts: ["X", "Y", "Z"].map(|letter| (letter.to_owned(), 10_000.0)).to_vec(),
    }
}

/// The text of a file of an export.
pub(crate) fn text<'e>(export: &'e Export, name: &str) -> &'e str {
    &export.files.iter().find(|file| file.name == name).unwrap().text
}

/// Bilinear interpolation in rows of heights over two ranges, the edges held outside: what every firmware of printers does.
pub(crate) fn bilinear<R: AsRef<[f64]>>(rows: &[R], ends: [[f64; 2]; 2], place: [f64; 2]) -> f64 {
    let cell = |place: f64, [from, to]: [f64; 2], points: usize| {
        let last = u32::try_from(points - 1).unwrap();
        let share = ((place - from) / (to - from)).clamp(0.0, 1.0) * f64::from(last);
        let cell = (0..last).rev().find(|cell| f64::from(*cell) <= share).unwrap();
        (usize::try_from(cell).unwrap(), share - f64::from(cell))
    };
    let (i, s) = cell(place[0], ends[0], rows[0].as_ref().len());
    let (j, t) = cell(place[1], ends[1], rows.len());
    let along = |j: usize| rows[j].as_ref()[i] * (1.0 - s) + rows[j].as_ref()[i + 1] * s;
    along(j) * (1.0 - t) + along(j + 1) * t
}
