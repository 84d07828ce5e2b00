//! Noise: what a channel does when nothing happens.
//!
//! In: the residual of a channel, with times and gaps. Out: its noise as white noise and a wandering (an
//! Ornstein-Uhlenbeck process: exponentially correlated, up to a random walk), and the filter that makes such noise white.
//! Generalised least squares is ordinary least squares behind that filter. How likely the residual is as flicker noise is asked apart.

mod flicker;
mod likelihood;
mod simplex;

use crate::rounded;
use likelihood::deviances;
use simplex::{TOGETHER, minimise};

/// The noise of one channel: mm or rad, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Standard deviation of the white part.
    pub(crate) white: f64,
    /// Standard deviation of the wandering part.
    pub(crate) wander: f64,
    /// Correlation time of the wandering part.
    pub(crate) time_constant: f64,
    /// How many samples in a row count for one: 1 but for what a model leaves out, which keeps its direction.
    pub(crate) alike: f64,
}

impl Noise {
    /// White noise alone.
    pub(crate) fn white(deviation: f64) -> Self {
        Self { white: deviation, wander: 0.0, time_constant: 1.0, alike: 1.0 }
    }

    /// The standard deviation of a sample.
    pub(crate) fn size(&self) -> f64 {
        self.white.hypot(self.wander)
    }

    /// The least white part that a noise may have which wanders so in a recording of this length.
    fn least_white(&self, span: f64) -> f64 {
        ROUGH * self.wander * (1.0 - (-2.0 * STRETCH * span / self.time_constant).exp()).sqrt()
    }

    /// Whether it wanders without any white part of its own, as no sensor does.
    pub(crate) fn only_wanders(&self, time: &[f64]) -> bool {
        self.wander > 0.0 && self.white <= self.least_white(span(time))
    }

    /// White noise of the same size.
    pub(crate) fn as_white(&self) -> Self {
        Self { white: self.size(), wander: 0.0, ..*self }
    }
}

/// The whitening filter of one channel as it runs through the rows: a Kalman filter of the wandering part.
#[derive(Clone, Debug)]
pub(crate) struct Whitening {
    noise: Noise,
    variance: f64,
    last: Option<f64>,
    /// The last step of time and its decay: most steps are equal.
    decay: (f64, f64),
    /// The last row with a sample: with equal steps of time the filter soon does the same in every row.
    settled: Option<Settled>,
}

/// A row with a sample: what the filter came with, what it did and what it went with.
#[derive(Clone, Copy, Debug)]
struct Settled {
    before: f64,
    step: Step,
    after: f64,
}

/// What the filter does in one row: `state = decay * state`, `out = (in - state) / deviation`, `state += gain * (in - state)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    decay: f64,
    gain: f64,
    /// 1 / standard deviation of what is new in this row; 0 where the sample is missing.
    weight: f64,
}

impl Whitening {
    /// The filter at the beginning of a recording.
    pub(crate) fn new(noise: Noise) -> Self {
        Self { noise, variance: noise.wander * noise.wander, last: None, decay: (0.0, 1.0), settled: None }
    }

    /// The filter's next steps, for rows at these times.
    pub(crate) fn steps(&mut self, time: &[f64], valid: &[bool]) -> Vec<Step> {
        time.iter().zip(valid).map(|(time, valid)| self.step(*time, *valid)).collect()
    }

    fn step(&mut self, time: f64, valid: bool) -> Step {
        let decay = self.last.map_or(0.0, |last| self.decay(time - last));
        self.last = Some(time);
        if let Some(known) = self.settled
            && valid
            && known.before == self.variance
            && known.step.decay == decay
        {
            self.variance = known.after;
            return known.step;
        }
        let before = self.variance;
        let stationary = self.noise.wander * self.noise.wander;
        self.variance = decay * decay * self.variance + stationary * (1.0 - decay * decay);
        if !valid {
            return Step { decay, gain: 0.0, weight: 0.0 };
        }
        let total = self.variance + self.noise.white * self.noise.white;
        let gain = self.variance / total;
        self.variance *= 1.0 - gain;
        let step = Step { decay, gain, weight: 1.0 / (total * self.noise.alike).sqrt() };
        self.settled = Some(Settled { before, step, after: self.variance });
        step
    }

