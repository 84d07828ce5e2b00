//! What people read: the equations of every shipped machine as text, and the code of two of them, pinned.
//!
//! In: `machines/`. Out: comparison with `snapshots/`; `cargo insta review` shows what changed. The lathe's equations were
//! read against (3-21) to (3-26) of the Excello report, the turning centre's against (A.12) of NISTIR 6722.

use model_dsl::equations::Names;
use model_dsl::notation::{Format, print};
use model_dsl::source::SourceFile;

use crate::agreement::compiled;
use crate::shipped::SHIPPED;

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

#[test]
fn code() {
    for name in ["excello-921", "xyfz-mill"] {
        let shipped = SHIPPED.iter().find(|shipped| shipped.name == name).unwrap();
        let source = SourceFile::new(format!("{name}.yaml"), shipped.text());
        let (tokens, _, _) = model_dsl::rust_tokens(&source).unwrap();
        pinned(&format!("code-{name}"), &model_dsl::codegen::file(&tokens, &format!("{name}.yaml")).unwrap());
    }
}
