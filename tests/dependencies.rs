//! The statement of what is compiled in. In: sources in which unsafe code is counted by hand, documents with a line too few
//! or too many. Out: that the example `dependencies` sees each of them.

#[path = "../examples/dependencies/document.rs"]
mod document;
#[path = "../examples/dependencies/unsafe_code.rs"]
mod unsafe_code;

use std::collections::BTreeSet;

use document::{differences, renewed};
use unsafe_code::{Counts, Stance, counted, stance};

#[test]
fn every_form_of_unsafe_code_is_counted() {
    let text = r#"
        pub unsafe trait Sealed {}
        unsafe impl Sealed for u8 {}
        unsafe impl<T> Sealed for [T] {}
        unsafe extern "C" { fn first(); }
        extern { fn second(); }
        const unsafe fn third() { unsafe { unsafe { first() } } }
        pub unsafe extern "C" fn fourth() {}
        macro_rules! fifth { ($name:ident) => { unsafe fn $name() { let _ = unsafe { first() }; } } }
    "#;
    let expected = Counts { blocks: 3, functions: 3, implementations: 2, traits: 1, foreign: 2 };
    assert_eq!(counted(text).unwrap(), expected);
}

#[test]
fn words_that_are_no_unsafe_code_are_not_counted() {
    let text = r##"
        //! unsafe { }
        /// unsafe fn told() {}
        #[unsafe(no_mangle)]
        pub extern "C" fn safe(call: unsafe extern "C" fn(u8), other: unsafe fn()) { /* unsafe { } */ }
        extern crate core;
        const WORDS: [&str; 3] = ["unsafe { }", r#"unsafe impl "A""#, "// \" unsafe { }"];
        const LETTER: char = '"'; // " unsafe { }
        fn unsafe_code() { let r#unsafe = 1; }
    "##;
    assert!(counted(text).unwrap().is_empty(), "{:?}", counted(text));
}

#[test]
fn what_is_no_rust_is_refused() {
    assert!(counted("fn open() { unsafe {").is_err());
    assert!(stance("\" without an end").is_err());
}

#[test]
fn a_crate_is_taken_at_its_word_only_where_it_says_it() {
    for (text, expected) in [
        ("#![no_std]\n#![forbid(unsafe_code, missing_docs)]", Stance::Forbids),
        ("#![deny(unsafe_code)]\n#[forbid(unsafe_code)] mod inner {}", Stance::Denies),
        ("#![cfg_attr(not(feature = \"simd\"), forbid(unsafe_code))]", Stance::SometimesForbids),
        ("#![forbid(unsafe_op_in_unsafe_fn)]", Stance::Silent),
        ("// #![forbid(unsafe_code)]\nmod inner { #![forbid(unsafe_code)] }", Stance::Silent),
    ] {
        assert_eq!(stance(text).unwrap(), expected, "{text}");
    }
}

#[test]
fn a_crate_that_the_document_lacks_is_told() {
    let old = "| libm | 1 |\n| gone | 1 |\n";
    let new = "| libm | 1 |\n| new | 1 |\n";
    let document = "| `libm` | sines |\n<!-- crates -->\n<!-- end -->\nlast\n";
    let direct = BTreeSet::from(["libm".to_owned()]);
    let shown = renewed(document, old).unwrap();
    assert_eq!(differences(&shown, old, &direct).unwrap(), Vec::<String>::new());
    let wrong = differences(&shown, new, &direct).unwrap();
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert!(wrong[0].contains("| new | 1 |") && wrong[1].contains("| gone | 1 |"), "{wrong:?}");
    assert_eq!(renewed(&shown, new), renewed(document, new));
}

#[test]
fn a_direct_dependency_without_a_reason_and_another_order_are_told() {
    let document = "| `libm` | sines |\n<!-- crates -->\nb\na\n<!-- end -->\n";
    let direct = BTreeSet::from(["libm".to_owned(), "unexplained".to_owned()]);
    let wrong = differences(document, "a\nb\n", &direct).unwrap();
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert!(wrong[0].contains("order") && wrong[1].contains("`unexplained`"), "{wrong:?}");
    assert!(differences("no place", "a\n", &direct).is_err());
}
