//! docs/host.md says of registers what the program does.

use edof_device::Design;
use edof_device::design::memory::{Set, Shifts, Space, address, writes};
use edof_device::registers::markdown;
use edof_network::FixedNetwork;
use edof_network::network::{Form, Recurrence};
use std::collections::BTreeMap;
use std::path::Path;

#[test]
fn the_register_map_of_the_page_is_the_programs() {
    let page = include_str!("../../../../docs/host.md");
    let (_, rest) = page.split_once("<!-- registers -->\n").unwrap();
    let (found, _) = rest.split_once("<!-- end -->").unwrap();
    let expected = markdown::page().replace("# Registers\n\n", "").replace("\n## ", "\n### ");
    assert_eq!(found, expected, "docs/host.md: must have between its marks:\n{expected}");
}

/// Address of a word of the window `weights`: stage, space, bank, row, half.
fn index(stage: usize, space: usize, bank: usize, row: usize, half: usize) -> u32 {
    (stage << 21 | space << 19 | bank << 13 | row << 1 | half) as u32
}

/// Every word of a set and where it belongs, from the table of the page alone.
fn by_the_page(design: &Design, network: &FixedNetwork, set: usize) -> BTreeMap<u32, u32> {
    let pixels = design.form.window.pixels();
    let (codes, last) = (design.form.codes, design.stages.len() - 1);
    let mut words = BTreeMap::new();
    for (stage, size) in design.stages.iter().enumerate() {
        let (lanes, rows) = (size.lanes, size.rows);
        let outputs = if stage == last { 128 } else { codes };
        let inputs = match stage {
            0 => pixels / rows,
            stage if stage == last && design.form.linear_path => codes + pixels,
            _ => codes,
        };
        let of_set = inputs * outputs / lanes;
        let mut put = |output: usize, input: usize, part: usize, bits: usize, weight: i16| {
            let row = set * of_set + output / lanes * inputs + input;
            let (bank, half) = (output % lanes / 4, output % 4 / 2);
            let word = words.entry(index(stage, 0, bank, (row << bits) + part, half)).or_default();
            *word |= u32::from(weight as u16) << (16 * (output % 2));
        };
        for output in 0..outputs {
            if stage == 0 {
                let bits = (rows - 1).checked_ilog2().map_or(0, |bits| bits as usize + 1);
                for pixel in 0..pixels {
                    let (part, k) = (pixel / inputs, pixel % inputs);
                    put(output, k, part, bits, network.analysis.weights[[output, pixel]]);
                }
                continue;
            }
            let matrix =
                if stage == last { &network.dictionary } else { network.recurrent_matrix(stage - 1) };
            (0..codes).for_each(|code| put(output, code, 0, 0, matrix.weights[[output, code]]));
            if let Some(linear) = network.linear_path.as_ref().filter(|_| stage == last) {
                (0..pixels).for_each(|j| put(output, codes + j, 0, 0, linear.weights[[output, j]]));
            }
        }
        let mut thresholds = |space: usize, of: usize| {
            for (output, theta) in network.thresholds[of].iter().enumerate() {
                let word = words.entry(index(stage, space, 0, (set * outputs + output) / 2, 0)).or_default();
                *word |= u32::from(*theta as u16) << (16 * (output % 2));
            }
        };
        if stage != last {
            thresholds(1, stage);
        }
        if stage > 0 && stage + 1 < last && design.form.recurrence == Recurrence::Difference {
            thresholds(2, stage - 1);
        }
        let shifts = Shifts::of(network, &design.stage(stage));
        let word = shifts.result | shifts.base << 6 | shifts.code << 12 | shifts.linear << 16;
        words.insert(index(stage, 3, 0, set, 0), word);
    }
    words
}

/// A client that knows the page alone writes what the program writes, word for word.
#[test]
fn every_word_of_a_network_belongs_where_the_table_of_the_page_says() {
    let committed = ["tiny", "paper", "kc705"].map(|name| {
        let path = format!("{}/../../designs/{name}.json", env!("CARGO_MANIFEST_DIR"));
        Design::load(Path::new(&path)).unwrap()
    });
    let tiny = committed[0].clone();
    let form = Form { recurrence: Recurrence::Difference, linear_path: false, ..tiny.form };
    let difference = Design { name: "difference".into(), form, ..tiny };
    for design in committed.into_iter().chain([difference]) {
        let network = edof_device::random::for_design(&design, 4);
        for set in [Set::First, Set::Second] {
            let expected: BTreeMap<u32, u32> = writes(&design, &network, set).into_iter().collect();
            let found = by_the_page(&design, &network, set as usize);
            let first = expected.iter().find(|(address, word)| found.get(*address) != Some(*word));
            assert_eq!(first, None, "{}, {set:?}", design.name);
            assert_eq!(found.len(), expected.len(), "{}", design.name);
        }
    }
    // The example of the page.
    assert_eq!(
        index(0, 0, 1, ((32 + 8) << 1) + 1, 0),
        address(0, Space::Weights { bank: 1, row: 81, half: 0 })
    );
}
