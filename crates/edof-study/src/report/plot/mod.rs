//! Line and scatter plots as SVG text: axes with round numbers, a legend beside or below them, linear or logarithmic scales.
//!
//! ```
//! use edof_study::report::plot::{Axis, Mark, Plot, Series};
//! let plot = Plot {
//!     title: "A parabola".into(),
//!     x: Axis::linear("x"),
//!     y: Axis::linear("x²").from(0.0),
//!     size: edof_study::report::plot::USUAL,
//!     series: vec![Series::new("x²", Mark::Line, (0..10).map(|i| [f64::from(i), f64::from(i * i)]))],
//! };
//! assert!(plot.to_svg().starts_with("<svg"));
//! ```

mod area;
mod axis;
mod palette;

pub use axis::{Axis, Scale};
pub use palette::{PALETTE, sequential};

use area::{Anchor, Area, along};
use axis::Ruler;
use std::fmt::Write;

/// One diagram.
#[derive(Debug, Clone)]
pub struct Plot {
    /// Heading.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Width and height in pixels; a legend that would take too much of the width stands below and adds to the height.
    pub size: [f64; 2],
    /// Items of the plot, the first one lowest.
    pub series: Vec<Series>,
}

/// The size of a diagram that is whole on a phone.
pub const SMALL: [f64; 2] = [400.0, 300.0];
/// The size of most diagrams.
pub const USUAL: [f64; 2] = [640.0, 400.0];

/// Points that belong together.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend; none where empty.
    pub label: String,
    /// Whether its name is next to one of its points, if it fits, instead of in the legend.
    pub is_named_at_points: bool,
    /// Style of points.
    pub mark: Mark,
    /// What stands at each point; where missing discs, and others once the palette's colours are used up.
    pub shape: Option<Shape>,
    /// CSS colour; from [`PALETTE`] in turn where missing.
    pub colour: Option<String>,
    /// Pairs of x and y; points that are not finite interrupt a line.
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// A series in the next colour of the palette.
    #[must_use]
    pub fn new(label: impl Into<String>, mark: Mark, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let (label, points) = (label.into(), points.into_iter().collect());
        Self { label, is_named_at_points: false, mark, shape: None, colour: None, points }
    }

    /// The same series with its name beside one of its points.
    #[must_use]
    pub const fn named_at_points(mut self) -> Self {
        self.is_named_at_points = true;
        self
    }

    /// The same series with other points.
    #[must_use]
    pub const fn shaped(mut self, shape: Shape) -> Self {
        self.shape = Some(shape);
        self
    }

    fn shape(&self, index: usize) -> Shape {
        let by_place = match index / PALETTE.len() {
            0 => Shape::Disc,
            1 => Shape::Square,
            _ => Shape::Diamond,
        };
        self.shape.unwrap_or(by_place)
    }

    /// The same series in a colour of the user.
    #[must_use]
    pub fn coloured(mut self, colour: impl Into<String>) -> Self {
        self.colour = Some(colour.into());
        self
    }
}

/// What stands at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A disc.
    Disc,
    /// An upright square.
    Square,
    /// A square on its corner.
    Diamond,
}

/// Style of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A continuous line.
    Line,
    /// A dashed line.
    Dashed,
    /// A dotted line.
    Dotted,
    /// A dot at each point.
    Points,
    /// A continuous line with a dot at each point.
    LineAndPoints,
}

const LEFT: f64 = 66.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 52.0;
const LINE_HEIGHT: f64 = 18.0;
/// Mean width of a letter in the widest of the usual fonts, and height of a line of text, in pixels.
const LETTER: [f64; 2] = [7.0, 13.0];
/// Size of a title's letters, and the mean width of one in the same font, in pixels.
const TITLE: f64 = 14.0;
const BOLD: f64 = 8.6;
/// Pixels from a dot's middle to its rim, and a little.
const DOT_REACH: f64 = 5.0;
/// The most of a diagram's width that a legend beside it may take.
const LEGEND_SHARE: f64 = 0.3;
impl Plot {
    /// The diagram as a complete SVG document.
    #[must_use]
    pub fn to_svg(&self) -> String {
        document(self.whole_size(), &self.group([0.0; 2], true))
    }

    /// The same without its legend ([`Plot::legend`]), in colours that a page may turn dark.
    pub(crate) fn to_svg_for_page(&self) -> String {
        palette::for_page(&document(self.size, &self.group([0.0; 2], false)))
    }

