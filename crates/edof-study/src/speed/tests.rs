use super::*;
use crate::journal::Proof;
use crate::summary::tests::row;

pub(crate) fn timed(method: &Method, image: &str, db: f64, seconds: f64) -> Row {
    let mut measured = row(method, image, 8.0, Noise::None, db);
    measured.seconds_per_megapixel = seconds;
    Row {
        measured,
        prepare_seconds: 0.5,
        repetitions: 3,
        iterations: (method.family == Family::Omp).then_some(16.0),
        peak_memory_bytes: Some(300 << 20),
        cpu_seconds_per_megapixel: (method.family == Family::Omp).then_some(1.5 * seconds),
        seconds_range: None,
        cpu_seconds_range: None,
        proof: Proof::default(),
    }
}

fn speed() -> Speed {
    let float = Method::network("n", Format::Float, 8, 4);
    let rows = [
        timed(&float, "a", 31.0, 0.1),
        timed(&float, "b", 33.0, 0.3),
        timed(&float.in_format(Format::Fixed), "a", 31.99, 0.2),
        timed(&float.in_format(Format::Board), "a", 31.99, 0.01),
        timed(&Method::of_patches(Family::Omp, 8), "a", 30.0, 6.0),
        timed(&Method::of_patches(Family::Omp, 8), "b", 31.0, 6.0),
        timed(&Method::of_patches(Family::Omp, 2), "a", 31.0, 60.0),
        timed(&Method::of_frames(Family::BlindDeconvolution), "a", 29.0, 120.0),
        timed(&Method::untrained(Family::Untrained, 8, 8), "a", 27.0, 0.2),
        timed(&Method::untrained(Family::Untrained, 8, 10), "a", 27.5, 0.3),
    ];
    Speed::new(&rows, "a machine".into()).unwrap()
}

#[test]
fn points_are_means_over_photographs() {
    let points = speed().points;
    let first = &points[0];
    assert_eq!((first.method.as_str(), first.photos, first.psnr_db), ("n.float/s8", 2, 32.0));
    assert!((first.seconds_per_megapixel - 0.2).abs() < 1e-12 && points.len() == 8);
}

#[test]
fn each_claim_of_the_paper_stands_beside_what_was_measured() {
    let page = speed().to_markdown(&Made::by("edof study single-depth"));
    for line in [
        "| n.float/s8 minus omp/s8 | at least 0 dB | +1.50 ± 0.50 dB |",
        "| n.float/s8 is faster than omp/s8 | more than 15 times | 30.0 times |",
        "| n.float/s8 minus blind-deconvolution | more than 1 dB | +2.00 dB |",
        "| n.float/s8 is faster than blind-deconvolution | more than 500 times | 600.0 times |",
        "| n.fixed/s8 minus n.float/s8 | the same | +0.99 dB |",
        "| n.board/s8 (by its cycles) is faster than omp/s8 | 280 times | 600.0 times |",
        "| n.board/s8 (by its cycles) is faster than blind-deconvolution | 900 times | 12000.0 times |",
        "| omp/s2 minus blind-deconvolution | more than 1 dB | +2.00 dB |",
        "| omp/s2 is faster than blind-deconvolution | about 30 times | 2.0 times |",
        "| untrained-t8.float/s8 minus untrained-t10.float/s8 | about 0 dB, of trained ones | -0.50 dB |",
    ] {
        assert!(page.contains(line), "{line}\n{page}");
    }
    assert!(!page.contains("untrained-t8.float/s8 minus omp"), "{page}");
    assert!(!page.contains("T = 8 minus T = 10"), "of networks that nobody asked for: {page}");
}

#[test]
fn the_diagram_joins_the_strides_of_a_method_and_tells_its_numbers() {
    let speed = speed();
    assert_eq!(
        speed.plot(&speed.claims[0]).series.iter().map(|s| s.points.len()).collect::<Vec<_>>(),
        [1, 1, 1, 2, 1, 2]
    );
    let html = speed.report("edof study single-depth").to_html();
    assert!(html.contains("<title>omp: 90, 31</title>"), "{html}");
    assert!(
        !html.contains("http://")
            || html.matches("http://").count() == html.matches("http://www.w3.org/2000/svg").count()
    );
}

