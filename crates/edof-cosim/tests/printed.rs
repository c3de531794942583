//! The style of what is printed (docs/verilog-style.md), and that it means what the kernels say word by word.

use crate::common::committed;
use edof_core::DisplayMode;
use edof_cosim::system::TableWords;
use edof_cosim::system::cables::PACE;
use edof_cosim::tool;
use edof_device::board::KC705;
use edof_device::registers::map::REGISTERS;
use edof_golden::{Curve, Display};
use edof_hdl::blocks::chain::Chain;
use edof_hdl::board::{Identity, Kc705Core, Pace};
use edof_hdl::describe::Circuit;
use edof_hdl::leaves::LEAVES;
use edof_hdl::project::spacious;
use edof_hdl::verilog::{EmitError, Emitted, Module, emit, emit_literally};
use rust_hdl::prelude::Block;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// No line is longer.
const COLUMNS: usize = 120;

/// A longer condition has a name.
const CONDITION: usize = 60;

fn chain(name: &str) -> Chain {
    let design = committed(name);
    let network = edof_device::random::for_design(&design, 1);
    let mut chain = Chain::checked(&design, [&network, &network]).unwrap();
    chain.connect_all();
    chain
}

/// Longer blocks stand once.
const TWICE: usize = 8;

/// A way to print a circuit.
type Way = fn(&dyn Circuit) -> Result<Emitted, EmitError>;

/// The board of a design, printed in several ways.
fn board<const N: usize>(name: &str, pace: &Pace, ways: [Way; N]) -> [Emitted; N] {
    let design = committed(name);
    let network = edof_device::random::for_design(&design, 1);
    let display = Display::new(DisplayMode::Colour, Curve::Srgb);
    spacious(|| {
        let words = TableWords::of(&display);
        let tables = words.tables();
        let identity = Identity { design_hash: 1, weights_hash: 2, frame: (64, 48) };
        let mut top = Kc705Core::new(&design, [&network, &network], &identity, &tables, pace).unwrap();
        top.connect_all();
        ways.map(|way| way(&top).unwrap())
    })
}

/// What in a module is not as the style says.
fn faults(module: &Module) -> Vec<String> {
    let Module { name, text, .. } = module;
    let mut faults = vec![];
    for (n, line) in text.lines().enumerate() {
        let at = format!("{name}.v:{}", n + 1);
        if line.len() > COLUMNS {
            faults.push(format!("{at}: {} columns", line.len()));
        }
        if line.trim_end().ends_with(": ;") {
            faults.push(format!("{at}: an arm that does nothing"));
        }
    }
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let one_by_one = lines.windows(2).filter(|pair| pair.iter().all(|line| clears(line)));
    faults.extend(one_by_one.map(|pair| format!("{name}.v: cleared one by one: {}", pair.concat())));
    let long: Vec<String> = conditions(text).into_iter().filter(|text| text.len() > CONDITION).collect();
    let twice = |(n, text): (usize, &String)| long[..n].contains(text).then(|| text.clone());
    let twice = long.iter().enumerate().filter_map(twice);
    faults.extend(twice.map(|text| format!("{name}.v: said twice: {text}")));
    faults.extend(copy(text).map(|line| format!("{name}.v: a block stands twice: {line}")));
    faults
}

/// Whether a line makes one register 0, and no more.
fn clears(line: &str) -> bool {
    let Some((register, value)) = line.split_once(" <= ") else { return false };
    let is_word = register.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
    let zero = value.split_once('\'').map(|(bits, digits)| (bits.parse::<usize>().is_ok(), digits));
    is_word && matches!(zero, Some((true, "b0;" | "d0;")))
}

/// The first line of a block that stands twice behind the ports, numbers left aside.
fn copy(text: &str) -> Option<String> {
    let body = text.split_once("\n);\n").map_or(text, |(_, body)| body);
    // Instances of one module are alike.
    let is_own = |line: &String| !line.is_empty() && !line.starts_with(['.', ')']);
    let plain: Vec<String> = body.lines().map(without_numbers).filter(is_own).collect();
    let blocks: Vec<&[String]> = plain.windows(TWICE + 1).collect();
    let stands_before = |n: usize| blocks[..n.saturating_sub(TWICE)].contains(&blocks[n]);
    (0..blocks.len()).find(|n| stands_before(*n)).map(|n| blocks[n][0].clone())
}

