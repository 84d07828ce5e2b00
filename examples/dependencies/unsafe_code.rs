//! Unsafe code in Rust sources. In: text. Out: how many blocks, functions, implementations and traits are unsafe, how many
//! blocks of foreign functions are declared, and what a crate says of unsafe code in itself. It reads tokens, so that comments
//! and strings do not count; what stands in the body of a macro counts once, however often the macro is used.

use std::ops::AddAssign;
use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// How often each form occurs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) blocks: usize,
    /// With a body or a name; the types of pointers to functions are not counted.
    pub(crate) functions: usize,
    pub(crate) implementations: usize,
    pub(crate) traits: usize,
    /// `extern "C" { ... }`, with the word `unsafe` or without it.
    pub(crate) foreign: usize,
}

impl Counts {
    /// Whether there is nothing to count.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.blocks += other.blocks;
        self.functions += other.functions;
        self.implementations += other.implementations;
        self.traits += other.traits;
        self.foreign += other.foreign;
    }
}

/// What a crate says of unsafe code in itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stance {
    /// It says nothing.
    Silent,
    /// It forbids it for some features or systems.
    SometimesForbids,
    /// Its lint is `deny`: an exception has to be written down.
    Denies,
    /// It has none.
    Forbids,
}

/// The forms in one file.
///
/// # Errors
///
/// It is not made of Rust's tokens.
pub(crate) fn counted(text: &str) -> Result<Counts, String> {
    Ok(forms(tokens(text)?))
}

/// What the file of a library says at its top.
///
/// # Errors
///
/// It is not made of Rust's tokens.
pub(crate) fn stance(text: &str) -> Result<Stance, String> {
    let tokens: Vec<TokenTree> = tokens(text)?.into_iter().collect();
    let attributes = tokens.windows(3).filter_map(|window| match window {
        [TokenTree::Punct(hash), TokenTree::Punct(inner), TokenTree::Group(group)]
            if hash.as_char() == '#' && inner.as_char() == '!' =>
        {
            Some(said(group.stream()))
        }
        _ => None,
    });
    Ok(attributes.max().unwrap_or(Stance::Silent))
}

fn tokens(text: &str) -> Result<TokenStream, String> {
    TokenStream::from_str(text).map_err(|error| error.to_string())
}

/// What one inner attribute says: `forbid(unsafe_code)`, `cfg_attr(..., forbid(unsafe_code))` or something else.
fn said(attribute: TokenStream) -> Stance {
    let tokens: Vec<TokenTree> = attribute.into_iter().collect();
    let [TokenTree::Ident(name), TokenTree::Group(arguments), ..] = &tokens[..] else {
        return Stance::Silent;
    };
    let of_unsafe_code = || arguments.stream().into_iter().any(|token| is_word(&token, "unsafe_code"));
    if name == "forbid" && of_unsafe_code() {
        Stance::Forbids
    } else if name == "deny" && of_unsafe_code() {
        Stance::Denies
    } else if name == "cfg_attr" && conditional(arguments.stream()) {
        Stance::SometimesForbids
    } else {
        Stance::Silent
    }
}

fn conditional(arguments: TokenStream) -> bool {
    let tokens: Vec<TokenTree> = arguments.into_iter().collect();
    (0..tokens.len()).any(|at| said(tokens[at..].iter().cloned().collect()) == Stance::Forbids)
}

fn forms(tokens: TokenStream) -> Counts {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut counts = Counts::default();
    for (at, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(group) => counts += forms(group.stream()),
            token if is_word(token, "unsafe") => counts += form(&tokens[at + 1..]),
            token if is_word(token, "extern") => {
                counts.foreign += usize::from(is_braces(after_abi(&tokens[at + 1..]).first()));
            }
            _ => {}
        }
    }
    counts
}

/// The form that the word `unsafe` opens. `#[unsafe(no_mangle)]` and the like open none.
fn form(rest: &[TokenTree]) -> Counts {
    let word = |word| rest.first().is_some_and(|token| is_word(token, word));
    let mut counts = Counts::default();
    if is_braces(rest.first()) {
        counts.blocks = 1;
    } else if word("fn") || word("extern") {
        let rest = if word("extern") { after_abi(&rest[1..]) } else { rest };
        counts.functions = usize::from(is_named_function(rest));
    } else if word("impl") {
        counts.implementations = 1;
    } else if word("trait") || word("auto") {
        counts.traits = 1;
    }
    counts
}

/// What follows `extern` and, where one is written, `"C"`.
fn after_abi(rest: &[TokenTree]) -> &[TokenTree] {
    match rest {
        [TokenTree::Literal(_), rest @ ..] => rest,
        _ => rest,
    }
}

/// `fn name`, or `fn $name` in a macro; `fn(` is a type.
fn is_named_function(rest: &[TokenTree]) -> bool {
    matches!(rest, [word, next, ..] if is_word(word, "fn") && !matches!(next, TokenTree::Group(_)))
}

fn is_word(token: &TokenTree, word: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident == word)
}

fn is_braces(token: Option<&TokenTree>) -> bool {
    matches!(token, Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace)
}