#[test]
fn what_is_far_below_all_others_is_named_and_not_random_beyond_the_axes() {
    let untrained = |layers, db| timed(&Method::untrained(Family::Untrained, 8, layers), "a", db, 0.2);
    let net = timed(&Method::network("n", Format::Float, 8, 4), "a", 31.0, 0.1);
    let speed = Speed::new(&[net, untrained(8, 26.75), untrained(10, 7.0)], "m".into()).unwrap();
    let plot = speed.plot(&speed.claims[0]);
    let drawn: Vec<[f64; 2]> = plot.series.iter().flat_map(|series| series.points.clone()).collect();
    assert_eq!(drawn, [[0.1, 31.0], [0.2, 26.75]]);
    assert_eq!(plot.y.ends[0], Some(26.0), "a point that is drawn is above the end of its axis");
    let html = speed.report("edof study single-depth").to_html().replace('\u{a0}', " ");
    assert!(
        html.contains("Not in the diagram, which begins at 26 dB: untrained-t10.float/s8 (7.0 dB)."),
        "{html}"
    );
}

#[test]
fn a_paper_has_the_standard_errors_and_the_times_of_each_method() {
    let mut rows = vec![];
    for (noise, lost) in [(Noise::None, 0.0), (Noise::gaussian(0.01), 4.0)] {
        // 30, 32 and 37 dB: mean 33, standard error √(13/3).
        for (image, db) in [("a", 30.0), ("b", 32.0), ("c", 37.0)] {
            let mut row = timed(&Method::of_patches(Family::Omp, 8), image, db - lost, 6.0);
            row.measured.noise = noise;
            rows.push(row);
        }
    }
    rows.push(timed(&Method::demosaic(), "a", 29.0, 0.014));
    let latex = Speed::new(&rows, "a machine".into()).unwrap().to_latex(&Made::by("edof study single-depth"));
    let expected = "% Needs the package booktabs.\n\\begin{tabular}{lrrrr}\n\\toprule\n\
         \x20& \\multicolumn{2}{c}{$\\psi = 8$, no noise, real light} & \
         \\multicolumn{2}{c}{$\\psi = 8$, $\\sigma = 0.01$, real light} \\\\\n\
         method & dB & s/MP & dB & s/MP \\\\\n\\midrule\n\
         omp/s8 & $33.00 \\pm 2.08$ & $9.000$ & $29.00 \\pm 2.08$ & $9.000$ \\\\\n\
         demosaic-malvar & $29.00$ & $0.014^*$ & -- & -- \\\\\n\
         \\bottomrule\n\\end{tabular}\n";
    assert!(latex.ends_with(expected), "{latex}");
    assert!(latex.contains("% PSNR in dB") && latex.contains("on a machine."), "{latex}");
}

#[test]
fn a_depth_in_a_latex_head_has_two_decimals_at_most() {
    let mut row = timed(&Method::demosaic(), "a", 29.0, 0.014);
    row.measured.psi = 7.123_456_789;
    let latex = Speed::new(&[row], "m".into()).unwrap().to_latex(&Made::by("edof study single-depth"));
    assert!(latex.contains("{$\\psi = 7.12$, no noise, real light}"), "{latex}");
}

#[test]
fn a_time_that_is_no_cpu_time_is_marked_in_a_paper_that_has_both() {
    let row = timed(&Method::demosaic(), "a", 29.0, 0.5);
    let omp = timed(&Method::of_patches(Family::Omp, 8), "a", 31.0, 6.0);
    let latex =
        |rows: &[Row]| Speed::new(rows, "m".into()).unwrap().to_latex(&Made::by("edof study single-depth"));
    let both = latex(&[omp, row.clone()]);
    assert!(both.contains("^*$") && both.contains("with *: wall-clock seconds; on m."), "{both}");
    assert_eq!(both.matches("^*$").count(), 1);
    assert!(!latex(&[row]).contains('*'));
}
