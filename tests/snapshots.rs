//! What people read: the equations of every shipped machine as text, those of a five-axis machine with the direction of its tool, and
//! the code of three of them, pinned.
//!
//! In: `machines/`. Out: comparison with `snapshots/`; `cargo insta review` shows what changed. The lathe's equations were
//! read against (3-21) to (3-26) of the Excello report, the turning centre's against (A.12) of NISTIR 6722.

use model_dsl::equations::Names;
use model_dsl::source::SourceFile;
use notation::{Format, print};

use crate::agreement::{asking, compiled};
use crate::shipped::{SHIPPED, shipped};

/// Compares with `snapshots/<name>.snap`.
fn pinned(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

#[test]
fn equations() {
    for shipped in SHIPPED {
        let text = print(&compiled(&shipped.text()), Format::Text, Names::Symbols);
        pinned(&format!("equations-{}", shipped.name), &text);
    }
}

/// A swivelling head and a rotary table: `(sin b, 0, cos b)` seen from a part that C turns.
#[test]
fn equations_with_the_direction_of_the_tool() {
    let equations = compiled(&asking(&shipped("head-table-5axis").text()));
    let name = "equations-head-table-5axis-orientation";
    pinned(name, &print(&equations, Format::Text, Names::Symbols));
}

#[test]
fn code() {
    for name in ["excello-921", "xyfz-mill"] {
        pinned(&format!("code-{name}"), &generated(name, shipped(name).text()));
    }
    pinned("code-xyfz-mill-orientation", &generated("xyfz-mill", asking(&shipped("xyfz-mill").text())));
}

fn generated(name: &str, text: String) -> String {
    let source = SourceFile::new(format!("{name}.yaml"), text);
    let (tokens, _, _) = model_dsl::rust_tokens(&source).unwrap();
    model_dsl::codegen::file(&tokens, &format!("{name}.yaml")).unwrap()
}