    /// Every entry of the legend: its line and dot as SVG of a line's height, and its name.
    pub(crate) fn legend(&self) -> Vec<(String, &str)> {
        let entry = |(index, series): (usize, &'_ Series)| {
            let mut mark = String::new();
            draw_mark(&mut mark, series, index, [0.0, 8.0]);
            let mark = format!(
                "<svg viewBox=\"0 0 24 16\" width=\"24\" height=\"16\" aria-hidden=\"true\">{mark}</svg>"
            );
            palette::for_page(&mark)
        };
        self.in_legend().map(|(index, series)| (entry((index, series)), series.label.as_str())).collect()
    }

    /// Width and height with the legend, in pixels.
    fn whole_size(&self) -> [f64; 2] {
        let [width, height] = self.size;
        let lines = self.legend_below().map_or(0, |columns| self.in_legend().count().div_ceil(columns));
        [width, LINE_HEIGHT.mul_add(lines as f64, height)]
    }

    /// The diagram as an SVG group whose upper left corner lies at `x0` and `y0`.
    fn group(&self, [x0, y0]: [f64; 2], has_legend: bool) -> String {
        let [width, height] = self.size;
        let right = if !has_legend || self.legend_below().is_some() { 16.0 } else { self.legend_width() };
        let x = Ruler::new(&self.x, self.values(0), LEFT, width - right);
        let y = Ruler::new(&self.y, self.values(1), height - BOTTOM, TOP);
        let mut svg = format!("<g transform=\"translate({x0} {y0})\">\n");
        self.draw_frame(&mut svg, &x, &y);
        let (w, h) = (x.end - x.start, y.start - y.end);
        // A page may contain many diagrams: those of one name have one size.
        let id = format!("area{w:.0}x{h:.0}");
        let _ = writeln!(
            svg,
            "<clipPath id=\"{id}\"><rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\
             <g clip-path=\"url(#{id})\">",
            // A dot on an end of an axis is whole.
            LEFT - DOT_REACH,
            TOP - DOT_REACH,
            w + 2.0 * DOT_REACH,
            h + 2.0 * DOT_REACH
        );
        for (index, series) in self.series.iter().enumerate() {
            draw_series(&mut svg, series, index, &x, &y);
        }
        svg.push_str("</g>\n");
        self.name_points(&mut svg, &x, &y);
        match self.legend_below() {
            _ if !has_legend => {}
            Some(columns) => self.draw_legend(&mut svg, [LEFT, height], columns),
            None => self.draw_legend(&mut svg, [width - right + 14.0, TOP + 10.0], 1),
        }
        svg.push_str("</g>\n");
        svg
    }

    fn values(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        self.series.iter().flat_map(move |s| s.points.iter().map(move |p| p[axis]))
    }

    fn legend_width(&self) -> f64 {
        let longest = self.in_legend().map(|(_, s)| s.label.chars().count()).max().unwrap_or(0);
        if longest == 0 { 16.0 } else { (longest as f64).mul_add(LETTER[0], 58.0) }
    }

    /// Columns of a legend below the plot; none for a legend next to it, where it takes little of the width and is not higher than the plot.
    fn legend_below(&self) -> Option<usize> {
        let [width, height] = self.size;
        let lines = self.in_legend().count() as f64 * LINE_HEIGHT;
        let is_beside = self.legend_width() <= LEGEND_SHARE * width && lines <= height - TOP - BOTTOM;
        (!is_beside).then(|| self.legend_columns(width))
    }

    /// Columns of a legend with so much width.
    fn legend_columns(&self, width: f64) -> usize {
        (((width - LEFT) / self.legend_width()) as usize).max(1)
    }

