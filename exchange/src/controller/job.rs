//! What the formats get and give. In: a geometry, its workspace, options. Out: files; a controller that takes files.

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use super::geometry::Geometry;
use super::lost::Target;
use super::options::Options;
use super::refused::Refused;
use super::space::Space;

/// One file.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// Its name.
    pub name: String,
    /// The axis whose it is alone, by number, where its text does not say it.
    pub axis: Option<usize>,
    /// What stands in it.
    pub text: String,
    /// What it is, in a few words.
    pub about: String,
}

/// What the writers of all formats get.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job<'j, 'c> {
    pub(super) geometry: &'j Geometry<'c>,
    pub(super) space: &'j Space,
    pub(super) options: &'j Options,
}

impl Job<'_, '_> {
    /// The controller's names of the axes: what the user says, else what `default` makes of the axis's place and letter.
    ///
    /// # Errors
    /// Two axes of one name, and what no controller takes for a name.
    pub(super) fn names(&self, default: impl Fn(usize, &str) -> String) -> Result<Vec<String>, Refused> {
        let axes = &self.geometry.equations.axes;
        let said = |(place, letter)| {
            self.options.name(letter).map_or_else(|| default(place, letter), ToOwned::to_owned)
        };
        let names: Vec<String> = axes.iter().map(|axis| axis.letter.as_str()).enumerate().map(said).collect();
        let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        if let Some(name) = names.iter().find(|name| !name.chars().all(plain)) {
            let what =
                format!("`{name}` is no name of an axis: it has other signs than letters, digits and `_`");
            return Err(Refused::new(
                what,
                "give the name that the controller has for the axis, as in --name X=MX1",
            ));
        }
        for (number, name) in names.iter().enumerate() {
            if let Some(other) = names.iter().take(number).position(|other| other == name) {
                let [one, other] = [other, number].map(|axis| axes.get(axis).map_or("", |axis| &axis.letter));
                let what = format!("{one} and {other} are both called `{name}`");
                return Err(Refused::new(what, "give each its own name with --name"));
            }
        }
        Ok(names)
    }
}

/// What the writers of all formats give.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Written {
    pub(super) files: Vec<File>,
    pub(super) loading: Vec<String>,
    pub(super) left_out: Vec<String>,
}

/// A controller that takes files.
pub(super) trait Controller: Target {
    /// Takes a file as the controller's maker documents it; `axis` is the axis whose it is, where its text does not say it.
    fn load(&mut self, source: &SourceFile, axis: Option<usize>, diagnostics: &mut Diagnostics);

    /// What it takes otherwise than somebody might think.
    fn findings(&self) -> Vec<String> {
        Vec::new()
    }

    /// The target that it is then.
    fn target(&self) -> &dyn Target;
}