fn without_numbers(line: &str) -> String {
    line.trim()
        .split(|c: char| c.is_ascii_digit())
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("#")
}

/// What stands in the brackets of every `if`, on one line.
fn conditions(text: &str) -> Vec<String> {
    let plain = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    let plain = plain.collect::<Vec<_>>().join(" ");
    let starts = plain.match_indices("if (").map(|(at, found)| at + found.len());
    starts.map(|start| plain[start..start + closing(&plain[start..])].to_string()).collect()
}

/// Where the bracket closes that is open at the start.
fn closing(text: &str) -> usize {
    let mut open = 1;
    text.find(|letter| {
        open += i32::from(letter == '(') - i32::from(letter == ')');
        open == 0
    })
    .unwrap()
}

fn assert_styled(emitted: &Emitted) {
    let faults: Vec<String> = emitted.modules.iter().flat_map(faults).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_module_is_printed_in_style() {
    for design in ["tiny", "paper", "kc705"] {
        assert_styled(&emit(&chain(design)).unwrap());
    }
    let [board] = board("kc705", &Pace::of(&KC705), [emit]);
    assert_styled(&board);
    let text = |name: &str| &board.modules.iter().find(|module| module.name == name).unwrap().text;
    for (module, words) in [
        ("board_registers", "ADDR_INPUT_FRAMES: found_1_q <= input_frames_i;"),
        ("chip_setup", " MILLISECOND = CLOCK_HZ / 1000 - 2"),
        ("i2c_master", " QUARTER = CLOCK_HZ / 400_000 - 2"),
        ("i2c_master", " HOLD = CLOCK_HZ / 250"),
        ("uart_bus", " TIME_OUT = CLOCK_HZ / 10"),
        ("video_in", " MAX_WAIT = 4 * FRAME_CYCLES"),
    ] {
        assert!(text(module).contains(words), "{module}: {words}");
    }
    for (name, register) in REGISTERS.iter().map(|register| (register.name.to_uppercase(), register)) {
        let words = format!("ADDR_{name} = 6'd{}", register.address / 4);
        assert!(text("board_registers").contains(&words), "{words}");
    }
}

#[test]
fn no_block_stands_twice_in_what_is_written_by_hand() {
    let folder = crate::common::root().join("rtl");
    let files = [folder.clone(), folder.join("ecp5")]
        .map(|folder| fs::read_dir(folder).unwrap())
        .into_iter()
        .flatten();
    let texts =
        files.map(|file| file.unwrap().path()).filter(|path| path.extension().is_some_and(|end| end == "v"));
    let found =
        texts.map(|path| (path.clone(), copy(&fs::read_to_string(path).unwrap()))).collect::<Vec<_>>();
    assert!(found.len() > LEAVES.len(), "leaves and the board's top");
    assert!(found.iter().all(|(_, copy)| copy.is_none()), "{found:?}");
}

#[test]
fn lines_arms_and_conditions_out_of_style_are_found() {
    let long = "a_signal_of_some_length && (another_signal_of_some_length || !a_third_one)";
    let text = format!(
        "case (x)\n  default: ;\nendcase\nif ({long}) y = 1;\nelse if ({long}) y = 2;\n{:130};\n",
        "assign z = "
    );
    let found = faults(&Module { name: "m".into(), text, source: edof_hdl::verilog::SourceMap::default() });
    assert_eq!(found.len(), 3, "{found:?}");
    let block =
        |n: usize| (0..9).map(move |row| format!("word_{n}_q <= line_{}_i;\n", ["a"; 9][..=row].join("")));
    let copied: String = block(1).chain(block(2)).collect();
    assert_eq!(copy(&copied).as_deref(), Some("word_#_q <= line_a_i;"));
    assert_eq!(copy(&copied[..copied.len() - 30]), None);
    assert!(
        found[0].contains("m.v:2") && found[1].contains("m.v:6: 131") && found[2].contains("a_third_one")
    );
}

#[test]
fn blocks_name_the_rust_line_that_they_come_from() {
    let emitted = emit(&chain("tiny")).unwrap();
    for module in &emitted.modules {
        let rust = fs::read_to_string(crate::common::root().join(&module.source.file)).unwrap();
        let rust: Vec<&str> = rust.lines().collect();
        for (line, place) in module.text.lines().zip(&module.source.lines) {
            let Some(place) = place else {
                assert!(!line.contains("always"), "{}: {line}", module.name);
                continue;
            };
            let code = rust[place - 1].trim();
            let is_statement =
                ["self.", "if ", "for ", "match ", "dff_setup"].iter().any(|word| code.starts_with(word));
            let is_link = code.contains("::link") || code.contains("::join");
            // Resets come from an attribute of the struct.
            let resets = ["Reset.", "reset", " <= ", "_q,"].iter().any(|word| line.contains(word));
            let is_reset = code.contains("registers(") && (resets || line.trim() == "end");
            assert!(is_statement || is_link || is_reset, "{}: {line}: line {place} is {code}", module.name);
        }
        assert!(module.source.lines.iter().any(Option::is_some), "{}", module.name);
    }
}

/// The heads of all leaves: a box needs no more, and bodies read memory images.
fn leaf_texts() -> impl Iterator<Item = (&'static str, String)> {
    let head = |text: &'static str| &text[..text.find("\n);").unwrap() + 3];
    LEAVES.iter().map(move |(name, text)| (*name, format!("{}\nendmodule\n", head(text))))
}

/// Proves by Yosys that modules of one name are equal, registers by their names. Instances are boxes with inputs and outputs.
fn prove_equal(one: &Emitted, other: &Emitted) {
    let dir = tempfile::tempdir().unwrap();
    for (folder, emitted) in [("gold", one), ("gate", other)] {
        fs::create_dir(dir.path().join(folder)).unwrap();
        for module in &emitted.modules {
            fs::write(dir.path().join(format!("{folder}/{}.v", module.name)), &module.text).unwrap();
        }
    }
    for (name, text) in leaf_texts() {
        fs::write(dir.path().join(format!("{name}.v")), text).unwrap();
    }
    let names: Vec<&str> = one.modules.iter().map(|module| module.name.as_str()).collect();
    assert_eq!(names, other.modules.iter().map(|module| module.name.as_str()).collect::<Vec<_>>());
    let leaves: Vec<String> = leaf_texts().map(|(name, _)| format!("{name}.v")).collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
                    prove(dir.path(), name, &names, &leaves);
                }
            });
        }
    });
}

