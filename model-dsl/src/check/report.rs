//! The report in words. In: a comparison. Out: disagreement first, then a line for each term, then a summary.

use super::{Comparison, Finding, Report, Verdict, differences};
use crate::algebra::{Axis, Polynomial};
use crate::sheet::infix;

/// The whole report.
pub(super) fn text(report: &Report) -> String {
    let verb = if report.agrees() { "agrees" } else { "disagrees" };
    let mut text = format!("{} {verb} with machine {}\n", report.file, report.machine);
    let contradictions = report.equations.iter().flat_map(contradictions);
    let contradictions: String = contradictions.map(|line| format!("  {line}\n")).collect();
    if !contradictions.is_empty() {
        text.push_str(&format!("\nDisagreement\n{contradictions}"));
    }
    for equation in &report.equations {
        text.push_str(&format!("\n{}\n{}", place(equation), agreements(equation)));
    }
    text.push_str(&format!("\n{}\n", summary(report)));
    text
}

/// `[general] Ex, line 12`.
fn place(equation: &Comparison) -> String {
    let section = equation.section.as_ref().map(|name| format!("[{name}] ")).unwrap_or_default();
    format!("{section}{}, line {}", equation.left, equation.line)
}

/// Every term of one equation that contradicts the derivation, in a line each.
pub(super) fn contradictions(equation: &Comparison) -> Vec<String> {
    let place = place(equation);
    let mut lines = Vec::new();
    if !equation.nominal.agrees() {
        let both = both(&equation.nominal.derived, &equation.nominal.printed);
        lines.push(format!("{place}: nominal part differs: {both}"));
    }
    let mut found: Vec<&Finding> = equation.findings.iter().filter(|one| one.verdict.disagrees()).collect();
    found.sort_by_key(|finding| finding.verdict);
    for finding in found {
        let both = match finding.verdict {
            Verdict::Missing => format!("derived with lever {}, not printed", infix(&finding.derived)),
            Verdict::Extra => format!("printed with lever {}, not derived", infix(&finding.printed)),
            Verdict::OppositeSign => {
                format!(
                    "derived with lever {}, printed with {}",
                    infix(&finding.derived),
                    infix(&finding.printed)
                )
            }
            _ => both(&finding.derived, &finding.printed),
        };
        lines.push(format!("{place}: {}: {}: {both}", finding.verdict.words(), name(finding)));
    }
    lines
}

/// The rest of an equation's terms, in a line each.
fn agreements(equation: &Comparison) -> String {
    let mut lines = String::new();
    if !equation.nominal.agrees() {
        lines.push_str("  differs        nominal part (see above)\n");
    } else if !equation.nominal.derived.is_zero() || equation.findings.is_empty() {
        lines.push_str(&format!("  agrees         nominal part: {}\n", infix(&equation.nominal.derived)));
    }
    for finding in &equation.findings {
        let detail = match finding.verdict.disagrees() {
            true => " (see above)".to_owned(),
            false => format!(": {}", infix(&finding.derived)),
        };
        lines.push_str(&format!("  {:13}  {}{detail}\n", finding.verdict.words(), name(finding)));
    }
    for (monomial, value) in equation.second_order.terms() {
        let product = infix(&Polynomial::monomial(monomial.clone(), value.clone()));
        lines.push_str(&format!("  second order   {product}: first order drops it\n"));
    }
    lines
}

fn name(finding: &Finding) -> String {
    if finding.symbol == finding.name {
        finding.name.clone()
    } else {
        format!("{} ({})", finding.symbol, finding.name)
    }
}

/// Both sides, and the monomials in which they differ.
fn both(derived: &Polynomial, printed: &Polynomial) -> String {
    let parts = differences(derived, printed).into_iter().map(|(verdict, part)| {
        let part = infix(&part);
        match verdict {
            Verdict::Missing => format!("{part} is missing"),
            Verdict::Extra => format!("{part} is extra"),
            Verdict::OppositeSign => format!("{part} has the opposite sign"),
            _ => format!("{part} has another coefficient"),
        }
    });
    let parts: Vec<String> = parts.collect();
    format!("derived {}, printed {} ({})", infix(derived), infix(printed), parts.join("; "))
}

fn summary(report: &Report) -> String {
    let counts: Vec<String> = Verdict::ALL
        .into_iter()
        .rev()
        .map(|verdict| (verdict, report.count(verdict)))
        .filter(|(verdict, count)| *count > 0 || *verdict == Verdict::Agrees)
        .map(|(verdict, count)| match (verdict, count) {
            (Verdict::Agrees, 1) => "1 term agrees".to_owned(),
            (Verdict::Agrees, _) => format!("{count} terms agree"),
            (other, _) => format!("{count} {}", other.words()),
        })
        .collect();
    let nominal = report.equations.iter().filter(|equation| !equation.nominal.agrees()).count();
    let nominal = match nominal {
        0 => String::new(),
        1 => ", 1 nominal part differs".to_owned(),
        several => format!(", {several} nominal parts differ"),
    };
    let unchecked: Vec<String> = report.unchecked.iter().map(Axis::to_string).collect();
    let unchecked = if unchecked.is_empty() {
        String::new()
    } else {
        format!(" The file has no equation in {}.", unchecked.join(", "))
    };
    let equations = match report.equations.len() {
        1 => "1 equation".to_owned(),
        count => format!("{count} equations"),
    };
    format!("{equations}: {}{nominal}.{unchecked}", counts.join(", "))
}
