//! The tables. In: the scores of all cases. Out: Markdown.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::case::{Case, Expected, LARGE, SIZES};
use crate::scene::Noises;
use crate::score::{How, STRONG, Score};

/// A case with its score.
pub(crate) struct Line {
    pub(crate) case: Case,
    pub(crate) score: Score,
}

/// What is counted in a row of a table.
#[derive(Default)]
struct Count {
    cases: usize,
    effects: usize,
    found: usize,
    named: usize,
    /// Effects whose energy is above `STRONG`.
    strong: usize,
    strong_found: usize,
    findings: usize,
    wrong: usize,
    verdicts: usize,
}

impl Count {
    fn take_effects<'l>(&mut self, effects: impl Iterator<Item = (&'l How, &'l f64)>) {
        for (how, energy) in effects {
            let found = usize::from(*how != How::Missed);
            let strong = usize::from(*energy > STRONG);
            self.effects += 1;
            self.found += found;
            self.named += usize::from(matches!(how, How::Named | How::Alias));
            self.strong += strong;
            self.strong_found += strong * found;
        }
    }

    fn take_case(&mut self, score: &Score) {
        self.cases += 1;
        self.findings += score.findings;
        self.wrong += score.wrong.len();
        self.verdicts += usize::from(score.verdict_right);
    }

    fn line(&self, name: &str) -> String {
        format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
            self.cases,
            self.effects,
            share(self.found, self.effects),
            share(self.named, self.effects),
            share(self.strong_found, self.strong),
            share(self.findings - self.wrong, self.findings),
            self.wrong,
            share(self.verdicts, self.cases),
        )
    }
}

const HEAD: &str = "| cases | effects | recall | by name | recall, energy > 10 | precision | false | verdict right |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";

fn share(part: usize, whole: usize) -> String {
    if whole == 0 { "-".to_owned() } else { format!("{:.0} %", 100.0 * part as f64 / whole as f64) }
}

/// All tables.
pub(crate) fn markdown(lines: &[Line]) -> String {
    let mut text = String::new();
    let effective: Vec<&Line> =
        lines.iter().filter(|line| line.case.expected != Expected::Adequate).collect();
    let planted: Vec<&Line> =
        effective.iter().copied().filter(|line| line.case.expected == Expected::LeftOut).collect();
    let quiet: Vec<&Line> = lines.iter().filter(|line| line.case.expected == Expected::Adequate).collect();
    let _ = write!(
        text,
        "## By size\n\nPeak of the effect over the noise; precision and verdicts by the largest effect of a case.\n\n| size {HEAD}"
    );
    for size in SIZES.iter().map(|(size, _)| *size).chain([LARGE]) {
        let mut count = Count::default();
        for line in &planted {
            let largest = line.case.sizes.iter().fold(0.0, |most: f64, own| most.max(*own));
            if largest == size {
                count.take_case(&line.score);
            }
            count.take_effects(sized(line, size));
        }
        text += &count.line(&if size == LARGE { "as it comes".to_owned() } else { format!("{size}") });
    }
    text += &rows(&planted, "term", |line, add| {
        let effects = line.case.planted.iter().zip(&line.score.effects).zip(&line.score.energies);
        effects.for_each(|((planted, how), energy)| add(planted.kind().to_owned(), how, energy));
    });
    text += &by_case(&planted, "noise", |line| line.case.noises.name().to_owned());
    text += &by_case(&planted, "recording", |line| format!("{:?}", line.case.scenes[0].kind));
    text += &by_case(&planted, "machine", |line| line.case.bench.name.to_owned());
    text += &by_case(&effective, "what it is", |line| format!("{:?}", line.case.expected));
    text += &evident(&planted);
    text += &silence(&quiet);
    text += &coverage(lines);
    text += &figures(lines);
    text
}

fn sized(line: &Line, size: f64) -> impl Iterator<Item = (&How, &f64)> {
    let effects = line.score.effects.iter().zip(&line.score.energies).zip(&line.case.sizes);
    effects.filter(move |(_, own)| **own == size).map(|(effect, _)| effect)
}

/// A table of effects.
fn rows(lines: &[&Line], name: &str, each: impl Fn(&Line, &mut dyn FnMut(String, &How, &f64))) -> String {
    let mut counts: BTreeMap<String, Count> = BTreeMap::new();
    for line in lines {
        each(line, &mut |key, how, energy| {
            counts.entry(key).or_default().take_effects([(how, energy)].into_iter());
        });
    }
    let mut text = format!(
        "\n## By {name}\n\n| {name} | effects | recall | by name | recall, energy > 10 |\n| --- | --- | --- | --- | --- |\n"
    );
    for (key, count) in counts {
        let strong = format!("{} of {}", share(count.strong_found, count.strong), count.strong);
        let _ = writeln!(
            text,
            "| {key} | {} | {} | {} | {strong} |",
            count.effects,
            share(count.found, count.effects),
            share(count.named, count.effects)
        );
    }
    text
}

