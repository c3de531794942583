//! Which network is how much better and faster than the best of the other methods, in sentences.

use super::{Claims, Point, Speed};
use crate::methods::method::{Family, Format};
use crate::metrics::paired::Paired;
use crate::verdict::{compared, speed};

impl Speed {
    /// For every depth and noise level, the best and the fastest network against the best of the other methods.
    #[must_use]
    pub fn verdict(&self) -> Vec<String> {
        self.claims.iter().filter_map(|of| self.sentence(of)).collect()
    }

    fn sentence(&self, of: &Claims) -> Option<String> {
        let own = || self.points.iter().filter(|point| of.hold(point));
        let rival = own().filter(|p| is_rival(p)).max_by(|a, b| a.psnr_db.total_cmp(&b.psnr_db))?;
        let best = own().filter(|p| is_network(p)).max_by(|a, b| a.psnr_db.total_cmp(&b.psnr_db))?;
        let fastest = own().filter(|p| is_network(p)).min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
        let against = |net: &Point| -> Option<String> {
            let gain = Paired::between(&net.photo_psnr_db, &rival.photo_psnr_db)?;
            Some(format!("{} and {}", compared(&gain), self.speed(net, rival)))
        };
        let given = if is_given_the_depth(rival) { " (which is given the depth)" } else { "" };
        let mut text = format!(
            "{}: compared with {}{given}, the best of the other methods, the best network, {}, is {}.",
            of.title(),
            rival.method,
            best.method,
            against(best)?
        );
        if fastest.method != best.method {
            text += &format!(" The fastest network, {}, is {}.", fastest.method, against(fastest)?);
        }
        Some(text)
    }

    /// In CPU time, where both have it.
    fn speed(&self, own: &Point, other: &Point) -> String {
        match own.cpu_seconds_per_megapixel.zip(other.cpu_seconds_per_megapixel) {
            Some((own, other)) => format!("{} in CPU time", speed(own, other)),
            None => speed(own.seconds_per_megapixel, other.seconds_per_megapixel),
        }
    }
}

/// Trained networks that ran here; a board's time is computed.
fn is_network(point: &Point) -> bool {
    point.identity.family == Family::Network && point.identity.format != Some(Format::Board)
}

/// Methods that are prepared for the one depth of the scene; networks and the other methods find it out.
const fn is_given_the_depth(point: &Point) -> bool {
    matches!(
        point.identity.family,
        Family::Wiener
            | Family::RichardsonLucy
            | Family::HyperLaplacian
            | Family::OmpKnownDepth
            | Family::FistaKnownDepth
    )
}

/// What a network has to beat.
fn is_rival(point: &Point) -> bool {
    point.identity.family != Family::Network && !point.identity.is_untrained()
}

#[cfg(test)]
mod tests {
    use super::super::tests::timed;
    use super::*;
    use crate::methods::method::Method;
    use crate::study_report::StudyReport;

    /// A network at two strides and a pursuit that is given the depth, on two photographs.
    fn speed(slow: f64, fast: f64) -> Speed {
        let of = |method: &Method, db: f64, seconds: f64| {
            [timed(method, "a", db + 0.1, seconds), timed(method, "b", db, seconds)]
        };
        let network = |stride| Method::network("n", Format::Float, stride, 4);
        let rows = [
            of(&network(2), slow, 2.0),
            of(&network(8), fast, 0.1),
            of(&network(8).in_format(Format::Board), 99.0, 0.01),
            of(&Method::of_patches(Family::FistaKnownDepth, 4), 32.0, 1.0),
            of(&Method::untrained(Family::Untrained, 8, 8), 40.0, 0.2),
        ];
        Speed::new(&rows.concat(), "a machine".into()).unwrap()
    }

    #[test]
    fn the_best_and_the_fastest_network_are_compared_with_the_best_other_method() {
        assert_eq!(
            speed(33.0, 32.5).verdict(),
            [
                "ψ = 8, no noise, real light: compared with fista-known-depth/s4 (which is given the depth), the best of the other \
              methods, the best network, n.float/s2, is better by 1.00 ± 0.00 dB and 2.0 times as slow. The fastest network, \
              n.float/s8, is better by 0.50 ± 0.00 dB and 10 times as fast."
            ]
        );
    }

    #[test]
    fn networks_that_lose_are_said_to_lose() {
        let verdict = speed(31.0, 30.0).verdict().remove(0);
        assert!(
            verdict
                .contains("the best network, n.float/s2, is worse by 1.00 ± 0.00 dB and 2.0 times as slow"),
            "{verdict}"
        );
        assert!(
            verdict.ends_with("n.float/s8, is worse by 2.00 ± 0.00 dB and 10 times as fast."),
            "{verdict}"
        );
    }

    #[test]
    fn without_networks_or_others_there_is_no_verdict() {
        let alone = timed(&Method::of_patches(Family::Omp, 8), "a", 30.0, 1.0);
        let speed = Speed::new(&[alone], "a machine".into()).unwrap();
        assert!(
            speed.verdict().is_empty() && !speed.to_markdown(&crate::made::Made::by("")).contains("Verdict")
        );
    }
}
