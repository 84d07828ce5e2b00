//! All contestants of a group, whose answers agree.
//!
//! In: a case and a group (which question). Out: the contestants, after their answers have been compared. It exists so that
//! nothing is timed or counted that answers something else.

use crate::case::{Case, STATES};
use crate::contest::{Contestant, Group};
use crate::{foreign, ours, product};

/// All contestants of a group on a machine, ours first, after their answers have been compared in every state.
///
/// # Errors
/// Names a contestant whose answer differs, and where.
pub fn contestants(case: &'static Case, group: Group) -> Result<Vec<Box<dyn Contestant>>, String> {
    let mut all = ours::contestants(case, group);
    all.extend(foreign::contestants(case, group));
    all.extend(product::contestants(case, group));
    let (ours, others) = all.split_first_mut().ok_or("there is no contestant")?;
    for other in others {
        for state in 0..STATES {
            let (own, its) = (ours.at(state), other.at(state));
            let apart = own.iter().zip(&its).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if own.len() != its.len()
                || apart > other.tolerance()
                || own.iter().chain(&its).any(|part| part.is_nan())
            {
                return Err(format!(
                    "{}, {}, {}: state {state} gives {its:?}, ours {own:?}",
                    case.name,
                    group.name(),
                    other.name()
                ));
            }
        }
    }
    Ok(all)
}
