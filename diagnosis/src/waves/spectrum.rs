//! The spectrum of a residual along an axis or in time: what a wave of each frequency would take from it.
//!
//! In: for each row its place, its weighted residual and its weight. Out: for each frequency what least squares gains from a sine
//! and a cosine beside a free mean, and the highest peaks: measured against the spectrum around each of them, since that is
//! the noise of that frequency, and not against the one number that all rows share.
//!
//! The sums are Fourier transforms of fine bins, of the weighted residual and of the weights: the least-squares spectrum of Lomb,
//! Scargle, Zechmeister and Kuerster by the way of Press and Rybicki. Rows at which an axis rests weigh at one place only.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// Rows of one recording.
pub(super) struct Rows<'r> {
    pub(super) places: &'r [f64],
    /// What each row adds to the normal equations: residual times weight, and weight.
    pub(super) weighted: &'r [f64],
    pub(super) weights: &'r [f64],
}

/// A frequency, and what a wave of it gains.
pub(super) type Line = (f64, f64);

/// The spectrum at places between `low` and `low + range`, from frequency 0 by equal steps up to that of the shortest period.
pub(super) fn spectrum(rows: &[Rows<'_>], low: f64, range: f64, shortest: f64) -> Vec<Line> {
    // Three bins for the shortest period, and the range padded to twice its length.
    let size = transform_size(2.0 * range / shortest * 3.0);
    let bin = 2.0 * range / crate::number(size);
    let transformed = |column: fn(&Rows<'_>, usize) -> f64| {
        let mut bins = vec![0.0; size];
        for rows in rows {
            for (row, place) in rows.places.iter().enumerate() {
                let along = (place - low) / bin;
                let Some(index) = crate::index(along).filter(|index| index + 1 < size) else { continue };
                // Shared out between two bins: rows that come evenly would beat with the bins.
                let (share, value) = (along - crate::number(index), column(rows, row));
                bins[index] += (1.0 - share) * value;
                bins[index + 1] += share * value;
            }
        }
        fourier(bins)
    };
    let residual = transformed(|rows, row| rows.weighted.get(row).copied().unwrap_or_default());
    let weights = transformed(|rows, row| rows.weights.get(row).copied().unwrap_or_default());
    let step = 1.0 / (2.0 * range);
    (0..residual.len())
        .map(|number| (crate::number(number) * step, gain(&residual, &weights, number)))
        .take_while(|(frequency, _)| *frequency <= 1.0 / shortest)
        .collect()
}

/// The spectrum where all stretches of the range weigh alike, however many rows lie in each. Most rows lie where an axis slows down and
/// turns. What a model lacks there would hide a wave that is plain everywhere else.
pub(super) fn spectrum_by_place(rows: &[Rows<'_>], low: f64, range: f64, shortest: f64) -> Vec<Line> {
    let stretch = |place: f64| {
        let number = crate::index((place - low) / range * crate::number(STRETCHES)).unwrap_or_default();
        number.min(STRETCHES - 1)
    };
    let mut totals = [0.0; STRETCHES];
    for rows in rows {
        for (place, weight) in rows.places.iter().zip(rows.weights) {
            totals[stretch(*place)] += weight;
        }
    }
    let shared = |column: &[f64], places: &[f64]| -> Vec<f64> {
        let total = |place: f64| totals[stretch(place)].max(f64::MIN_POSITIVE);
        column.iter().zip(places).map(|(value, place)| value / total(*place)).collect()
    };
    let columns: Vec<(Vec<f64>, Vec<f64>)> = rows
        .iter()
        .map(|rows| (shared(rows.weighted, rows.places), shared(rows.weights, rows.places)))
        .collect();
    let alike: Vec<Rows<'_>> = rows
        .iter()
        .zip(&columns)
        .map(|(rows, (weighted, weights))| Rows { places: rows.places, weighted, weights })
        .collect();
    spectrum(&alike, low, range, shortest.max(WIDE * range / crate::number(STRETCHES)))
}

/// The stretches that weigh alike. The ends at which an axis turns must be a few of many. Of waves injected into three recordings of a rotary
/// arm, those of half the size of what was left stood out 36 to 66 times with 16 or 32 stretches, and 130 to 310 times with 128 to 1024. The
/// highest line without them stood out 3 to 5 times.
const STRETCHES: usize = 256;
/// The shortest wave among stretches that weigh alike is this many of them long, so that the weights hardly change within a quarter of it.
/// Without this bound, lines of one or two rows stood out up to 60 times in that arm, which has no such wave.
const WIDE: f64 = 4.0;

/// The normal equations of sine and cosine beside a free mean must be so far from singular: where all rows see the same phase
/// there is no wave to tell.
const SINGULAR: f64 = 1e-3;

/// What sine and cosine of one frequency gain beside a free mean.
fn gain(residual: &[Complex<f64>], weights: &[Complex<f64>], number: usize) -> f64 {
    let total = weights[0].re;
    if total <= 0.0 {
        return 0.0;
    }
    let once = line(weights, number);
    let twice = line(weights, 2 * number);
    let seen = line(residual, number);
    let mean = residual[0].re / total;
    let cosine = seen.re - mean * once.re;
    let sine = seen.im - mean * once.im;
    let cosines = 0.5 * (total + twice.re) - once.re * once.re / total;
    let sines = 0.5 * (total - twice.re) - once.im * once.im / total;
    let mixed = 0.5 * twice.im - once.re * once.im / total;
    let determinant = cosines * sines - mixed * mixed;
    if determinant < SINGULAR * total * total {
        return 0.0;
    }
    (sines * cosine * cosine + cosines * sine * sine - 2.0 * mixed * cosine * sine) / determinant
}

/// A line of the spectrum of rows: that of bins, which comes round after as many lines as there are bins and whose second half
/// mirrors the first, without what sharing a row out between two bins takes from it.
fn line(lines: &[Complex<f64>], number: usize) -> Complex<f64> {
    let half = lines.len() - 1;
    let line = if number <= half { lines[number] } else { lines[(2 * half).abs_diff(number)].conj() };
    let angle = std::f64::consts::PI * crate::number(number) / crate::number(2 * half);
    let taken = if number == 0 { 1.0 } else { (angle.sin() / angle).powi(2) };
    line / taken
}

fn fourier(mut bins: Vec<f64>) -> Vec<Complex<f64>> {
    let transform = RealFftPlanner::new().plan_fft_forward(bins.len());
    let mut lines = transform.make_output_vec();
    if transform.process(&mut bins, &mut lines).is_err() {
        // It fails for lengths alone that are not its own.
        lines.clear();
    }
    lines
}

/// The most bins of a transform.
const MOST_BINS: usize = 1 << 23;

/// A length that transforms fast, at least `wanted` where that is not too long: a power of two, or three quarters or
/// five eighths of one.
fn transform_size(wanted: f64) -> usize {
    let sizes = (8..=23).map(|power| 1_usize << power).flat_map(|size| [size / 8 * 5, size / 4 * 3, size]);
    sizes.into_iter().find(|size| crate::number(*size) >= wanted).unwrap_or(MOST_BINS)
}

/// A peak: its frequency, what a wave gains there, the noise around it, squared, in units of that which the weights assume, and what the wave
/// would gain were the noise of all frequencies that around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Top {
    pub(super) frequency: f64,
    pub(super) gain: f64,
    pub(super) noise: f64,
    pub(super) local: f64,
}

/// The highest peaks above a frequency: half of them by what they gain, half by what they gain at their own noise.
pub(super) fn tops(spectrum: &[Line], above: f64, count: usize) -> Vec<Top> {
    let mut all = peaks(spectrum, above);
    all.sort_by(|a, b| b.local.total_cmp(&a.local));
    let mut chosen: Vec<Top> = all.iter().take(count).copied().collect();
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    for top in all.into_iter().take(count) {
        if !chosen.contains(&top) {
            chosen.push(top);
        }
    }
    chosen
}

/// The peaks that stand out most at their own noise in a spectrum in which all places weigh alike; `spectrum` is that of the rows as they
/// weigh, which tells what a wave gains and the noise around it.
pub(super) fn tops_by_place(by_place: &[Line], spectrum: &[Line], above: f64, count: usize) -> Vec<Top> {
    let mut all = peaks(by_place, above);
    all.sort_by(|a, b| b.local.total_cmp(&a.local));
    all.truncate(count);
    let levels = levels(spectrum);
    let of_rows = |top: Top| {
        let nearest = spectrum.partition_point(|line| line.0 < top.frequency);
        let (line, level) = (spectrum.get(nearest)?, levels.get(nearest)?);
        Some(Top { gain: line.1, noise: level / MEDIAN, ..top })
    };
    all.into_iter().filter_map(of_rows).collect()
}

/// All peaks above a frequency.
fn peaks(spectrum: &[Line], above: f64) -> Vec<Top> {
    let level = levels(spectrum);
    (1..spectrum.len().saturating_sub(1))
        .filter(|at| spectrum[*at].0 >= above)
        .filter(|at| spectrum[*at].1 >= spectrum[at - 1].1 && spectrum[*at].1 > spectrum[at + 1].1)
        .map(|at| {
            let (frequency, gain) = vertex(&spectrum[at - 1..=at + 1]);
            // The median of a sum of two squares is that of an exponential number: ln 2 times its mean, which is 2.
            let noise = level[at].max(f64::MIN_POSITIVE) / MEDIAN;
            Top { frequency, gain, noise, local: gain / noise }
        })
        .collect()
}

/// The median of what a wave gains from white noise of unit variance: 2 ln 2.
const MEDIAN: f64 = 2.0 * std::f64::consts::LN_2;
/// The spectrum around a line reaches from its frequency over a factor to its frequency times that: by equal shares down and up,
/// since the noise of a walk falls with the square of the frequency. So many lines, since fewer are a median of chance and a peak
/// is several lines wide; but no more than this factor, and no less than that.
const AROUND: f64 = 48.0;
const FACTORS: (f64, f64) = (1.3, 3.0);

/// The median of the spectrum around each line.
fn levels(spectrum: &[Line]) -> Vec<f64> {
    let count = spectrum.len();
    let mut levels = vec![0.0; count];
    let mut at = 1;
    while at < count {
        let place = crate::number(at);
        // The factor f for which f - 1/f times the place is that number of lines.
        let half = 0.5 * AROUND / place;
        let factor = (half + half.hypot(1.0)).clamp(FACTORS.0, FACTORS.1);
        let bound = |line: f64| crate::index(line).unwrap_or_default().clamp(1, count - 1);
        let (from, to) = (bound(place / factor), bound((place * factor).ceil()));
        let mut around: Vec<f64> = spectrum[from..=to].iter().map(|line| line.1).collect();
        let level = crate::noise::middle(&mut around).unwrap_or_default();
        // Windows overlap for the most part: one serves for an eighth of its lines.
        let next = (at + ((to - from) / 8).max(1)).min(count);
        levels[at..next].fill(level);
        at = next;
    }
    levels
}

/// The top of the parabola through three points of the spectrum, whose roots are amplitudes. Between lines a peak is up to a
/// fifth higher than at the next of them, and of neighbours of nearly one height, as pauses make them, another would be taken.
fn vertex(three: &[Line]) -> Line {
    let (left, middle, right) = (three[0].1.sqrt(), three[1].1.sqrt(), three[2].1.sqrt());
    let curvature = left - 2.0 * middle + right;
    let shift = if curvature < 0.0 { 0.5 * (left - right) / curvature } else { 0.0 };
    let height = middle - 0.25 * (left - right) * shift;
    (three[1].0 + shift * (three[1].0 - three[0].0), height * height)
}

#[cfg(test)]
mod tests;