    fn decay(&mut self, step: f64) -> f64 {
        if self.noise.wander == 0.0 {
            return 0.0;
        }
        if !same_step(step, self.decay.0) {
            self.decay = (step, (-step / self.noise.time_constant).exp());
        }
        self.decay.1
    }
}

/// Whether steps of time are the same but for the rounding of a clock, which a file gives with a few digits: what is left of a
/// wandering after them then is the same within a ten-thousandth of what it loses.
fn same_step(step: f64, known: f64) -> bool {
    (step - known).abs() <= 1e-4 * step
}

/// Whitens columns in place, which stand one behind the other; `states` go on from the rows before, 0 at the beginning.
pub(crate) fn whiten(steps: &[Step], states: &mut [f64], columns: &mut [f64]) {
    let rows = steps.len();
    if rows == 0 {
        return;
    }
    let mut fours = columns.chunks_exact_mut(4 * rows);
    let mut states = states.chunks_exact_mut(4);
    for (columns, states) in fours.by_ref().zip(states.by_ref()) {
        whiten_four(steps, states, columns);
    }
    for (column, state) in fours.into_remainder().chunks_exact_mut(rows).zip(states.into_remainder()) {
        for (step, value) in steps.iter().zip(column) {
            *value = step.whitened(state, *value);
        }
    }
}

/// Four columns row by row: each filter waits for its own row before, and the others can go on meanwhile.
fn whiten_four(steps: &[Step], states: &mut [f64], columns: &mut [f64]) {
    let rows = steps.len();
    let (first, rest) = columns.split_at_mut(rows);
    let (second, rest) = rest.split_at_mut(rows);
    let (third, fourth) = rest.split_at_mut(rows);
    let [a, b, c, d] = states else { return };
    for (row, step) in steps.iter().enumerate() {
        first[row] = step.whitened(a, first[row]);
        second[row] = step.whitened(b, second[row]);
        third[row] = step.whitened(c, third[row]);
        fourth[row] = step.whitened(d, fourth[row]);
    }
}

impl Step {
    /// A value of a column behind the filter, which has this state.
    fn whitened(&self, state: &mut f64, value: f64) -> f64 {
        let before = *state * self.decay;
        if self.weight > 0.0 {
            let new = value - before;
            *state = before + self.gain * new;
            new * self.weight
        } else {
            *state = before;
            0.0
        }
    }
}

/// The logarithm of the determinant of the covariance of noise that these steps make white.
pub(crate) fn log_sizes(steps: &[Step]) -> f64 {
    // One logarithm for many factors, as long as their product is far from both ends of the numbers.
    let (mut sum, mut product) = (0.0, 1.0_f64);
    for step in steps.iter().filter(|step| step.weight > 0.0) {
        product *= step.weight;
        if !(1e-100..1e100).contains(&product) {
            sum -= 2.0 * product.ln();
            product = 1.0;
        }
    }
    sum - 2.0 * product.ln()
}

/// The transpose of [`whiten`] over a whole recording, in place: white numbers become weights of the samples.
pub(crate) fn unwhiten(steps: &[Step], column: &mut [f64]) {
    let mut s = 0.0;
    for (step, value) in steps.iter().zip(column).rev() {
        let back = if step.weight > 0.0 { *value * step.weight + step.gain * s } else { 0.0 };
        *value = back;
        s = (s - back) * step.decay;
    }
}

/// Minus twice the logarithm of the likelihood of a residual under a noise.
pub(crate) fn deviance(time: &[f64], residual: &[f64], valid: &[bool], noise: &Noise) -> f64 {
    let steps = Whitening::new(Noise { alike: 1.0, ..*noise }).steps(time, valid);
    let mut white = residual.to_vec();
    whiten(&steps, &mut [0.0], &mut white);
    let each = steps.iter().zip(&white).filter(|(step, _)| step.weight > 0.0);
    each.map(|(step, white)| white * white - 2.0 * step.weight.ln()).sum::<f64>() / noise.alike
}

