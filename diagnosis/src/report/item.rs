//! Items: one thing and labelled facts of it. In: words. Out: the parts that every form of the report lays out alike.

/// One thing and what is to be said of it.
pub(super) struct Item {
    pub(super) title: String,
    pub(super) facts: Vec<Fact>,
}

/// A labelled fact of one or more lines.
pub(super) struct Fact {
    pub(super) label: &'static str,
    pub(super) lines: Vec<String>,
}

impl Item {
    /// An item; facts without a line are left out.
    pub(super) fn new(title: String, facts: impl IntoIterator<Item = (&'static str, Vec<String>)>) -> Self {
        let facts = facts.into_iter().filter_map(|(label, lines)| {
            let lines: Vec<String> = lines.into_iter().filter(|line| !line.is_empty()).collect();
            (!lines.is_empty()).then_some(Fact { label, lines })
        });
        Self { title, facts: facts.collect() }
    }
}
