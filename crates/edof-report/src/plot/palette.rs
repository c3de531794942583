//! Colours of series.

/// Colours that stay apart in print and for most eyes (Okabe and Ito).
pub const PALETTE: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c8c00"];

/// Colours of a quantity that grows, from dark to light, told apart by most eyes and in grey ("viridis" without its lightest end, which
/// paper swallows).
const SEQUENCE: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [64.0, 67.0, 135.0],
    [41.0, 120.0, 142.0],
    [34.0, 167.0, 132.0],
    [94.0, 201.0, 97.0],
    [190.0, 205.0, 30.0],
];

/// The colour of a quantity at `share`, 0…1, of its range.
#[must_use]
pub fn sequential(share: f64) -> String {
    let place = share.clamp(0.0, 1.0) * (SEQUENCE.len() - 1) as f64;
    let first = (place as usize).min(SEQUENCE.len() - 2);
    let part = place - first as f64;
    let code = |i: usize| (SEQUENCE[first][i] * (1.0 - part) + SEQUENCE[first + 1][i] * part).round() as u8;
    format!("#{:02x}{:02x}{:02x}", code(0), code(1), code(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sequence_of_colours_grows_lighter() {
        assert_eq!([sequential(0.0), sequential(0.2), sequential(1.0)], ["#440154", "#404387", "#becd1e"]);
        let lightness = |share: f64| {
            let colour = u32::from_str_radix(&sequential(share)[1..], 16).unwrap();
            [16, 8, 0]
                .map(|bit| f64::from(colour >> bit & 255))
                .iter()
                .zip([0.2126, 0.7152, 0.0722])
                .map(|(c, w)| c * w)
                .sum()
        };
        let steps: Vec<f64> = (0..=20).map(|i| lightness(f64::from(i) / 20.0)).collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0] + 2.0), "{steps:?}");
    }
}
