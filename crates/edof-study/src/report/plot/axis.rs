//! Axes: which values they show, where on the page each lies, and round numbers beside them.

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// How values are laid out.
    pub scale: Scale,
    /// Ends of the axis; missing items follows from the data.
    pub ends: [Option<f64>; 2],
}

impl Axis {
    /// Equal steps for equal differences.
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, ends: [None; 2] }
    }

    /// Equal steps for equal ratios; values of 0 or less are not plotted.
    #[must_use]
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, ends: [None; 2] }
    }

    /// Starts at `low`.
    #[must_use]
    pub const fn from(mut self, low: f64) -> Self {
        self.ends[0] = Some(low);
        self
    }

    /// Ends at `high`.
    #[must_use]
    pub const fn to(mut self, high: f64) -> Self {
        self.ends[1] = Some(high);
        self
    }
}

/// How an axis lays values out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Linear.
    Linear,
    /// Logarithmic to base 10.
    Log,
}

/// An axis laid out on the page: its range, ticks, and where values lie.
pub(super) struct Ruler {
    scale: Scale,
    low: f64,
    high: f64,
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) ticks: Vec<(f64, String)>,
}

impl Ruler {
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, start: f64, end: f64) -> Self {
        let drawable = |v: &f64| v.is_finite() && (axis.scale == Scale::Linear || *v > 0.0);
        let (mut low, mut high) = values
            .chain(axis.ends.into_iter().flatten())
            .filter(drawable)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            (low, high) = (1.0, 10.0);
        }
        let [fixed_low, fixed_high] = axis.ends.map(|end| end.filter(drawable));
        low = fixed_low.unwrap_or(low);
        high = fixed_high.unwrap_or(high);
        let ticks = match axis.scale {
            Scale::Linear => {
                if high - low < 1e-12 * high.abs().max(1.0) {
                    (low, high) = (low - 0.5, high + 0.5);
                }
                let step = round_step((high - low) / 6.0);
                low = fixed_low.unwrap_or((low / step).floor() * step);
                high = fixed_high.unwrap_or((high / step).ceil() * step);
                linear_ticks(low, high, step)
            }
            Scale::Log => {
                let factors = log_factors(low, high);
                low = fixed_low.unwrap_or_else(|| round_below(low, factors));
                high = fixed_high.unwrap_or_else(|| round_above(high, factors));
                if high <= low {
                    high = low * 10.0;
                }
                log_ticks(low, high, factors)
            }
        };
        Self { scale: axis.scale, low, high, start, end, ticks }
    }

    pub(super) fn place(&self, value: f64) -> f64 {
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value.ln() - self.low.ln()) / (self.high.ln() - self.low.ln()),
        };
        share.mul_add(self.end - self.start, self.start)
    }
}

/// The smallest 1, 2 or 5 times a power of ten that is at least `min`.
fn round_step(min: f64) -> f64 {
    let power = 10f64.powf(min.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= min * (1.0 - 1e-9)).unwrap_or(min)
}

fn linear_ticks(low: f64, high: f64, step: f64) -> Vec<(f64, String)> {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    (first..=last)
        .map(|i| {
            let value = i as f64 * step;
            (value, format!("{value:.decimals$}"))
        })
        .collect()
}

/// What ticks of a logarithmic axis are of a power of ten.
fn log_factors(low: f64, high: f64) -> &'static [f64] {
    if (high / low).log10() < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] }
}

/// The largest factor times a power of ten that is at most `value`.
fn round_below(value: f64, factors: &[f64]) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let ticks = factors.iter().map(|factor| factor * power);
    ticks.filter(|tick| *tick <= value * (1.0 + 1e-9)).fold(power, f64::max)
}

/// The smallest factor times a power of ten that is at least `value`.
fn round_above(value: f64, factors: &[f64]) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let ticks = factors.iter().map(|factor| factor * power);
    ticks.filter(|tick| *tick >= value * (1.0 - 1e-9)).fold(10.0 * power, f64::min)
}

fn log_ticks(low: f64, high: f64, factors: &[f64]) -> Vec<(f64, String)> {
    let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
    powers
        .flat_map(|p| factors.iter().map(move |f| f * 10f64.powi(p)))
        .filter(|v| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(v))
        .map(|v| {
            (
                v,
                if (1e-4 * (1.0 - 1e-9)..1e5).contains(&v) {
                    format!("{}", round_to(v))
                } else {
                    format!("{v:.0e}")
                },
            )
        })
        .collect()
}

/// Hides the last digits of 10f64.powi's error in a tick's text.
fn round_to(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_the_axis() {
        let texts = |low, high| {
            let ruler = Ruler::new(&Axis::linear(""), [low, high].into_iter(), 0.0, 1.0);
            ruler.ticks.into_iter().map(|t| t.1).collect::<Vec<_>>()
        };
        assert_eq!(texts(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(28.4, 38.9), ["28", "30", "32", "34", "36", "38", "40"]);
    }

    #[test]
    fn a_logarithmic_axis_spaces_decades_equally() {
        let ruler = Ruler::new(&Axis::log("t"), [0.02, 300.0].into_iter(), 0.0, 100.0);
        let places: Vec<f64> = ruler.ticks.iter().map(|(v, _)| ruler.place(*v)).collect();
        assert_eq!(
            places.iter().map(|p| p.round()).collect::<Vec<_>>(),
            [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]
        );
        assert_eq!(ruler.ticks[0].1, "0.01");
        let ruler = Ruler::new(&Axis::log("t"), [1.2e-4, 11.0].into_iter(), 0.0, 100.0);
        let texts: Vec<&str> = ruler.ticks.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["0.0001", "0.001", "0.01", "0.1", "1", "10", "100"]);
    }
}
