//! Sizes. In: contributions and distributions. Out: a bar for each finding, and how residuals spread before and after.

use pages::plot::{Axis, Bar, Bars, Look, Steps, histogram};

use super::{Figure, LEFT};
use crate::diagnosis::Diagnosis;
use crate::pictures::{Distribution, Pictures};

pub(super) fn figures(diagnosis: &Diagnosis, pictures: &Pictures) -> Vec<Figure> {
    let mut figures = Vec::new();
    if !pictures.contributions.is_empty() {
        figures.push(contributions(diagnosis, pictures));
    }
    if !pictures.distributions.is_empty() {
        figures.push(distributions(diagnosis, pictures));
    }
    figures
}

fn contributions(diagnosis: &Diagnosis, pictures: &Pictures) -> Figure {
    let bar = |(finding, contribution): (&crate::diagnosis::Finding, &crate::pictures::Contribution)| Bar {
        label: format!("{} of {} ({})", finding.term, finding.motion, finding.motion_meaning),
        value: contribution.rms,
        further: Some(contribution.max),
    };
    let bars = diagnosis.findings.iter().zip(&pictures.contributions).map(bar).collect();
    let axis = Axis::new("contribution", diagnosis.after.unit);
    Figure::new(
        Bars::new("Contributions", "bar: root mean square; line: largest", axis, bars),
        "The contribution of each finding to the readings, over all samples. The mean of each channel is subtracted, because its \
         zero is free. The contributions need not add up: if two findings look alike here, they share an effect.",
    )
}

fn distributions(diagnosis: &Diagnosis, pictures: &Pictures) -> Figure {
    let unchanged = pictures.unchanged();
    let drawn = pictures.distributions.iter().filter(|one| one.after || !unchanged);
    let drawn: Vec<(&'static str, Look, &Distribution)> = drawn.map(|one| named(one, unchanged)).collect();
    let steps: Vec<Steps> = drawn.iter().map(|(name, look, one)| steps(name, *look, one)).collect();
    let plot = histogram("Distribution of the residual", Axis::new(LEFT, diagnosis.after.unit), &steps);
    let beyond = drawn.iter().filter(|(_, _, one)| one.beyond > 0);
    let beyond: Vec<String> = beyond.map(|(name, _, one)| format!("{} {name}", one.beyond)).collect();
    let plot = match beyond.as_slice() {
        [] => plot,
        beyond => plot.subtitle(&format!("beyond the axis: {}", beyond.join(", "))),
    };
    Figure::new(
        plot,
        "All samples except outliers. Pure noise is symmetric about zero and as wide in the held-out data as elsewhere.",
    )
}

fn named(distribution: &Distribution, unchanged: bool) -> (&'static str, Look, &Distribution) {
    let (name, look) = match (distribution.after, distribution.held_out) {
        (false, _) => ("before", Look::of(0)),
        (true, false) if unchanged => ("all", Look::of(0)),
        (true, false) => ("after", Look::of(1)),
        (true, true) if unchanged => ("held out", Look::of(2)),
        (true, true) => ("after, held out", Look::of(2)),
    };
    (name, look, distribution)
}

fn steps(name: &str, look: Look, distribution: &Distribution) -> Steps {
    let all = distribution.counts.iter().sum::<usize>() + distribution.beyond;
    let share = |count: &usize| crate::number(*count) / crate::number(all.max(1));
    Steps {
        name: format!("{name} ({all})"),
        look,
        edges: distribution.edges.clone(),
        shares: distribution.counts.iter().map(share).collect(),
    }
}
