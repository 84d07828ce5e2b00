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
    /// A formula as MathML, which a page has in place of the second line.
    pub(super) formula: Option<String>,
}

impl Item {
    /// An item; facts without a line are left out.
    pub(super) fn new(title: String, facts: impl IntoIterator<Item = (&'static str, Vec<String>)>) -> Self {
        let facts = facts.into_iter().filter_map(|(label, lines)| {
            let lines: Vec<String> = lines.into_iter().filter(|line| !line.is_empty()).collect();
            (!lines.is_empty()).then_some(Fact { label, lines, formula: None })
        });
        Self { title, facts: facts.collect() }
    }

    /// The same with a formula that a page has in place of the second line of a fact.
    pub(super) fn with_formula(mut self, label: &str, mathml: String) -> Self {
        if let Some(fact) = self.facts.iter_mut().find(|fact| fact.label == label) {
            fact.formula = Some(mathml);
        }
        self
    }
}
