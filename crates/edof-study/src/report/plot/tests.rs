use super::*;

fn plot(x: Axis, points: &[[f64; 2]]) -> Plot {
    Plot {
        title: "a < b".into(),
        x,
        y: Axis::linear("y"),
        size: USUAL,
        series: vec![Series::new("one", Mark::Line, points.iter().copied())],
    }
}

#[test]
fn a_point_that_is_not_finite_interrupts_the_line() {
    let svg = plot(Axis::linear("x"), &[[0.0, 0.0], [1.0, f64::NAN], [2.0, 1.0], [3.0, 2.0]]).to_svg();
    let path = svg.lines().find(|l| l.contains("class=\"line\"") && l.contains('L')).unwrap();
    assert_eq!(path.matches('M').count(), 2, "{path}");
    assert!(!svg.contains("NaN"));
}

#[test]
fn names_beside_points_cover_neither_points_nor_each_other() {
    // Three crowded points and one apart.
    let at = [[1.0, 1.0], [1.1, 1.0], [1.0, 1.05], [5.0, 3.0]];
    let named = |(i, point): (usize, &[f64; 2])| {
        Series::new(format!("method {i}"), Mark::Points, [*point]).named_at_points()
    };
    let plot = Plot {
        series: at.iter().enumerate().map(named).collect(),
        ..plot(Axis::linear("x").from(0.0).to(6.0), &[])
    };
    let svg = plot.to_svg();
    let number = |line: &str, name: &str| -> f64 {
        line.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
    };
    let names: Vec<Area> = svg
        .lines()
        .filter(|line| line.contains("class=\"name\""))
        .map(|line| {
            let [x, y] = ["x", "y"].map(|name| number(line, &format!(" {name}")));
            let width = "method 0".len() as f64 * LETTER[0];
            let share = match line.split("text-anchor=\"").nth(1).unwrap().split('"').next().unwrap() {
                "start" => 0.0,
                "middle" => 0.5,
                "end" => 1.0,
                other => panic!("{other}"),
            };
            let x = x - share * width;
            Area { x: [x, x + width], y: [y + 3.0 - LETTER[1], y + 3.0] }
        })
        .collect();
    assert_eq!(names.len(), 4);
    let dots: Vec<Area> = svg
        .lines()
        .filter(|line| line.starts_with("<circle"))
        .map(|line| Area::around(["cx", "cy"].map(|name| number(line, &format!(" {name}"))), 3.0))
        .collect();
    assert_eq!(dots.len(), 4);
    for (i, name) in names.iter().enumerate() {
        let others = names.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, other)| other);
        assert!(others.chain(&dots).all(|other| name.shared(other) < 1.0), "{name:?} {svg}");
    }
    assert_eq!(svg.matches("method 0").count(), 2, "its name and what hovering tells: none in the legend");
}

#[test]
fn a_name_left_of_its_point_ends_at_it_whatever_the_font() {
    // A point at the right end: there is no room but on its left.
    let plot = Plot {
        series: vec![Series::new("a long name", Mark::Points, [[1.0, 1.0]]).named_at_points()],
        ..plot(Axis::linear("x").from(0.0).to(1.0), &[])
    };
    let svg = plot.to_svg();
    let dot = svg.lines().find(|line| line.starts_with("<circle")).unwrap();
    let name = svg.lines().find(|line| line.contains("class=\"name\"")).unwrap();
    let x = |line: &str, name: &str| -> f64 {
        line.split(name).nth(1).unwrap().split('"').nth(1).unwrap().parse().unwrap()
    };
    assert!(name.contains("text-anchor=\"end\""), "{name}");
    assert!((x(dot, " cx=") - x(name, " x=") - 6.0).abs() < 0.2, "{dot} {name}");
}

#[test]
fn a_name_is_right_of_its_point_wherever_there_is_room() {
    // Places whose sums of fractions differ by rounding.
    let points = (0..60).map(|i| [0.37 + 1.617_3 * f64::from(i % 6), 0.11 + 2.731_7 * f64::from(i)]);
    for point in points {
        let plot = Plot {
            series: vec![Series::new("fista-known", Mark::Points, [point]).named_at_points()],
            ..plot(Axis::linear("x").from(-3.0).to(30.0), &[])
        };
        let svg = Plot { y: Axis::linear("y").from(-10.0).to(200.0), ..plot }.to_svg();
        let name = svg.lines().find(|line| line.contains("class=\"name\"")).unwrap();
        let dot = svg.lines().find(|line| line.starts_with("<circle")).unwrap();
        let number = |line: &str, name: &str| -> f64 {
            line.split(name).nth(1).unwrap().split('"').nth(1).unwrap().parse().unwrap()
        };
        assert!(name.contains("text-anchor=\"start\""), "{name}");
        assert!((number(name, " y=") - number(dot, " cy=")).abs() < 5.0, "{dot} {name}");
    }
}

