//! Heat: two temperatures with which a machine grows, before anything else explains it.
//!
//! In: a model in which something grows with a temperature. Out: the two growths, of all sensors and times behind them, that explain most
//! without any other effect. Temperatures of one machine rise together, so that a search that takes one effect after the other begins with
//! the one that is nearest to the sum of them all, and a drift then stands in for the rest.

use crate::conditions::Conditions;
use crate::kinship::Kin;
use crate::model::{Effect, Fitted, Model};
use crate::study::Study;
use crate::terms::Shape;

/// The most candidates of which pairs are fitted: eight sensors at seven times behind them.
const MOST: usize = 56;

/// The cheapest pair of growths beside the settings of a model, each with its own time behind its sensor; `None` where nothing of the model
/// grows, or there are no two sensors.
pub(crate) fn growths_alone(
    study: &Study<'_>,
    model: &Model,
    pool: &[Kin],
    conditions: &Conditions<'_>,
) -> Option<Model> {
    let grows = |effect: &Effect| matches!(effect.shape, Shape::Growth { .. });
    if !model.chosen().iter().any(|fitted| grows(&fitted.effect)) {
        return None;
    }
    let candidates: Vec<&Effect> =
        pool.iter().map(|kin| &kin.effect).filter(|effect| grows(effect)).collect();
    if candidates.len() > MOST {
        return None;
    }
    let settings = model.settings_alone();
    let pairs = candidates.iter().enumerate().flat_map(|(number, one)| {
        candidates[number + 1..].iter().map(move |other| [(*one).clone(), (*other).clone()])
    });
    let fitted = pairs.map(|pair| {
        let both =
            pair.into_iter().fold(settings.clone(), |model, effect| model.with(Fitted::unfitted(effect)));
        let fit = conditions.refine(study, both);
        (conditions.cost(study, &fit), fit.model)
    });
    fitted.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, model)| model)
}
