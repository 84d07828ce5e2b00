//! Finding and compiling machines. In: a path, a shipped name or a topology word. Out: the
//! compiled machine, its warnings shown; or every mistake, located.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use model_dsl::check;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Names;
use model_dsl::machine::TopologyWord;
use model_dsl::source::{SourceFile, Span};
use model_dsl::suggest::nearest;
use model_dsl::{Compiled, compile, compile_word};
use notation::Published;

use crate::failure::Failure;
use crate::shipped;
use crate::told::{Listener, Words};

/// A machine and the file (or word) that it came from.
pub struct Loaded {
    /// The file's name for people: its path, or the shipped file's.
    pub origin: String,
    /// The file itself; none of a bare word.
    pub source: Option<SourceFile>,
    /// The compiled machine.
    pub compiled: Compiled,
    /// The equations that were published about it, where the program has them.
    pub published: Option<SourceFile>,
}

impl Loaded {
    /// The page of the machine for a browser, with how it stands to what was published about it.
    #[must_use]
    pub fn page(&self, names: Names) -> String {
        let Self { compiled, published, .. } = self;
        let compared = published.iter().filter_map(|file| {
            let report = check::check(&compiled.machine, &compiled.equations, file, &mut Diagnostics::new());
            report.map(|report| Published::new(file, report))
        });
        notation::page(&compiled.equations, names, &compared.collect::<Vec<_>>())
    }
}

/// No byte beyond this one is read: a larger file is refused, and a device may have no end.
const MOST_BYTES: u64 = 8 * 1024 * 1024;

/// Reads a text file.
pub fn read(path: &Path) -> Result<SourceFile, Failure> {
    let text = String::from_utf8(bytes(path)?).map_err(|error| {
        cannot(path, &format!("the file is not UTF-8 text (byte {})", error.utf8_error().valid_up_to()))
    })?;
    Ok(SourceFile::new(path.display().to_string(), text))
}

/// Reads a file that need not be text.
pub fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let bytes = head(path)?;
    if u64::try_from(bytes.len()).is_ok_and(|length| length > MOST_BYTES) {
        return Err(too_large(path));
    }
    Ok(bytes)
}

/// The beginning of a file that can be read again; nothing of a pipe, which can not.
pub fn head_of_file(path: &Path) -> Result<Option<Vec<u8>>, Failure> {
    let is_file = std::fs::metadata(path).is_ok_and(|there| there.is_file());
    is_file.then(|| head(path)).transpose()
}

/// Reads a file up to one byte more than the most that are taken.
fn head(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| match near_file(path, &[]) {
        Some(near) if error.kind() == ErrorKind::NotFound => {
            cannot(path, &format!("{error}\nhelp: did you mean `{near}`?"))
        }
        _ => cannot(path, &error.to_string()),
    })?;
    let read = file.take(MOST_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| cannot(path, &error.to_string()))?;
    Ok(bytes)
}

fn cannot(path: &Path, why: &str) -> Failure {
    Failure::wrong(format!("error: cannot read {}: {why}", path.display()))
}

fn too_large(path: &Path) -> Failure {
    let source = SourceFile::new(path.display().to_string(), "");
    let message = format!("the file is larger than {} MiB", MOST_BYTES >> 20);
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(
        Diagnostic::error("E0003", Span::default(), message).help("split the file, or thin out its tables"),
    );
    Failure::marked(&source, &diagnostics)
}

/// Compiles what the user named; paths are counted from `folder` where it is given.
pub fn machine(name: &str, folder: Option<&Path>, listener: &dyn Listener) -> Result<Loaded, Failure> {
    let path = folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    // A pipe is a file too, as in `abbe derive <(...)`.
    let there = std::fs::metadata(&path).ok();
    if there.as_ref().is_some_and(|there| !there.is_dir()) {
        return from_source(&read(&path)?, listener);
    }
    if let Some(text) = shipped::machine(name) {
        return from_source(&SourceFile::new(format!("machines/{name}.yaml"), text), listener);
    }
    if is_word(name) {
        return from_word(name);
    }
    match there {
        Some(_) => Err(Failure::wrong(format!(
            "error: {} is a folder\nhelp: give the path of a machine file in it",
            path.display()
        ))),
        None => Err(Failure::wrong(unknown(name, &path))),
    }
}

/// The file in the same folder whose name is nearest to one that is not there, of those with some endings or of all.
pub(crate) fn near_file(path: &Path, endings: &[&str]) -> Option<String> {
    let wanted = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let there = std::fs::read_dir(folder.unwrap_or_else(|| Path::new("."))).ok()?;
    let names = there.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> =
        names.filter(|name| endings.is_empty() || endings.iter().any(|end| name.ends_with(end))).collect();
    // A folder lists its files in no order.
    names.sort_unstable();
    let near = nearest(wanted, names.iter().map(String::as_str))?;
    Some(path.with_file_name(near).display().to_string())
}

fn from_source(source: &SourceFile, listener: &dyn Listener) -> Result<Loaded, Failure> {
    let mut diagnostics = Diagnostics::new();
    match compile(source, &mut diagnostics) {
        Some(compiled) => {
            listener.hear(&Words::marked(source, &diagnostics));
            let published = shipped::published(source.text());
            let published = published.map(|(name, text)| SourceFile::new(name, text));
            let origin = source.name().to_owned();
            Ok(Loaded { origin, source: Some(source.clone()), compiled, published })
        }
        None => Err(Failure::marked(source, &diagnostics)),
    }
}

/// Whether a name is a topology, right or wrong: a short word of capital letters, one of the letters of axes and the bed, whatever digits
/// stand among them, or one that is only in small letters where it should be in capital ones.
fn is_word(name: &str) -> bool {
    const LONGEST_OTHER: usize = 8;
    let capital = |letter: u8| letter.is_ascii_uppercase();
    let of_axes = |letter: u8| b"XYZABCUVWF".contains(&letter) || letter.is_ascii_digit();
    let short = !name.is_empty() && name.len() <= LONGEST_OTHER && name.bytes().all(capital);
    let upper = name.to_ascii_uppercase();
    let small = || TopologyWord::parse(&upper, Span::default(), &mut Diagnostics::new()).is_some();
    short || name.bytes().any(capital) && name.bytes().all(of_axes) || small()
}

fn from_word(word: &str) -> Result<Loaded, Failure> {
    let source = SourceFile::new("topology", word);
    let mut diagnostics = Diagnostics::new();
    let compiled = compile_word(word, &mut diagnostics);
    let compiled = compiled.ok_or_else(|| Failure::marked(&source, &diagnostics))?;
    Ok(Loaded { origin: format!("the topology {word}"), source: None, compiled, published: None })
}

fn unknown(name: &str, path: &Path) -> String {
    let names = shipped::MACHINES.map(|(known, _)| known);
    // Machines are in YAML files.
    let beside = near_file(path, &[".yaml", ".yml"]);
    let help = match beside.as_deref().or_else(|| nearest(name, names)) {
        Some(known) => format!("did you mean `{known}`?"),
        None => format!(
            "give the path of a machine file, a topology word such as XYFZ, or one of: {}",
            names.join(", ")
        ),
    };
    format!("error: no machine `{name}`: there is no such file, shipped machine or topology\nhelp: {help}")
}
