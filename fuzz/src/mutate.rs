//! Mutations without a search: what a stable compiler and a test can do. In: files that are right or nearly right, a
//! seed. Out: files that are wrong in the ways in which files are wrong: bytes lost, lines moved, another program's marks,
//! numbers that no machine has.

/// Words that a reader may stumble over: YAML's own, numbers at the edges, marks of other programs.
const WORDS: [&str; 72] = [
    "1e308",
    "-1e308",
    "1e309",
    "1e400",
    "1e-400",
    "5e-324",
    "-0",
    "0",
    "nan",
    ".nan",
    "inf",
    "-.inf",
    "1e",
    "e1",
    "+",
    "-",
    "1_000",
    "0x10",
    "1,5",
    "1 234",
    "9999999999999999999",
    "18446744073709551616",
    "-1",
    "0.1",
    "1e999999999",
    "&a",
    "*a",
    "!!float",
    "!t",
    "<<: *a",
    "~",
    "null",
    "true",
    "? ",
    ": ",
    "- ",
    "[",
    "]",
    "{",
    "}",
    "[[[[[[[[",
    "|\n",
    ">\n",
    "'",
    "\"",
    "\\u0000",
    "#",
    "%YAML 1.2\n",
    "---\n",
    "...\n",
    "\t",
    "\r\n",
    "\r",
    "\n",
    "\n\n",
    "\u{feff}",
    "\u{2028}",
    "\u{0}",
    "\u{1b}[31m",
    "\u{202e}",
    "\u{301}",
    "\u{10ffff}",
    ";",
    ",,",
    "#unit,",
    "um",
    "deg",
    "degC",
    "1/s",
    "X",
    "(((((",
    "^99",
];

/// A row of numbers that depends on its seed alone.
#[derive(Clone, Debug)]
pub struct Chance(u64);

impl Chance {
    /// The row of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed ^ 0x9e37_79b9_7f4a_7c15)
    }

    /// The next number, 0 up to `end`, which is not included; 0 where `end` is.
    pub fn below(&mut self, end: usize) -> usize {
        // The generator splitmix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let mixed = mixed ^ (mixed >> 31);
        usize::try_from(mixed >> 32).unwrap_or_default() % end.max(1)
    }

    fn of<'a, T: ?Sized>(&mut self, list: &[&'a T]) -> Option<&'a T> {
        let at = self.below(list.len());
        list.get(at).copied()
    }
}

/// A file made from one of `files`, or from parts of two, by one to four mutations.
pub fn mutated(files: &[Vec<u8>], chance: &mut Chance) -> Vec<u8> {
    let pick = |chance: &mut Chance| files.get(chance.below(files.len())).cloned().unwrap_or_default();
    let (mut file, other) = (pick(chance), pick(chance));
    for _ in 0..=chance.below(4) {
        mutate(&mut file, &other, chance);
    }
    file
}

fn mutate(file: &mut Vec<u8>, other: &[u8], chance: &mut Chance) {
    let at = chance.below(file.len() + 1);
    let word = stretch(file, chance.below(file.len() + 1));
    let new = chance.of(&WORDS).unwrap_or_default().as_bytes().to_vec();
    match chance.below(10) {
        // The word at a place becomes another one: most of what a reader decides is decided word by word.
        0..3 => drop(file.splice(word, new)),
        3 => drop(file.splice(at..at, new)),
        4 => {
            let line = lines(file, chance);
            file.drain(line);
        }
        5 => {
            let line = file.get(lines(file, chance)).unwrap_or_default().to_vec();
            let to = lines(file, chance).start;
            drop(file.splice(to..to, line));
        }
        6 => {
            let line = other.get(lines(other, chance)).unwrap_or_default().to_vec();
            let to = lines(file, chance).start;
            drop(file.splice(to..to, line));
        }
        7 => {
            let word = other.get(stretch(other, chance.below(other.len() + 1))).unwrap_or_default().to_vec();
            let place = stretch(file, at);
            drop(file.splice(place, word));
        }
        8 => file.truncate(at),
        _ => {
            if let Some(byte) = file.get_mut(at) {
                *byte ^= 1 << chance.below(8);
            }
        }
    }
}

/// The letters and digits around a place.
fn stretch(file: &[u8], at: usize) -> std::ops::Range<usize> {
    let part = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-' | b'+');
    let (before, after) = file.split_at(at.min(file.len()));
    let start = before.iter().rev().take_while(|byte| part(byte)).count();
    let end = after.iter().take_while(|byte| part(byte)).count();
    before.len() - start..before.len() + end
}

/// A line, with its end.
fn lines(file: &[u8], chance: &mut Chance) -> std::ops::Range<usize> {
    let at = chance.below(file.len() + 1);
    let (before, after) = file.split_at(at);
    let start = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let end = after.iter().position(|byte| *byte == b'\n').map_or(file.len(), |end| at + end + 1);
    start..end
}