/// A table of cases.
fn by_case(lines: &[&Line], name: &str, key: impl Fn(&Line) -> String) -> String {
    let mut counts: BTreeMap<String, Count> = BTreeMap::new();
    for line in lines {
        let count = counts.entry(key(line)).or_default();
        count.take_case(&line.score);
        count.take_effects(line.score.effects.iter().zip(&line.score.energies));
    }
    let mut text = format!("\n## By {name}\n\n| {name} {HEAD}");
    counts.iter().for_each(|(key, count)| text += &count.line(key));
    text
}

/// How many effects are found of those that would stand out if nobody knew the noise.
fn evident(lines: &[&Line]) -> String {
    let effects = || {
        let scores = lines.iter().map(|line| &line.score);
        scores.flat_map(|score| score.energies.iter().zip(&score.evidence).zip(&score.effects))
    };
    let strong = effects().filter(|((energy, _), _)| **energy > STRONG).count();
    let evident = effects().filter(|((_, evidence), _)| **evidence > STRONG);
    let evident: Vec<bool> = evident.map(|(_, how)| *how != How::Missed).collect();
    let found = evident.iter().filter(|found| **found).count();
    let mistaken: Vec<f64> = lines.iter().filter_map(|line| line.score.mistaken).collect();
    let told = mistaken.iter().filter(|evidence| **evidence > STRONG).count();
    format!(
        "\n## Evidence\n\n{} of {strong} effects with an energy above {STRONG:.0} stand out as far where nobody knows the noise; {found}, {}, of them are found. In {told} of {} cases with a false finding the truth stands out as far beside what was found.\n",
        evident.len(),
        share(found, evident.len()),
        mistaken.len()
    )
}

fn silence(quiet: &[&Line]) -> String {
    let mut text = "\n## Nothing left out\n\n| noise | cases | adequate | false findings per 100 |\n| --- | --- | --- | --- |\n".to_owned();
    for noise in Noises::ALL {
        let own: Vec<&&Line> = quiet.iter().filter(|line| line.case.noises == noise).collect();
        let wrong: usize = own.iter().map(|line| line.score.wrong.len()).sum();
        let right = own.iter().filter(|line| line.score.verdict_right).count();
        let per = 100.0 * wrong as f64 / own.len().max(1) as f64;
        let _ =
            writeln!(text, "| {} | {} | {} | {per:.1} |", noise.name(), own.len(), share(right, own.len()));
    }
    text
}

fn coverage(lines: &[Line]) -> String {
    let mut held: BTreeMap<(&str, &str), (usize, usize, Vec<f64>)> = BTreeMap::new();
    let mut all = (0, 0);
    for one in lines.iter().flat_map(|line| &line.score.held) {
        let entry = held.entry((one.term, one.parameter)).or_default();
        entry.0 += 1;
        entry.1 += usize::from(one.inside);
        entry.2.push(one.away.abs());
        all = (all.0 + 1, all.1 + usize::from(one.inside));
    }
    let mut text = format!(
        "\n## Intervals\n\n{} of {} intervals of 95 % hold the truth.\n\n| parameter | intervals | hold the truth | median, largest distance in sigma |\n| --- | --- | --- | --- |\n",
        share(all.1, all.0),
        all.0
    );
    for ((term, parameter), (count, inside, mut away)) in held {
        away.sort_by(f64::total_cmp);
        let _ = writeln!(
            text,
            "| {term} {parameter} | {count} | {} | {:.2}, {:.1} |",
            share(inside, count),
            away[count / 2],
            away[count - 1]
        );
    }
    text
}

fn figures(lines: &[Line]) -> String {
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let at = |tenths: usize| values.get(values.len() * tenths / 10).copied().unwrap_or(f64::NAN);
        (at(5), at(9), values.last().copied().unwrap_or(f64::NAN))
    };
    let holdout = median(lines.iter().filter_map(|line| line.score.holdout).collect());
    let seconds = median(lines.iter().map(|line| line.score.seconds).collect());
    let count = |of: &dyn Fn(&Score) -> (usize, usize)| {
        lines.iter().map(|line| of(&line.score)).fold((0, 0), |sum, own| (sum.0 + own.0, sum.1 + own.1))
    };
    let sides = count(&|score| (score.sides.iter().filter(|right| **right).count(), score.sides.len()));
    let located =
        count(&|score| (usize::from(score.located == Some(true)), usize::from(score.located.is_some())));
    let misnamed = count(&|score| (score.misnamed, 0)).0;
    format!(
        "\n## Figures\n\n- held-out rms over that of the noise: median {:.3}, ninth decile {:.3}, largest {:.2}\n- seconds a case: median {:.2}, ninth decile {:.2}, longest {:.1}\n- sides right where the drive was recorded: {} of {}\n- dents located: {} of {}\n- wrong sensors: {misnamed}\n",
        holdout.0,
        holdout.1,
        holdout.2,
        seconds.0,
        seconds.1,
        seconds.2,
        sides.0,
        sides.1,
        located.0,
        located.1
    )
}