    fn draw_frame(&self, svg: &mut String, x: &Ruler, y: &Ruler) {
        for (value, text) in &x.ticks {
            let at = x.place(*value);
            let (top, bottom, below) = (y.end, y.start, y.start + 16.0);
            // A long number at the end of the axis is whole.
            let middle = at.min(self.size[0] - 2.0 - 0.5 * LETTER[0] * text.chars().count() as f64);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {top:.1}V{bottom:.1}\"/>\
                 <text x=\"{middle:.1}\" y=\"{below:.1}\" text-anchor=\"middle\">{text}</text>"
            );
        }
        for (value, text) in &y.ticks {
            let at = y.place(*value);
            let (left, right, beside) = (x.start, x.end, x.start - 6.0);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{left:.1} {at:.1}H{right:.1}\"/>\
                 <text x=\"{beside:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                at + 4.0
            );
        }
        let (middle_x, middle_y) = (0.5 * (x.start + x.end), 0.5 * (y.start + y.end));
        let _ = writeln!(
            svg,
            "<path class=\"axis\" d=\"M{:.1} {:.1}V{:.1}H{:.1}\"/>\
             <text class=\"title\" x=\"{:.1}\" y=\"24\"{}>{}</text>\
             <text x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
             <text transform=\"translate(16 {middle_y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            x.start,
            y.end,
            y.start,
            x.end,
            x.start,
            self.narrowed(x.start),
            escape(&self.title),
            self.size[1] - 12.0,
            escape(&self.x.label),
            escape(&self.y.label)
        );
    }

    /// Smaller letters for a title that could be cut at the right, as an attribute. Its width is known for the widest of the usual fonts alone, so
    /// that a stated length would stretch it in others.
    fn narrowed(&self, start: f64) -> String {
        let share = (self.size[0] - start - 6.0) / (self.title.chars().count() as f64 * BOLD);
        if share < 1.0 { format!(" style=\"font-size:{:.1}px\"", TITLE * share) } else { String::new() }
    }

    /// Writes names beside points: each where it covers no point and no other name, or as little as can be.
    fn name_points(&self, svg: &mut String, x: &Ruler, y: &Ruler) {
        let frame = Area { x: [x.start, x.end], y: [y.end, y.start] };
        let placed = |series: &Series| -> Vec<[f64; 2]> {
            let all = series.points.iter().map(|&[a, b]| [x.place(a), y.place(b)]);
            all.filter(|&[a, b]| Area::around([a, b], 1.0).shared(&frame) > 0.0).collect()
        };
        let dots = self.series.iter().flat_map(placed).map(|at| Area::around(at, 4.0));
        let lines = self.series.iter().filter(|s| dashes(s.mark).is_some()).flat_map(|s| along(&placed(s)));
        let mut taken: Vec<Area> = dots.chain(lines.map(|at| Area::around(at, 1.0))).collect();
        for (index, series) in self.series.iter().enumerate().filter(|(_, s)| s.is_named_at_points) {
            let size = [series.label.chars().count() as f64 * LETTER[0], LETTER[1]];
            // The last point first: there a line ends.
            let spots = placed(series).into_iter().rev().flat_map(|at| Area::beside(at, size));
            let covered = |(area, _): &(Area, Anchor)| {
                let outside = size[0] * size[1] - area.shared(&frame);
                // In whole pixels: of places that are equally free the first one is taken, whatever sums of fractions say.
                (taken.iter().map(|other| area.shared(other)).sum::<f64>() + 10.0 * outside).round() as i64
            };
            let Some((best, anchor)) = spots.min_by_key(covered) else {
                continue;
            };
            // `color` is what a page's style makes darker or lighter than the points: text is thin. What paper it has around it parts it
            // from lines that pass below.
            let _ = writeln!(
                svg,
                "<text class=\"name\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{}\" color=\"{own}\" fill=\"{own}\" \
                 stroke=\"#fff\" stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\">{}</text>",
                anchor.of(&best),
                best.y[1] - 3.0,
                anchor.name(),
                escape(&series.label),
                own = colour(series, index)
            );
            taken.push(best);
        }
    }

    fn in_legend(&self) -> impl Iterator<Item = (usize, &Series)> {
        self.series.iter().enumerate().filter(|(_, s)| !s.label.is_empty() && !s.is_named_at_points)
    }

    fn draw_legend(&self, svg: &mut String, [left, top]: [f64; 2], columns: usize) {
        for (place, (index, series)) in self.in_legend().enumerate() {
            let left = self.legend_width().mul_add((place % columns) as f64, left);
            let y = LINE_HEIGHT.mul_add((place / columns) as f64, top);
            draw_mark(svg, series, index, [left, y]);
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                left + 30.0,
                y + 4.0,
                escape(&series.label)
            );
        }
    }
}

/// Diagrams of one size whose series have the same names and colours, row by row with N in each, as one SVG document with one legend below all.
#[must_use]
pub fn grid(plots: &[Plot], columns: usize) -> String {
    let Some(first) = plots.first() else { return document([0.0; 2], "") };
    let [width, height] = first.size;
    let whole = [width * columns as f64, height * plots.len().div_ceil(columns) as f64];
    let corner = |place: usize| [width * (place % columns) as f64, height * (place / columns) as f64];
    let mut inside: String =
        plots.iter().enumerate().map(|(place, plot)| plot.group(corner(place), false)).collect();
    let (entries, top) = (first.legend_columns(whole[0]), whole[1] + 0.5 * LINE_HEIGHT);
    first.draw_legend(&mut inside, [LEFT, top], entries);
    let lines = first.in_legend().count().div_ceil(entries);
    document([whole[0], LINE_HEIGHT.mul_add(lines as f64, top)], &inside)
}

/// Several diagrams in a row, as one SVG document.
#[must_use]
pub fn side_by_side(plots: &[Plot]) -> String {
    together(plots, |[width, height], own| ([width, 0.0], [width + own[0], height.max(own[1])]))
}

