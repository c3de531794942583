//! project/reports.tcl on reports in the form of several Vivado versions (sim/vivado/reports).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Reports with their readers, and words of the violation that is injected in `VERSION.violation.rpt`.
const REPORTS: [(&str, &str, &str); 8] = [
    (
        "check_timing",
        "timing_violations $text $excepted",
        "no_output_delay: hdmi_tx_data[3]: ports with no output delay specified",
    ),
    (
        "bus_skew",
        "skew_violations $text 2",
        "bus 2 from core/screen/frames/read_gray_q_reg[0]: slack -0.433 ns",
    ),
    (
        "pulse_width",
        "pulse_violations $text",
        "screen_clock: Min Period at core/screen/frames/words_reg/CLKARDCLK: slack -0.183 ns",
    ),
    (
        "cdc",
        "crossing_violations $text",
        "CDC-10: Combinatorial logic detected before a synchronizer: from core/screen/busy_q_reg/C to core/screen/swap/to_sender/first_q_reg[0]/D",
    ),
    (
        "methodology",
        "rule_violations $text {Report Methodology} {}",
        "TIMING-6#1: The clocks screen_clock and memory_clock are timed together but have no common primary clock",
    ),
    (
        "drc",
        "rule_violations $text {Report DRC} {}",
        "NDRV-1#1: Net core/screen/late has no driver\nPLCK-12#1: Sub-optimal placement of hdmi_rx_clk",
    ),
    ("clock_interaction", "clock_violations $text", "from screen_clock to hdmi_rx: Timed (unsafe)"),
    ("utilization", "utilization_violations $text", "DSPs: 852 of 840 are used\nblack box edof_window"),
];

