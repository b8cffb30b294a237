//! Which frequencies a history contains.
//!
//!   A(f) = 2 |Σ w_k (y_k − a − b t_k) e^{−2πi f t_k}| / Σ w_k                                                (1)
//!   w the Hann window, a + b t the straight line that fits best: A is the amplitude of a sine at its own frequency.
//!
//! A peak must stand four times above the amplitudes around it: the tail of a slow build-up or of a burst is no tone.

use std::f64::consts::{PI, TAU};

/// Amplitudes over frequency, from 0 to half the sampling rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Distance of two frequencies [Hz].
    pub step_hz: f64,
    /// Amplitude at `k · step_hz`, in the unit of the history.
    pub amplitude: Vec<f64>,
    /// How many of these amplitudes one tone spreads over, on each side.
    spread: usize,
}

/// A tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Frequency [Hz].
    pub frequency_hz: f64,
    /// Amplitude, in the unit of the history.
    pub amplitude: f64,
}

/// A peak stands this many times above the median around it.
const PROMINENCE: f64 = 4.0;

impl Spectrum {
    /// The spectrum of samples `dt` seconds apart. `None` with fewer than 16 samples, a step that is not positive, or samples that are not finite.
    ///
    /// Frequencies above half the sampling rate appear mirrored below it: sample finely enough.
    #[must_use]
    pub fn of(samples: &[f64], dt: f64) -> Option<Spectrum> {
        let count = samples.len();
        let usable = count >= 16 && dt > 0.0 && dt.is_finite();
        if !usable || !samples.iter().all(|y| y.is_finite()) {
            return None;
        }
        let length = count.next_power_of_two();
        let mut values = windowed(samples, length);
        transform(&mut values);
        // Σ w = count / 2 for the Hann window; the factor 2 puts both halves of the spectrum together.
        let scale = 4.0 / count as f64;
        let half = length / 2;
        let amplitude = values.iter().take(half + 1);
        Some(Spectrum {
            step_hz: 1.0 / (length as f64 * dt),
            amplitude: amplitude.map(|[re, im]| scale * re.hypot(*im)).collect(),
            spread: (2 * length).div_ceil(count),
        })
    }

    /// The tones, from the lowest frequency to the highest. Fewer than four periods in the history are no tone but a drift.
    #[must_use]
    pub fn peaks(&self) -> Vec<Peak> {
        let a = &self.amplitude;
        (2 * self.spread..a.len().saturating_sub(1))
            .filter(|&k| a[k] > a[k - 1] && a[k] >= a[k + 1] && a[k] > PROMINENCE * self.around(k))
            .map(|k| self.refined(k))
            .collect()
    }

    /// The highest frequency whose amplitude reaches `share` of the largest peak and `least` in the unit of the history.
    #[must_use]
    pub fn highest(&self, share: f64, least: f64) -> Option<Peak> {
        let peaks = self.peaks();
        let largest = peaks.iter().map(|peak| peak.amplitude).fold(0.0, f64::max);
        let enough = least.max(share * largest);
        peaks.into_iter().rfind(|peak| peak.amplitude >= enough)
    }

    /// The larger of the median amplitudes on either side of `k`, the tone itself left out.
    fn around(&self, k: usize) -> f64 {
        let (inner, outer) = (2 * self.spread, 12 * self.spread);
        let below = k.saturating_sub(outer)..k.saturating_sub(inner);
        let above = k + inner + 1..(k + outer + 1).min(self.amplitude.len());
        median(self.amplitude.get(below)).max(median(self.amplitude.get(above)))
    }

    /// The top of the parabola through the logarithms of three amplitudes.
    fn refined(&self, k: usize) -> Peak {
        let [left, top, right] = [k - 1, k, k + 1].map(|n| self.amplitude[n].max(1e-300).ln());
        let bend = left - 2.0 * top + right;
        let shift = if bend < 0.0 {
            (0.5 * (left - right) / bend).clamp(-0.5, 0.5)
        } else {
            0.0
        };
        Peak {
            frequency_hz: (k as f64 + shift) * self.step_hz,
            amplitude: (top - 0.25 * (left - right) * shift).exp(),
        }
    }
}