/// The same where that noise is flicker beside white noise, as likely as can be; infinite where it would be finer than the rounding of the
/// data, `floor`, allows.
pub(crate) fn flicker(time: &[f64], residual: &[f64], valid: &[bool], floor: f64) -> f64 {
    let (deviance, white) = flicker::deviance(time, residual, valid);
    if white < floor { f64::INFINITY } else { deviance }
}

/// How many samples in a row of a residual count for one: its autocorrelation summed up to where it changes its sign.
pub(crate) fn alike(residual: &[f64], valid: &[bool]) -> f64 {
    let known: Vec<f64> =
        residual.iter().zip(valid).filter(|(_, valid)| **valid).map(|(value, _)| *value).collect();
    let count = crate::number(known.len()).max(1.0);
    let mean = known.iter().sum::<f64>() / count;
    let product = |lag: usize| {
        let pairs = known.iter().zip(&known[lag.min(known.len())..]);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / count
    };
    let square = product(0);
    if square <= 0.0 {
        return 1.0;
    }
    let (mut sum, mut lag, mut before) = (1.0, 1, 1.0);
    while crate::number(lag) < count / FEWEST_APART {
        let next = (lag * 5 / 4).max(lag + 1);
        let correlation = product(lag) / square;
        if correlation <= 0.0 {
            break;
        }
        // Between the lags that are looked at it is taken as straight, 2 for both sides.
        sum += correlation.min(before) * 2.0 * crate::number(next - lag);
        (lag, before) = (next, correlation);
    }
    sum.min(count / FEWEST_APART).max(1.0)
}

/// The fewest stretches that are told apart: with fewer, nothing could be.
const FEWEST_APART: f64 = 12.0;

/// The noise of a channel with the greatest likelihood, and minus twice the logarithm of that.
///
/// `floor` is the least standard deviation of the white part: that of the rounding of the data. Where the residual is quieter, as on an
/// axis that stands between two steps of its display, the likelihood is that of this floor.
pub(crate) fn estimate(time: &[f64], residual: &[f64], valid: &[bool], floor: f64) -> (Noise, f64) {
    let step = typical_step(time);
    let span = span(time);
    let unit =
        |ratio: f64, time_constant: f64| Noise { white: 1.0, wander: ratio, time_constant, alike: 1.0 };
    let at = |point: [f64; 2]| unit(point[0].clamp(-12.0, 12.0).exp(), point[1].exp());
    // Between half a step and ten recordings, and a wandering from nothing to all there is.
    let outside = |point: [f64; 2]| {
        (point[1] - (0.3 * step).ln()).min(0.0).abs()
            + (point[1] - (10.0 * span).ln()).max(0.0)
            + (point[0].abs() - 12.0).max(0.0)
    };
    let costs = |points: [[f64; 2]; TOGETHER]| {
        let found = deviances(time, residual, valid, points.map(at));
        std::array::from_fn(|number| found[number].0 + 1e3 * outside(points[number]))
    };
    let alone = |noise: Noise| deviances(time, residual, valid, [noise])[0];
    let white = alone(unit(0.0, span));
    let best = starts(step, span, &costs);
    let (value, point) = match best {
        Some(start) => minimise(&costs, start),
        None => (f64::INFINITY, [0.0, 0.0]),
    };
    // Two more parameters must be worth more than chance.
    let (value, variance, shape) = if value < white.0 - WORTH {
        let shape = at(point);
        (value, alone(shape).1, shape)
    } else {
        (white.0, white.1, Noise { time_constant: span, ..Noise::white(1.0) })
    };
    let scale = variance.sqrt();
    let noise = Noise { white: scale.max(floor), wander: shape.wander * scale, ..shape };
    let value = if scale < floor { deviance(time, residual, valid, &noise) } else { value };
    (Noise { white: noise.white.max(noise.least_white(span)), ..noise }, value)
}

/// How long a recording lasts, s; one step at least.
fn span(time: &[f64]) -> f64 {
    (time.last().unwrap_or(&1.0) - time.first().unwrap_or(&0.0)).max(typical_step(time))
}