/// Folder with one folder for each report.
pub fn folder() -> PathBuf {
    root().join("sim/vivado/reports")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Forms of a report: the version and the text without a violation.
fn forms(report: &str) -> Vec<(String, String)> {
    let files = fs::read_dir(folder().join(report)).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    files
        .filter(|path| !name(path).ends_with(".violation.rpt"))
        .map(|path| (name(&path).trim_end_matches(".rpt").to_owned(), fs::read_to_string(&path).unwrap()))
        .collect()
}

/// Reads one text: the violations, one in a line, or the error.
fn read(reader: &str, text: &str) -> Result<String, String> {
    let script = format!(
        "source {root}/project/reports.tcl
        set channel [open {root}/constraints/kc705.xdc]
        set excepted [excepted_ports [read $channel]]
        set text [read stdin]
        if {{[catch {{{reader}}} found]}} {{ puts -nonewline stderr $found; exit 1 }}
        puts -nonewline [join $found \"\\n\"]",
        root = root().display()
    );
    let place = crate::board::Place::new();
    fs::write(place.path("read.tcl"), script).unwrap();
    fs::write(place.path("text.rpt"), text).unwrap();
    let mut tclsh = Command::new("tclsh");
    tclsh.arg(place.path("read.tcl")).stdin(fs::File::open(place.path("text.rpt")).unwrap());
    let output = tclsh.output().unwrap();
    let words = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    if output.status.success() { Ok(words(output.stdout)) } else { Err(words(output.stderr)) }
}

#[test]
fn every_report_without_a_violation_passes_and_with_one_fails_in_two_versions() {
    for (report, reader, violation) in REPORTS {
        let forms = forms(report);
        assert!(forms.len() >= 2, "{report}: {} versions", forms.len());
        for (version, clean) in forms {
            assert_eq!(read(reader, &clean), Ok(String::new()), "{report} {version}");
            let file = folder().join(report).join(format!("{version}.violation.rpt"));
            assert_eq!(
                read(reader, &fs::read_to_string(file).unwrap()),
                Ok(violation.into()),
                "{report} {version}"
            );
        }
    }
}

#[test]
fn an_empty_report_and_a_header_alone_are_errors() {
    for (report, reader, _) in REPORTS {
        for (version, clean) in forms(report) {
            assert!(read(reader, "").is_err(), "{report}: an empty text");
            let title = clean.rfind("| Speed File").unwrap();
            assert!(read(reader, &clean[..title]).is_err(), "{report} {version}: a header alone");
        }
    }
}

/// Replaces words in every form of a report and expects an error or a violation with these words.
fn changed(report: &str, from: &str, to: &str, words: &str) {
    let (_, reader, _) = REPORTS.into_iter().find(|(name, _, _)| *name == report).unwrap();
    for (version, clean) in forms(report) {
        let text = clean.replace(from, to);
        assert_ne!(text, clean, "{report} {version}: '{from}' is not in the report");
        let (Ok(found) | Err(found)) = read(reader, &text);
        assert!(found.contains(words), "{report} {version}: '{words}' is not in '{found}'");
    }
}

#[test]
fn a_changed_line_of_a_report_is_noticed() {
    for (report, from, to, words) in [
        // Ports and pins that the constraints do not except.
        (
            "check_timing",
            "\nleds[0]\n",
            "\nleds_[0]\n",
            "no_output_delay: leds_[0]: ports with no output delay but user has",
        ),
        (
            "check_timing",
            "\nhdmi_tx_clk\n",
            "\nuart_tx\n",
            "no_output_delay: uart_tx: port with no output delay but with a timing",
        ),
        ("check_timing", "\nfan_pwm\n", "\n", "counts 16 ports and lists 15"),
        ("check_timing", "\nuart_rx\n", "\nuart_rx\nsomething else\n", "counts 6 ports and lists 7"),
        (
            "check_timing",
            " There are 0 register/latch pins with no clock.",
            " There is 1 register/latch pin with no clock driven by root clock pin: x/Q (HIGH)\n\ny/C",
            "no_clock",
        ),
        (
            "check_timing",
            " There are 0 combinational loops in the design.",
            " No loops.",
            "has an unknown form: 'No loops.'",
        ),
        (
            "check_timing",
            "\n9. checking loops",
            "\n9. checking rings",
            "the section 'checking loops' is missing",
        ),
        ("bus_skew", "\n2   44", "\n3   44", "has an unknown form: '3   44"),
        ("bus_skew", "5.763\n2", "5,763\n2", "has an unknown form: '2   44"),
        (
            "bus_skew",
            "1. Bus Skew Report Summary\n-",
            "1. Summary\n-",
            "the section 'Bus Skew Report Summary' is missing",
        ),
        ("pulse_width", "Min Period ", "Min Width  ", "has an unknown form: 'Min Width"),
        ("pulse_width", "  3.929 ", "  -0.000 ", "sysclk: Min Period at clocks/CLKIN1: slack -0.000 ns"),
        ("cdc", "Info      1-bit", "Odd       1-bit", "has an unknown form"),
        ("cdc", "CDC-6  Warning       1", "CDC-6  Warning       2", "CDC-6 counts 2 crossings and lists 1"),
        ("methodology", "XDCB-5#1 Warning", "XDCB-5#1 Severe", "has an unknown form: 'XDCB-5#1 Severe'"),
        ("methodology", "XDCB-5#1 Warning", "", "XDCB-5: the table and the details differ by 1"),
        ("methodology", " found: 2", " found: 3", "3 violations were found, but the table counts others"),
        ("drc", " found: ", " seen: ", "the number of violations is missing"),
        ("clock_interaction", "Max Delay Datapath Only", "Anything else          ", "has an unknown form"),
        (
            "clock_interaction",
            "Inter-Clock",
            "Inner-Clock",
            "the column 'Inter-Clock Constraints' is missing",
        ),
        ("utilization", " 44.75 ", " -     ", "has an unknown form"),
        ("utilization", "9. Black Boxes\n-", "9. Boxes\n-", "the section 'Black Boxes' is missing"),
    ] {
        changed(report, from, to, words);
    }
}

#[test]
fn a_count_of_buses_that_differs_and_a_report_of_none_are_violations() {
    for (_, clean) in forms("bus_skew") {
        let words = "2 buses have a limit of their skew, expected 4";
        assert_eq!(read("skew_violations $text 4", &clean), Ok(words.into()));
    }
    let none = "Bus Skew Report\n\nNo bus skew constraints\n";
    let words = "0 buses have a limit of their skew, expected 4";
    assert_eq!(read("skew_violations $text 4", none), Ok(words.into()));
}

#[test]
fn a_tolerated_rule_is_no_violation() {
    for (version, _) in forms("methodology") {
        let file = folder().join("methodology").join(format!("{version}.violation.rpt"));
        let text = fs::read_to_string(file).unwrap();
        assert_eq!(read("rule_violations $text {Report Methodology} {TIMING-6}", &text), Ok(String::new()));
    }
}
