//! Models: which effects are settings, and which ways are crossed, whatever is added, taken out or exchanged.

use super::*;

/// Two settings and three effects of X, whose play is crossed over 8 um.
fn model() -> Model {
    let settings = (0..2).map(|channel| Effect::setting(0, Setting::Offset { channel }));
    let mut model =
        effects().into_iter().fold(Model::of_settings(settings), |model, fitted| model.with(fitted));
    model.cross(0, Crossing::Over(0.008));
    model
}

fn effects() -> [Fitted; 3] {
    [3.0, 4.0, 5.0].map(|wind_up| Fitted {
        effect: Effect {
            place: Place::Motion { motion: 1, side: Side::After },
            shape: Shape::Backlash { axis: 0, wind_up },
        },
        coefficients: vec![wind_up],
    })
}

#[test]
fn what_is_added_is_chosen_and_what_is_taken_out_leaves_its_own_kind() {
    let model = model();
    assert_eq!((model.settings().len(), model.chosen()), (2, effects().as_slice()));
    assert_eq!(model.chosen_numbers(), 2..5);
    // A setting, and an effect.
    let [without_setting, without_effect] = [1, 3].map(|number| model.without(number));
    assert_eq!((without_setting.settings().len(), without_setting.chosen()), (1, effects().as_slice()));
    assert_eq!(without_effect.settings(), model.settings());
    assert_eq!(without_effect.chosen(), [effects()[0].clone(), effects()[2].clone()]);
}

#[test]
fn settings_stay_whatever_is_kept() {
    let model = model();
    let kept = model.keeping(|fitted| fitted.coefficients[0] > 4.5);
    assert_eq!((kept.settings(), kept.chosen()), (model.settings(), &effects()[2..]));
    assert_eq!(model.keeping(|_| false), model.settings_alone());
    assert!(model.settings_alone().chosen().is_empty());
    // Of fewer effects than there were settings all are.
    assert_eq!(model.with_effects(effects().into_iter().take(1)).settings(), &effects()[..1]);
}

#[test]
fn ways_are_crossed_beside_other_effects_too_until_they_are_given_up() {
    let model = model();
    for other in [
        model.without(2),
        model.settings_alone(),
        model.with_effects(effects()),
        model.clone().with_settings(0),
    ] {
        assert_eq!((other.crossing(0), other.crossing(1)), (Crossing::Over(0.008), Crossing::AtOnce));
    }
    let at_once = model.clone().uncrossed();
    assert!(model.crosses() && !at_once.crosses());
    assert_eq!((at_once.settings(), at_once.chosen()), (model.settings(), model.chosen()));
    assert_eq!(at_once.clone().moving_as(&model), model);
    // A way of nothing, or of less, is none.
    for way in [0.0, -0.001] {
        let mut given_up = model.clone();
        given_up.cross(0, Crossing::over(way));
        assert_eq!(given_up, at_once);
    }
}