/// Several diagrams, each below the one before, as one SVG document.
#[must_use]
pub fn stacked(plots: &[Plot]) -> String {
    together(plots, |[width, height], own| ([0.0, height], [width.max(own[0]), height + own[1]]))
}

/// Diagrams in one document. `place` says from the size of those before and a diagram's own where its corner lies, and how large all are.
fn together(plots: &[Plot], place: impl Fn([f64; 2], [f64; 2]) -> ([f64; 2], [f64; 2])) -> String {
    let (mut size, mut groups) = ([0.0; 2], String::new());
    for plot in plots {
        let corner;
        (corner, size) = place(size, plot.whole_size());
        groups.push_str(&plot.group(corner, true));
    }
    document(size, &groups)
}

fn document([width, height]: [f64; 2], inside: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#222\">\n\
         <style>.grid{{stroke:#e4e4e4;fill:none}}.axis{{stroke:#444;fill:none}}\
         .line{{fill:none;stroke-width:1.8;stroke-linejoin:round}}.title{{font-size:14px;font-weight:bold}}</style>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n{inside}</svg>\n"
    )
}

fn colour(series: &Series, index: usize) -> &str {
    series.colour.as_deref().unwrap_or(PALETTE[index % PALETTE.len()])
}

/// A dot.
fn dot(shape: Shape, [x, y]: [f64; 2], colour: &str, told: &str) -> String {
    let (tag, place) = match shape {
        Shape::Disc => ("circle", format!("cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"")),
        Shape::Square => {
            ("rect", format!("x=\"{:.1}\" y=\"{:.1}\" width=\"6\" height=\"6\"", x - 3.0, y - 3.0))
        }
        Shape::Diamond => ("path", format!("d=\"M{:.1} {y:.1}l4 -4l4 4l-4 4z\"", x - 4.0)),
    };
    format!("<{tag} {place} fill=\"{colour}\">{told}</{tag}>")
}

/// The line's dash attribute; none without a line.
const fn dashes(mark: Mark) -> Option<&'static str> {
    match mark {
        Mark::Line | Mark::LineAndPoints => Some(""),
        Mark::Dashed => Some(" stroke-dasharray=\"7 4\""),
        Mark::Dotted => Some(" stroke-dasharray=\"1.8 3.4\""),
        Mark::Points => None,
    }
}

/// What stands for a series in a legend, 24 pixels wide.
fn draw_mark(svg: &mut String, series: &Series, index: usize, [left, y]: [f64; 2]) {
    let (colour, middle, end) = (colour(series, index), left + 12.0, left + 24.0);
    if let Some(dashes) = dashes(series.mark) {
        let _ = write!(
            svg,
            "<path class=\"line\" fill=\"none\" stroke-width=\"1.8\" stroke=\"{colour}\"{dashes} d=\"M{left:.1} {y:.1}H{end:.1}\"/>"
        );
    }
    if matches!(series.mark, Mark::Points | Mark::LineAndPoints) {
        svg.push_str(&dot(series.shape(index), [middle, y], colour, ""));
    }
}

fn draw_series(svg: &mut String, series: &Series, index: usize, x: &Ruler, y: &Ruler) {
    let colour = colour(series, index);
    let placed: Vec<Option<[f64; 2]>> = series
        .points
        .iter()
        .map(|&[a, b]| Some([x.place(a), y.place(b)]).filter(|p| p.iter().all(|v| v.is_finite())))
        .collect();
    if let Some(dashes) = dashes(series.mark) {
        let mut path = String::new();
        let mut pen = 'M';
        for point in &placed {
            if let Some([a, b]) = point {
                let _ = write!(path, "{pen}{a:.1} {b:.1}");
                pen = 'L';
            } else {
                pen = 'M';
            }
        }
        let _ = writeln!(svg, "<path class=\"line\" stroke=\"{colour}\"{dashes} d=\"{path}\"/>");
    }
    if matches!(series.mark, Mark::Points | Mark::LineAndPoints) {
        for (place, [x, y]) in placed.into_iter().zip(&series.points) {
            let Some(at) = place else { continue };
            // Shown where the pointer rests on the dot.
            let told = format!("<title>{}: {}, {}</title>", escape(&series.label), short(*x), short(*y));
            let _ = writeln!(svg, "{}", dot(series.shape(index), at, colour, &told));
        }
    }
}

/// A number in four digits or fewer.
fn short(value: f64) -> String {
    let digits = (3 - value.abs().max(1e-9).log10().floor() as i32).clamp(0, 6);
    let scale = 10f64.powi(digits);
    format!("{}", (value * scale).round() / scale)
}

/// Text that may stand between tags.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests;
