//! Tables for a paper, in LaTeX: means over photographs, with their standard errors.

use crate::made::Made;
use crate::methods::method::Format;
use crate::summary::Study;
use crate::tables::{noise_words, psi_words};
use edof_core::Noise;

impl Study {
    /// Returns a table for the package booktabs: for each method, camera and noise the PSNR in dB at the farthest depth and averaged over
    /// depths, as mean ± standard error over photographs.
    #[must_use]
    pub fn to_latex(&self, made: &Made) -> String {
        let noises = self.summary.noises();
        let subjects = self.summary.subjects();
        let farthest = self.rows.iter().map(|row| row.psi).fold(f64::NEG_INFINITY, f64::max);
        let shown = subjects.into_iter().filter(|subject| subject.0.format != Some(Format::Float422));
        let rows = shown.map(|subject| {
            let of = |noise: &Noise| match self.summary.find(subject, *noise) {
                Some(found) => {
                    let [farthest, _, average] = found.picture.cells();
                    [farthest, average].map(cell)
                }
                None => [DASH, DASH].map(str::to_owned),
            };
            let names = [subject.0.to_string(), subject.1.to_owned()].map(|name| escaped(&name));
            names.into_iter().chain(noises.iter().flat_map(of)).collect()
        });
        let groups = noises.iter().map(|noise| noise_in_latex(*noise));
        let depths = [format!("$\\psi = {}$", psi_words(farthest)), "average".to_owned()];
        let remark = "PSNR in dB, mean and standard error over photographs.";
        tabular(&format!("{made}\n{remark}"), &["method", "camera"], groups, &depths, rows)
    }
}

/// What stands for a number that there is not.
pub(crate) const DASH: &str = "--";

/// Returns a table for the package booktabs. Columns begin with `names`; each group has the columns `titles`. Remarks are comments above it.
pub(crate) fn tabular(
    remarks: &str,
    names: &[&str],
    groups: impl Iterator<Item = String>,
    titles: &[String],
    rows: impl Iterator<Item = Vec<String>>,
) -> String {
    let width = titles.len();
    let groups: Vec<String> =
        groups.map(|title| format!("\\multicolumn{{{width}}}{{c}}{{{title}}}")).collect();
    let remarks: String =
        format!("{remarks}\nNeeds the package booktabs.").lines().map(|line| format!("% {line}\n")).collect();
    let columns = "l".repeat(names.len()) + &"r".repeat(width * groups.len());
    let titles = std::iter::repeat_n(titles, groups.len()).flatten().cloned();
    let titles = names.iter().map(|&name| name.to_owned()).chain(titles).collect();
    let groups = names.iter().map(|_| String::new()).chain(groups).collect();
    format!(
        "{remarks}\\begin{{tabular}}{{{columns}}}\n\\toprule\n{}{}\\midrule\n{}\\bottomrule\n\\end{{tabular}}\n",
        line(groups),
        line(titles),
        rows.map(line).collect::<String>(),
    )
}

/// A mean with its standard error.
pub(crate) fn cell((mean, standard_error): (f64, Option<f64>)) -> String {
    match standard_error {
        _ if mean.is_infinite() => "$\\infty$".to_owned(),
        Some(error) => format!("${mean:.2} \\pm {error:.2}$"),
        None => format!("${mean:.2}$"),
    }
}

fn line(cells: Vec<String>) -> String {
    cells.join(" & ") + " \\\\\n"
}

/// What tables call a noise.
pub(crate) fn noise_in_latex(noise: Noise) -> String {
    match noise {
        Noise::Gaussian { sigma } => format!("$\\sigma = {sigma}$"),
        noise => escaped(&noise_words(noise)),
    }
}

/// Text without characters that LaTeX reads as commands.
pub(crate) fn escaped(text: &str) -> String {
    let escape = |letter: char| match letter {
        '\\' => "\\textbackslash{}".to_owned(),
        '~' => "\\textasciitilde{}".to_owned(),
        '^' => "\\textasciicircum{}".to_owned(),
        '&' | '%' | '$' | '#' | '_' | '{' | '}' => format!("\\{letter}"),
        letter => letter.to_string(),
    };
    text.chars().map(escape).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::method::Method;
    use crate::summary::tests::{net, row};

    #[test]
    fn a_cell_has_the_standard_error_over_photographs() {
        let sigma = Noise::gaussian(0.01);
        let float = net(Format::Float);
        // At psi 8: 30, 32 and 37 dB, mean 33 and standard error √(13/3); averages over depths 32, 34 and 38: 34.67 and 1.76.
        let study = Study::of(vec![
            row(&Method::demosaic(), "p", 8.0, Noise::None, 29.0),
            row(&float, "p", 0.0, sigma, 34.0),
            row(&float, "p", 8.0, sigma, 30.0),
            row(&float, "q", 0.0, sigma, 36.0),
            row(&float, "q", 8.0, sigma, 32.0),
            row(&float, "r", 0.0, sigma, 39.0),
            row(&float, "r", 8.0, sigma, 37.0),
        ]);
        let latex = study.to_latex(&Made::by("edof study kodak"));
        let expected = "\\begin{tabular}{llrrrr}\n\\toprule\n\
             \x20&  & \\multicolumn{2}{c}{no noise} & \\multicolumn{2}{c}{$\\sigma = 0.01$} \\\\\n\
             method & camera & $\\psi = 8$ & average & $\\psi = 8$ & average \\\\\n\\midrule\n\
             demosaic-malvar & clear & $29.00$ & $29.00$ & -- & -- \\\\\n\
             n.float & clear & -- & -- & $33.00 \\pm 2.08$ & $34.67 \\pm 1.76$ \\\\\n\
             \\bottomrule\n\\end{tabular}\n";
        assert!(latex.ends_with(expected), "{latex}");
        assert!(latex.starts_with("% Made by `edof study kodak`"), "{latex}");
    }

    #[test]
    fn a_depth_in_a_head_has_two_decimals_at_most() {
        let study = Study::of(vec![row(&Method::demosaic(), "p", 7.123_456_789, Noise::None, 29.0)]);
        assert!(study.to_latex(&Made::by("edof study kodak")).contains("& $\\psi = 7.12$ & average"));
    }

    #[test]
    fn names_cannot_become_commands() {
        assert_eq!(escaped("a_b 50% \\x"), "a\\_b 50\\% \\textbackslash{}x");
    }
}