#[test]
fn a_logarithmic_axis_of_few_decades_ends_near_its_data() {
    let svg = plot(Axis::log("x"), &[[0.65, 0.0], [0.9, 1.0]]).to_svg();
    assert!(
        svg.contains(">0.5</text>") && svg.contains(">1</text>") && !svg.contains(">0.1</text>"),
        "{svg}"
    );
}

#[test]
fn a_legend_that_would_take_much_of_the_width_stands_below() {
    let named = |label: &str| {
        let one = Series::new(label, Mark::Line, [[0.0, 1.0], [1.0, 2.0]]);
        Plot { series: vec![one; 3], ..plot(Axis::linear("x"), &[]) }
    };
    assert_eq!(named("short").whole_size(), USUAL);
    // Two beside each other, and one more.
    let long = named(&"l".repeat(30));
    assert_eq!(long.whole_size(), [640.0, 400.0 + 2.0 * LINE_HEIGHT]);
    assert!(long.to_svg().contains("viewBox=\"0 0 640 436\""));
    let texts = long.to_svg();
    let heights =
        texts.lines().filter(|line| line.contains("lll")).map(|line| line.split(" y=\"").nth(1).unwrap());
    assert_eq!(
        heights.map(|rest| rest.split('"').next().unwrap()).collect::<Vec<_>>(),
        ["404.0", "404.0", "422.0"]
    );
}

#[test]
fn a_legend_that_is_higher_than_its_plot_stands_below() {
    let series: Vec<Series> =
        (0..18).map(|i| Series::new(format!("{i}"), Mark::Line, [[0.0, 1.0]])).collect();
    let of = |count: usize| Plot { series: series[..count].to_vec(), ..plot(Axis::linear("x"), &[]) };
    // 400 pixels less title and axis are room for 17 lines.
    assert_eq!(of(17).whole_size(), USUAL);
    assert_eq!(of(18).whole_size(), [640.0, 400.0 + 3.0 * LINE_HEIGHT]);
}

#[test]
fn a_grid_has_one_legend_below_all() {
    let one = Plot { size: SMALL, ..plot(Axis::linear("x"), &[[0.0, 1.0]]) };
    let all = grid(&vec![one.clone(); 5], 3);
    assert!(all.contains("viewBox=\"0 0 1200 627\"") && all.contains("translate(400 300)"), "{all}");
    assert_eq!(all.matches(&format!(">{}</text>", escape(&one.series[0].label))).count(), 1, "{all}");
}

#[test]
fn diagrams_below_each_other_are_as_high_as_all() {
    let one = plot(Axis::linear("x"), &[[0.0, 1.0]]);
    let both = stacked(&[one.clone(), Plot { size: [700.0, 300.0], ..one }]);
    assert!(both.contains("viewBox=\"0 0 700 700\"") && both.contains("translate(0 400)"), "{both}");
}

#[test]
fn zero_is_not_random_on_a_logarithmic_axis() {
    let svg = plot(Axis::log("x"), &[[0.0, 1.0], [1.0, 1.0], [10.0, 2.0]]).to_svg();
    assert!(!svg.contains("inf") && !svg.contains("NaN"));
}

#[test]
fn text_is_escaped_and_empty_plots_are_random() {
    let svg = plot(Axis::linear("x"), &[]).to_svg();
    assert!(svg.contains("a &lt; b") && !svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn a_long_title_and_the_last_number_of_an_axis_are_whole() {
    let drawn = |title: &str| {
        let plot = Plot {
            title: title.into(),
            size: SMALL,
            ..plot(Axis::log("x").from(100.0).to(10_000.0), &[[100.0, 0.0], [10_000.0, 1.0]])
        };
        plot.to_svg()
    };
    let title = "a title that is far longer than its small diagram is";
    let long = drawn(title);
    let size: f64 =
        long.split("style=\"font-size:").nth(1).unwrap().split("px").next().unwrap().parse().unwrap();
    let width = title.len() as f64 * BOLD * size / TITLE;
    assert!((LEFT + width) <= SMALL[0] && width > 0.95 * (SMALL[0] - LEFT - 6.0), "{size} {width}");
    // A stated length would stretch a title whose letters are narrow.
    assert!(!long.contains("textLength"), "{long}");
    let short = drawn("a title");
    assert!(!short.contains("style=\"font-size"), "{short}");
    let last = short.lines().find(|line| line.contains(">10000</text>")).unwrap();
    let x: f64 = last.split("<text x=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
    assert!(x + 0.5 * 5.0 * LETTER[0] <= SMALL[0], "{last}");
}

#[test]
fn a_name_stands_before_lines_that_pass_below_it() {
    let series = Series::new("8 (default)", Mark::LineAndPoints, [[0.0, 0.0], [1.0, 1.0]]).named_at_points();
    let svg = Plot { series: vec![series], ..plot(Axis::linear("x"), &[]) }.to_svg();
    let name = svg.lines().find(|line| line.contains("class=\"name\"")).unwrap();
    assert!(name.contains("stroke=\"#fff\"") && name.contains("paint-order=\"stroke\""), "{name}");
}
