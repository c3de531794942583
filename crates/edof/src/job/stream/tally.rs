//! Rates and latencies of a stream, in each second and in all.

use serde::Serialize;
use std::time::{Duration, Instant};

/// Frames of a second, or of the whole stream.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pace {
    /// Frames that were written since the stream began.
    pub frames: u64,
    /// Frames a second.
    pub per_second: f64,
    /// Frames that were left out because no time was left for them, since the stream began.
    pub dropped: u64,
    /// Milliseconds from a frame's last byte in to its last byte out: the median.
    pub latency_ms: f64,
    /// The most.
    pub most_latency_ms: f64,
    /// What the first frame shows.
    pub first: FirstFrame,
}

/// What the first frame of a stream shows of how it is read.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct FirstFrame {
    /// Least and largest sensor value.
    pub values: [u16; 2],
    /// Share of the sensor values that are below the stated black.
    pub below_black: f64,
    /// Whether what the phase takes for green differs as red and blue do.
    pub is_of_other_phase: bool,
}

/// Counts frames.
pub(super) struct Tally {
    second: Span,
    all: Span,
    dropped: u64,
    first: FirstFrame,
}

/// Buckets of latencies in a millisecond.
const FINENESS: u32 = 10;
/// Longer latencies, of a minute, are counted as this one.
const LONGEST: usize = 60_000 * FINENESS as usize;

/// Latencies since a time, in buckets: as much memory for a day as for a minute.
struct Span {
    begun: Instant,
    frames: u64,
    buckets: Vec<u64>,
}

impl Span {
    const fn new(begun: Instant) -> Self {
        Self { begun, frames: 0, buckets: vec![] }
    }

    fn add(&mut self, latency: Duration) {
        let bucket = ((latency * FINENESS).as_millis() as usize).min(LONGEST);
        self.buckets.resize(self.buckets.len().max(bucket + 1), 0);
        self.buckets[bucket] += 1;
        self.frames += 1;
    }

    /// Returns the milliseconds that a share of the frames did not exceed.
    fn quantile_ms(&self, share: f64) -> f64 {
        let mut left = (share * self.frames as f64).ceil() as u64;
        let within = self.buckets.iter().position(|frames| {
            left = left.saturating_sub(*frames);
            left == 0
        });
        within.unwrap_or(0) as f64 / f64::from(FINENESS)
    }
}

impl Tally {
    pub(super) fn new(now: Instant) -> Self {
        Self { second: Span::new(now), all: Span::new(now), dropped: 0, first: FirstFrame::default() }
    }

    /// Counts a frame that was written.
    pub(super) fn written(&mut self, arrived: Instant, now: Instant) {
        for span in [&mut self.second, &mut self.all] {
            span.add(now - arrived);
        }
    }

    /// Notes what the first frame shows.
    pub(super) const fn began(&mut self, first: FirstFrame) {
        self.first = first;
    }

    /// Counts a frame that was left out.
    pub(super) const fn dropped(&mut self) {
        self.dropped += 1;
    }

    /// Returns what the last second did, once it is over.
    pub(super) fn second(&mut self, now: Instant) -> Option<Pace> {
        if now - self.second.begun < Duration::from_secs(1) {
            return None;
        }
        let span = std::mem::replace(&mut self.second, Span::new(now));
        Some(self.pace(&span, now))
    }

    /// Returns what the whole stream did.
    pub(super) fn all(&self, now: Instant) -> Pace {
        self.pace(&self.all, now)
    }

    fn pace(&self, span: &Span, now: Instant) -> Pace {
        let seconds = (now - span.begun).as_secs_f64();
        Pace {
            frames: self.all.frames,
            per_second: if seconds > 0.0 { span.frames as f64 / seconds } else { 0.0 },
            dropped: self.dropped,
            latency_ms: span.quantile_ms(0.5),
            most_latency_ms: span.quantile_ms(1.0),
            first: self.first,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_is_counted_apart_from_the_whole() {
        let begun = Instant::now();
        let at = |ms| begun + Duration::from_millis(ms);
        let mut tally = Tally::new(begun);
        for (arrived, written) in [(0, 10), (100, 130), (200, 220)] {
            tally.written(at(arrived), at(written));
        }
        assert_eq!(tally.second(at(999)), None);
        let second = tally.second(at(1000)).unwrap();
        assert_eq!((second.frames, second.per_second, second.dropped), (3, 3.0, 0));
        assert_eq!((second.latency_ms.round(), second.most_latency_ms.round()), (20.0, 30.0));
        tally.dropped();
        tally.written(at(1100), at(1200));
        let second = tally.second(at(2000)).unwrap();
        assert_eq!(
            (second.frames, second.per_second, second.latency_ms.round(), second.dropped),
            (4, 1.0, 100.0, 1)
        );
        let all = tally.all(at(2000));
        assert_eq!((all.frames, all.per_second, all.most_latency_ms.round()), (4, 2.0, 100.0));
        tally.written(begun, at(3_600_000));
        assert_eq!(tally.all(at(2000)).most_latency_ms, 60_000.0);
        assert_eq!(Tally::new(begun).all(begun).latency_ms, 0.0);
    }
}
