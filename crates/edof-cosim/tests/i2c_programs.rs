//! Random programs of the chips' set-up: what the chips get and what stays in the slots is the model's.

use crate::i2c::{Chips, Rig, modelled};
use edof_core::draw::Draw;
use edof_device::i2c::{Action, Entry};

/// Steps of every kind, then every slot and setting written out.
fn random_program(draw: &mut Draw) -> Vec<Entry> {
    // The index and the accumulator say nothing before they are set.
    let mut program = vec![Action::Index(0x80), Action::Load(12)];
    // What nobody answers is 0.
    program.extend([
        Action::ReadNext { device: 0x46 },
        Action::If { mask: 0xff, value: 0 },
        Action::Write { device: 0x45, register: 0x5c, value: 2 },
    ]);
    while program.len() < 100 {
        let [device, register, value, slot] =
            [0x40 + draw.whole(0, 3), draw.whole(0, 7), draw.whole(0, 255), draw.whole(0, 15)]
                .map(|n| n as u8);
        // A condition that holds about as often as not.
        let mask = 1 << draw.whole(0, 7);
        program.push(match draw.whole(0, 11) {
            0 => Action::Byte { device: 0x70, value },
            1 => Action::Write { device, register, value },
            2 => Action::Wait(draw.whole(1, 3) as u16),
            // One that holds for whatever was read.
            3 => Action::Until { tries: 1, mask: 0, value: 0 },
            4 => Action::If { mask, value: value & mask },
            5 => Action::Goto(program.len() as u16 + draw.whole(1, 3) as u16),
            6 => Action::Copy { device, register, slot },
            7 => Action::Load(slot),
            8 => Action::Store { value, slot },
            9 => Action::Index(value),
            10 => Action::ReadNext { device },
            _ => Action::Read { device, register, slot },
        });
        if draw.whole(0, 9) == 0 {
            program.extend([
                Action::Index([0xff, 0x10][draw.whole(0, 1) as usize]),
                Action::ReadNext { device },
                Action::More,
            ]);
        }
    }
    program.extend([Action::Wait(1); 4]);
    program.extend((0..16).map(|slot| Action::Copy { device: 0x44, register: slot, slot }));
    program.extend((0..12).map(|slot| Action::Store { value: 0x11 * slot, slot }));
    program.extend((0..16).flat_map(|slot| {
        [
            Action::Load(slot),
            Action::If { mask: 0xff, value: 0x11 * slot },
            Action::Write { device: 0x45, register: slot, value: 1 },
        ]
    }));
    program.push(Action::Done);
    program.into_iter().map(|action| Entry { action, doc: "try" }).collect()
}

#[test]
fn random_programs_are_carried_out_as_the_model_does() {
    for seed in 20..26 {
        let draw = &mut Draw::new(seed);
        let mut chips = Chips::default();
        chips.missing = vec![0x46];
        for (device, register) in
            (0x40..0x44).flat_map(|device| (0..=255).map(move |register| (device, register)))
        {
            chips.registers.insert((device, register), draw.bits() as u8);
        }
        let program = random_program(draw);
        let mut rig = Rig::new(&program, chips.clone(), seed);
        rig.done();
        let model = modelled(&program, chips, rig.wire.chips.log.len());
        assert_eq!(rig.wire.chips.log, model.bus.log, "program {seed}");
        let slots = [0, 1, 2].map(|i| rig.get(&format!("slots_{i}_o")) as u32);
        assert_eq!(slots, [0x3322_1100, 0x7766_5544, 0xbbaa_9988]);
    }
}

#[test]
fn no_chip_is_named_before_one_is_spoken_to() {
    let program = [Action::Wait(1), Action::Done].map(|action| Entry { action, doc: "speaks to nobody" });
    let mut rig = Rig::new(&program, Chips::default(), 30);
    rig.done();
    assert_eq!(rig.get("word_o") >> 10 & 0x7f, 0, "the device");
}