fn median(values: Option<&[f64]>) -> f64 {
    let mut sorted = values.unwrap_or_default().to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// The samples without their straight line, times the Hann window, filled up with zeros to `length`.
fn windowed(samples: &[f64], length: usize) -> Vec<[f64; 2]> {
    let count = samples.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = samples.iter().sum::<f64>() / count;
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (k, y) in samples.iter().enumerate() {
        let x = k as f64 - middle;
        covariance += x * (y - mean);
        variance += x * x;
    }
    let slope = covariance / variance;
    let mut values: Vec<[f64; 2]> = samples
        .iter()
        .enumerate()
        .map(|(k, y)| {
            let window = 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / count).cos();
            [window * (y - mean - slope * (k as f64 - middle)), 0.0]
        })
        .collect();
    values.resize(length, [0.0; 2]);
    values
}

/// Fast Fourier transform in place (radix 2); the length is a power of two.
fn transform(values: &mut [[f64; 2]]) {
    let length = values.len();
    let bits = length.trailing_zeros();
    for k in 0..length {
        let mirrored = k.reverse_bits() >> (usize::BITS - bits);
        if k < mirrored {
            values.swap(k, mirrored);
        }
    }
    let mut half = 1;
    while half < length {
        let turns: Vec<[f64; 2]> = (0..half)
            .map(|k| {
                let (sin, cos) = (-PI * k as f64 / half as f64).sin_cos();
                [cos, sin]
            })
            .collect();
        for block in values.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((a, b), [c, s]) in low.iter_mut().zip(high).zip(&turns) {
                let rotated = [b[0] * c - b[1] * s, b[0] * s + b[1] * c];
                *b = [a[0] - rotated[0], a[1] - rotated[1]];
                *a = [a[0] + rotated[0], a[1] + rotated[1]];
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(seconds: f64, dt: f64, y: impl Fn(f64) -> f64) -> Spectrum {
        let samples: Vec<f64> = (0..(seconds / dt) as usize)
            .map(|k| y(k as f64 * dt))
            .collect();
        Spectrum::of(&samples, dt).unwrap()
    }

    #[test]
    fn a_sine_gives_its_frequency_and_amplitude() {
        for hz in [3.0, 8.02, 67.4, 212.3, 460.0] {
            let peak = history(2.0, 1e-3, |t| 5.0 * (TAU * hz * t).sin())
                .highest(0.01, 0.0)
                .unwrap();
            assert!((peak.frequency_hz - hz).abs() < 0.02, "{hz}: {peak:?}");
            // The straight line that is taken away takes some of a slow sine with it.
            assert!((peak.amplitude - 5.0).abs() < 0.15, "{hz}: {peak:?}");
        }
    }

    #[test]
    fn a_small_ripple_of_212_hertz_on_an_8_hertz_mode_is_found() {
        let spectrum = history(1.5, 5e-4, |t| {
            2810.0 * (t / 19.0).tanh()
                + 30.0 * (TAU * 8.02 * t).sin()
                + 0.05 * (TAU * 212.0 * t).cos()
        });
        let peak = spectrum.highest(1e-3, 0.0).unwrap();
        assert!((peak.frequency_hz - 212.0).abs() < 0.1, "{peak:?}");
        assert!((peak.amplitude - 0.05).abs() < 0.001, "{peak:?}");
        // With a threshold above the ripple the mode of the bodies is the highest.
        let mode = spectrum.highest(0.01, 0.0).unwrap();
        assert!((mode.frequency_hz - 8.02).abs() < 0.05, "{mode:?}");
        assert_eq!(spectrum.highest(1e-3, 100.0), None);
    }

    #[test]
    fn a_slow_build_up_contains_no_tone() {
        let spectrum = history(2.0, 1e-3, |t| 2810.0 * ((t + 5.0) / 19.0).tanh().powi(2));
        assert_eq!(spectrum.highest(1e-4, 1e-6), None);
    }

    #[test]
    fn a_decaying_mode_has_one_peak_and_no_tail() {
        let spectrum = history(2.0, 1e-3, |t| {
            213.0 + 10.0 * (-2.0 * t).exp() * (TAU * 8.0 * t).sin()
        });
        let peak = spectrum.highest(1e-3, 0.0).unwrap();
        assert!((peak.frequency_hz - 8.0).abs() < 0.3, "{peak:?}");
    }

    #[test]
    fn without_enough_finite_samples_there_is_no_spectrum() {
        assert_eq!(Spectrum::of(&[1.0; 15], 0.1), None);
        assert_eq!(Spectrum::of(&[f64::NAN; 64], 0.1), None);
        assert_eq!(Spectrum::of(&[1.0; 64], 0.0), None);
        let still = Spectrum::of(&[1.0; 64], 0.1).unwrap();
        assert_eq!(still.highest(0.0, 0.0), None);
    }
}
