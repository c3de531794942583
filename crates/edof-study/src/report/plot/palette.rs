//! Colours of series.

/// Colours that stay apart in print and for most eyes (Okabe and Ito).
pub const PALETTE: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c8c00"];

/// Colours of a quantity that grows, from dark to light, distinguishable by most eyes and in grey ("viridis" without its lightest end, which
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

/// A drawing whose colours a page may set: each of the palette, paper, ink and lines by a variable of the page's style, all others mixed
/// with the page's `--lift`.
pub(super) fn for_page(svg: &str) -> String {
    let mut out = String::with_capacity(2 * svg.len());
    let mut rest = svg;
    while let Some((before, after)) = rest.split_once("=\"#") {
        let (code, behind) = after.split_once('"').unwrap_or((after, ""));
        let colour = format!("#{code}");
        let known = PALETTE.iter().position(|own| *own == colour).map(|place| format!("c{place}"));
        let known =
            known.or_else(|| PAGE.iter().find(|(own, _)| *own == colour).map(|(_, name)| (*name).to_owned()));
        let value = match known {
            Some(name) => format!("var(--{name},{colour})"),
            None => format!("color-mix(in oklab,{colour},var(--lift,{colour}))"),
        };
        out += &format!("{before}=\"{value}\"");
        rest = behind;
    }
    out + rest
}

/// Colours of a drawing that are none of a series.
const PAGE: [(&str, &str); 2] = [("#fff", "paper"), ("#222", "ink")];

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

    #[test]
    fn colours_of_a_page_have_names_and_unknown_ones_are_lifted() {
        let svg = "<g fill=\"#222\"><path stroke=\"#cc79a7\" d=\"M0 0\"/><path stroke=\"#123456\"/></g>";
        assert_eq!(
            for_page(svg),
            "<g fill=\"var(--ink,#222)\"><path stroke=\"var(--c3,#cc79a7)\" d=\"M0 0\"/>\
             <path stroke=\"color-mix(in oklab,#123456,var(--lift,#123456))\"/></g>"
        );
    }
}
