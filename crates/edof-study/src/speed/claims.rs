//! What the paper claims of speed and error, and what it is here.

use super::Point;
use crate::methods::method::{Family, Format, Method};
use crate::metrics::paired::Paired;
use serde::Serialize;

/// A sentence of the paper, and what it is here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Claim {
    /// What is compared.
    pub of: String,
    /// What the paper reports.
    pub paper: &'static str,
    /// What was measured.
    pub here: String,
}

/// The paper's comparisons of all networks and strides that there are.
pub(super) fn all_claims(points: &[&Point]) -> Vec<Claim> {
    let mut claims: Vec<Claim> = trained(points).flat_map(|net| of_network(net, points)).collect();
    claims.extend(of_pursuits(points));
    claims.extend(of_layers(points));
    claims
}

impl Claim {
    fn new(of: String, paper: &'static str, here: String) -> Self {
        Self { of, paper, here }
    }

    /// How many dB more one has than another, on the photographs that both were measured on.
    fn gain(a: &Point, b: &Point, paper: &'static str) -> Self {
        Self::new(format!("{} minus {}", a.method, b.method), paper, gain(a, b))
    }

    /// How many times faster one is than another.
    fn speed(fast: &Point, slow: &Point, paper: &'static str) -> Self {
        Self::new(format!("{} is faster than {}", fast.method, slow.method), paper, times(slow, fast))
    }
}

fn gain(a: &Point, b: &Point) -> String {
    let paired = Paired::between(&a.photo_psnr_db, &b.photo_psnr_db);
    paired.map_or_else(|| "no photograph of both".to_owned(), |paired| format!("{paired} dB"))
}

fn times(slow: &Point, fast: &Point) -> String {
    let wall = format!("{:.1} times", slow.seconds_per_megapixel / fast.seconds_per_megapixel);
    match slow.cpu_seconds_per_megapixel.zip(fast.cpu_seconds_per_megapixel) {
        Some((slow, fast)) => format!("{wall}, {:.1} times in CPU time", slow / fast),
        None => wall,
    }
}

fn trained<'a>(points: &'a [&Point]) -> impl Iterator<Item = &'a Point> {
    let float = |p: &&Point| p.identity.format == Some(Format::Float) && !p.identity.is_untrained();
    points.iter().copied().filter(float)
}

fn blind<'a>(points: &'a [&Point]) -> Option<&'a Point> {
    points.iter().copied().find(|p| p.identity.family == Family::BlindDeconvolution)
}

fn pursuits<'a>(points: &'a [&Point]) -> impl Iterator<Item = &'a Point> {
    points.iter().copied().filter(|p| p.identity.family == Family::Omp)
}

fn of_network(net: &Point, points: &[&Point]) -> Vec<Claim> {
    let mut claims = vec![];
    let omp = pursuits(points).find(|p| p.identity.stride == net.identity.stride);
    if let Some(omp) = omp {
        claims.push(Claim::gain(net, omp, "at least 0 dB"));
        claims.push(Claim::speed(net, omp, "more than 15 times"));
    }
    if let Some(blind) = blind(points) {
        claims.push(Claim::gain(net, blind, "more than 1 dB"));
        claims.push(Claim::speed(net, blind, "more than 500 times"));
    }
    let of_format = |format| {
        let twin = net.identity.in_format(format);
        points.iter().copied().find(move |p| p.identity == twin)
    };
    if let Some(board) = of_format(Format::Board) {
        // For one real frame of 1920×1080: 0.5 s against 140 s and 450 to 460 s.
        let faster = |slow: &Point, paper| {
            let of = format!("{} (by its cycles) is faster than {}", board.method, slow.method);
            Claim::new(of, paper, times(slow, board))
        };
        claims.extend(omp.map(|omp| faster(omp, "280 times")));
        claims.extend(blind(points).map(|blind| faster(blind, "900 times")));
    }
    claims.extend(of_format(Format::Fixed).map(|fixed| Claim::gain(fixed, net, "the same")));
    claims
}

fn of_pursuits(points: &[&Point]) -> Vec<Claim> {
    let Some(blind) = blind(points) else { return vec![] };
    let each = |omp| [Claim::gain(omp, blind, "more than 1 dB"), Claim::speed(omp, blind, "about 30 times")];
    pursuits(points).flat_map(each).collect()
}

fn of_layers(points: &[&Point]) -> Vec<Claim> {
    let layers = |t| trained(points).find(move |p| p.identity.layers == Some(t));
    let trained = layers(8).zip(layers(10)).map(|(eight, ten)| Claim::gain(eight, ten, "about 0 dB"));
    let mut claims: Vec<Claim> = trained.into_iter().collect();
    let eights = points.iter().filter(|p| p.identity.is_untrained() && p.identity.layers == Some(8));
    claims.extend(eights.filter_map(|eight| {
        let twin = Method { layers: Some(10), ..eight.identity.clone() };
        let ten = points.iter().find(|p| p.identity == twin)?;
        Some(Claim::gain(eight, ten, "about 0 dB, of trained ones"))
    }));
    claims
}