fn prove(dir: &Path, name: &str, names: &[&str], leaves: &[String]) {
    let others = names.iter().filter(|other| *other != &name).map(|other| format!("gate/{other}.v"));
    let boxes: Vec<String> = others.chain(leaves.iter().cloned()).collect();
    let side =
        |side: &str| format!("read_verilog {side}/{name}.v; proc -norom; opt_clean; rename {name} {side}; ");
    let script = format!(
        "read_verilog -lib {}; {}{}equiv_make gold gate equal; opt_clean; \
         equiv_struct; equiv_simple; equiv_induct -seq 4; equiv_status -assert",
        boxes.join(" "),
        side("gold"),
        side("gate")
    );
    let done = tool::output(tool::command("yosys", dir).args(["-q", "-p", &script])).unwrap();
    assert!(done.status.success(), "{name}: {}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn what_is_printed_equals_what_the_kernels_say() {
    let chain = chain("tiny");
    prove_equal(&emit_literally(&chain).unwrap(), &emit(&chain).unwrap());
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn what_is_printed_of_kc705_equals_what_the_kernels_say() {
    let chain = chain("kc705");
    prove_equal(&emit_literally(&chain).unwrap(), &emit(&chain).unwrap());
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn what_is_printed_of_the_board_equals_what_the_kernels_say() {
    let [literal, printed] = board("tiny", &PACE, [emit_literally, emit]);
    prove_equal(&literal, &printed);
}

#[test]
fn a_module_that_computes_something_else_is_not_proven_equal() {
    let chain = chain("tiny");
    let (one, mut other) = (emit_literally(&chain).unwrap(), emit(&chain).unwrap());
    let drain = other.modules.iter_mut().find(|module| module.name == "drain").unwrap();
    let changed = drain.text.replacen(" && ", " || ", 1);
    assert!(changed != drain.text);
    drain.text = changed;
    let keep = |emitted: Emitted| Emitted {
        modules: emitted.modules.into_iter().filter(|module| module.name == "drain").collect(),
        ..emitted
    };
    let (one, other) = (keep(one), keep(other));
    assert!(std::panic::catch_unwind(|| prove_equal(&one, &other)).is_err());
}
