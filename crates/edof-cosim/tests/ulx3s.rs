//! The ULX3S' top between models of its PLL and of the core, and its folder: pins, lint, what the makers' file says.

use crate::board::{Place, project, run, said, written};
use crate::common::committed;
use edof_device::board::ULX3S;
use edof_hdl::board_project::BoardProject;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::LazyLock;

fn folder(place: &Place) -> PathBuf {
    static PROJECT: LazyLock<BoardProject> = LazyLock::new(|| project("ulx3s"));
    written(place, &PROJECT)
}

/// The top after an edit in Icarus, with its bench; what it says.
fn tried(edit: impl Fn(String) -> String) -> String {
    let place = Place::new();
    let folder = folder(&place);
    let picoseconds = |khz: u64| format!("{:.3}", 1e9 / khz as f64);
    let bench = include_str!("../../../sim/board/ulx3s_top_bench.sv")
        .replace("@core_ps@", &picoseconds(ULX3S.core_khz.into()))
        .replace("@calculator_ps@", &picoseconds(committed("ulx3s").clocks().unwrap().calculator.khz));
    std::fs::write(folder.join("top_bench.sv"), bench).unwrap();
    let top = folder.join("rtl/ulx3s_top.v");
    std::fs::write(&top, edit(std::fs::read_to_string(&top).unwrap())).unwrap();
    let files = ["top_bench.sv", "rtl/ulx3s_top.v", "rtl/edof_debounce.v", "rtl/edof_sync.v"];
    let arguments: Vec<&str> =
        ["-g2012", "-s", "ulx3s_top_bench", "-o", "top.vvp"].into_iter().chain(files).collect();
    let compiled = run("iverilog", &arguments, &folder);
    assert!(compiled.status.success(), "{}", said(&compiled));
    said(&run("vvp", &["-n", "top.vvp"], &folder))
}

#[test]
fn the_top_has_its_clocks_ends_its_resets_in_order_and_has_its_pins() {
    let told = tried(|text| text);
    assert!(told.contains("PASS: clocks, resets, pins"), "{told}");
}

#[test]
fn a_top_with_a_wrong_clock_reset_or_pin_is_found() {
    let feedback = ULX3S.clock(ULX3S.core_khz.into()).unwrap().settings;
    let feedback = feedback.multiply_eighths / feedback.output_eighths;
    for (right, wrong, complaint) in [
        (
            format!(".CLKFB_DIV({feedback})"),
            format!(".CLKFB_DIV({})", feedback - 1),
            "FAIL: clock 0 has a period of",
        ),
        ("button | !core_locked_seen".into(), "button".into(), "FAIL: the core's reset is over before"),
        (
            ".bit_clock_i(bit_clock)".into(),
            ".bit_clock_i(core_clock)".into(),
            "FAIL: clock 3 has a period of",
        ),
        (".uart_receive_i(ftdi_txd)".into(), ".uart_receive_i(ftdi_rxd)".into(), "FAIL: the serial line"),
        ("reset_q <= button |".into(), "reset_q <=".into(), "FAIL: FIRE1 resets the core alone"),
        (
            ".D0(1'b0), .D1(1'b1)".into(),
            ".D0(1'b1), .D1(1'b0)".into(),
            "FAIL: the SDRAM's clock is not inverted",
        ),
        (
            "sdram_ba, sdram_a, sdram_dqm}".into(),
            "sdram_dqm, sdram_a, sdram_ba}".into(),
            "FAIL: the SDRAM's address",
        ),
        (
            "camera_vsync, camera_href, camera_d}".into(),
            "camera_href, camera_vsync, camera_d}".into(),
            "FAIL: the camera's pins",
        ),
        (".SCLK(camera_pclk)".into(), ".SCLK(clk_25mhz)".into(), "FAIL: a register at the camera's pins"),
        (
            "assign camera_pwdn = !camera_on[0]".into(),
            "assign camera_pwdn = camera_on[0]".into(),
            "FAIL: the camera's pins before",
        ),
        (
            ".T(!bus_low[1]), .O(bus_level[1])".into(),
            ".T(!bus_low[1]), .O(bus_level[0])".into(),
            "FAIL: the camera's bus",
        ),
        (".T(!drive)".into(), ".T(drive)".into(), "FAIL: data from the SDRAM"),
    ] {
        let told = tried(|text| {
            assert!(text.contains(&right), "{right}");
            text.replacen(&right, &wrong, 1)
        });
        assert!(told.contains(complaint), "{told}");
    }
}

#[test]
fn every_pin_of_the_top_has_one_place() {
    let place = Place::new();
    let folder = folder(&place);
    let constraints = std::fs::read_to_string(folder.join("ulx3s.lpf")).unwrap();
    let of = |beginning: &str| -> Vec<[String; 2]> {
        let lines = constraints.lines().filter_map(|line| line.strip_prefix(beginning));
        lines.map(|line| [1, 3].map(|i| line.split('"').nth(i).unwrap_or("").to_owned())).collect()
    };
    let (located, levels) = (of("LOCATE COMP "), of("IOBUF PORT "));
    let names = |rows: &[[String; 2]]| rows.iter().map(|row| row[0].clone()).collect::<BTreeSet<_>>();
    let leds = (0..8).map(|i| format!("led[{i}]"));
    let leds = leds.chain((0..4).map(|i| format!("gpdi_dp[{i}]")));
    let others = ["clk_25mhz", "btn_fire1", "ftdi_txd", "ftdi_rxd", "wifi_gpio0"].map(String::from);
    let sdram = ["clk", "cke", "csn", "rasn", "casn", "wen"].map(|pin| format!("sdram_{pin}"));
    let buses = [("a", 13), ("ba", 2), ("dqm", 2), ("d", 16)];
    let sdram = sdram
        .into_iter()
        .chain(buses.into_iter().flat_map(|(bus, bits)| (0..bits).map(move |i| format!("sdram_{bus}[{i}]"))));
    let camera = ["xclk", "pclk", "vsync", "href", "pwdn", "resetn", "sioc", "siod"].map(String::from);
    let camera = camera.into_iter().chain((0..8).map(|i| format!("d[{i}]")));
    let camera = camera.map(|pin| format!("camera_{pin}"));
    let expected: BTreeSet<String> = leds.chain(others).chain(sdram).chain(camera).collect();
    assert_eq!((names(&located), names(&levels)), (expected.clone(), expected.clone()));
    let sites: BTreeSet<&String> = located.iter().map(|row| &row[1]).collect();
    assert_eq!(sites.len(), expected.len());
    let top = std::fs::read_to_string(folder.join("rtl/ulx3s_top.v")).unwrap();
    let ports = top.split_once("module ulx3s_top (").unwrap().1.split_once(");").unwrap().0;
    let declared = ports.lines().filter_map(|line| line.split_once("wire"));
    let declared =
        declared.flat_map(|(_, names)| names.split(',')).filter_map(|name| name.split_whitespace().last());
    let declared: BTreeSet<&str> = declared.collect();
    assert_eq!(declared, expected.iter().map(|name| name.split('[').next().unwrap()).collect());
}

#[test]
fn the_folder_is_clean_and_tries_itself() {
    let place = Place::new();
    let folder = folder(&place);
    let output = run("make", &["lint"], &folder);
    assert!(output.status.success(), "{}", said(&output));
    let output = run("make", &["sim"], &folder);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("PASS: 12 patches") && said(&output).contains("PASS: 5 pictures"));
}