/// The best of some points to start from: short and long times, of which none is longer than the recording.
fn starts(
    step: f64,
    span: f64,
    costs: &impl Fn([[f64; 2]; TOGETHER]) -> [f64; TOGETHER],
) -> Option<[f64; 2]> {
    let times = [1.5 * step, 10.0 * step, 0.03 * span, span].into_iter().filter(|time| *time <= span);
    let points: Vec<[f64; 2]> =
        times.flat_map(|time| [0.1, 1.0].map(|ratio| [f64::ln(ratio), time.ln()])).collect();
    let mut best: Option<(f64, [f64; 2])> = None;
    for points in points.chunks(TOGETHER) {
        let found = costs(std::array::from_fn(|number| points[number.min(points.len() - 1)]));
        for (cost, point) in found.into_iter().zip(points) {
            if best.is_none_or(|best| cost < best.0) {
                best = Some((cost, *point));
            }
        }
    }
    best.map(|(_, point)| point)
}

/// The least white part, as a share of how far the wandering part gets. What wanders without any white part is no sensor but
/// what the model leaves out, which has a slope at every moment: its steps from row to row are so small that a fit would
/// follow slopes alone, and not see how far the machine is off.
const ROUGH: f64 = 0.1;

/// The share of a recording in which it gets there: a stretch that effects of a machine are told from.
const STRETCH: f64 = 0.05;

/// How much the wandering must lower minus twice the log-likelihood: chance does it with two more parameters in one of a
/// hundred cases.
pub(crate) const WORTH: f64 = 9.2;

/// The standard deviation of the fast part of a residual: from the median difference of neighbouring samples.
pub(crate) fn from_differences(residual: &[f64]) -> f64 {
    let mut steps: Vec<f64> =
        residual.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| step.is_finite()).collect();
    let median = middle(&mut steps).unwrap_or_default();
    median / (0.6745 * std::f64::consts::SQRT_2)
}

/// The step of the display of recorded values: the coarsest decimal step of which all are multiples, in mm, deg or in. It is never
/// larger than the smallest difference between two of them, so that readings at whole millimetres are not taken for a display of
/// millimetres. Values that were not rounded give next to nothing.
pub(crate) fn display_step(values: &[f64]) -> f64 {
    let mut known: Vec<f64> =
        values.iter().copied().filter(|value| value.is_finite()).take(LOOKED_AT).collect();
    known.sort_by(f64::total_cmp);
    let scale = known.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let least = (1e-12 * scale).max(f64::MIN_POSITIVE.sqrt());
    let differences = known.windows(2).map(|pair| pair[1] - pair[0]).filter(|difference| *difference > least);
    let smallest = differences.fold(f64::INFINITY, f64::min);
    let units = [1.0, std::f64::consts::PI / 180.0, std::f64::consts::PI / 180.0 / 3600.0, 25.4];
    let decades = (0..10).map(|decade| 0.1_f64.powi(decade));
    let steps = decades.flat_map(|decade| [decade, 0.5 * decade, 0.2 * decade]);
    let multiple = |step: f64| {
        scale > 0.5 * step
            && step < ROUNDED * smallest
            && known.iter().all(|value| (value / step - (value / step).round()).abs() < MULTIPLE)
    };
    let possible = steps.flat_map(|step| units.map(|unit| step * unit)).filter(|step| multiple(*step));
    possible.fold(least, f64::max)
}

/// A difference of one step may come out smaller by the rounding of the numbers themselves.
const ROUNDED: f64 = 1.01;
/// How far from a whole multiple of the display's step a reading may lie, in steps: what the conversion of units rounds.
const MULTIPLE: f64 = 1e-3;

/// The standard deviation of the rounding of recorded values: that of a display, over the root of twelve.
pub(crate) fn rounding(values: &[f64]) -> f64 {
    rounded::deviation(display_step(values))
}

/// How many values are looked at for their rounding.
const LOOKED_AT: usize = 1000;

/// The median step of time.
pub(crate) fn typical_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    middle(&mut steps).unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

/// The value that would stand in the middle if these were sorted, the upper one of two; they are left in another order.
pub(crate) fn middle(values: &mut [f64]) -> Option<f64> {
    let place = values.len() / 2;
    (place < values.len()).then(|| *values.select_nth_unstable_by(place, f64::total_cmp).1)
}

#[cfg(test)]
mod tests;
