//! The memory's agents after resets at any moment: frames are whole, counters begin at zero, and no buffer is read.

use crate::agents::{Rig, frame, frames, source};
use edof_core::draw::Draw;
use edof_cosim::bench::{Behaviour, Coupling};
use edof_cosim::{Error, Source};

/// Frames, a reset of the agents (with `memory_too`, of the memory) at a random moment, and the same frames once more.
fn reset_in_between(source: &Source, behaviour: Behaviour, seed: u64, memory_too: bool) -> Result<(), Error> {
    let mut rig = Rig::new(source, behaviour, seed)?;
    let draw = &mut Draw::new(seed);
    for number in 1..20 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
    }
    rig.steps(draw.whole(1, 6_000) as usize)?;
    let cycles = draw.whole(1, 5) as usize;
    if memory_too {
        rig.reset_all(cycles)?
    } else {
        rig.reset(cycles)?
    }
    rig.receivers.iter_mut().for_each(|receiver| receiver.beats.clear());
    for number in 20..24 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
    }
    rig.finish()?;
    rig.steps(40_000)?;
    for set in 0..2 {
        let received = rig.numbers(set).map_err(|torn| Error::Stopped(format!("frame {torn} is torn")))?;
        if !received.is_sorted() || received.last() != Some(&23) {
            return Err(Error::Stopped(format!("seed {seed}: {received:?}")));
        }
    }
    Ok(())
}

#[test]
fn after_a_reset_at_any_moment_frames_are_whole_again() {
    let source = source();
    for seed in 0..12 {
        let coupling = [Coupling::Free, Coupling::AddressWaits, Coupling::DataWaits][seed as usize % 3];
        let behaviour = if seed % 2 == 0 { Behaviour::hard(seed) } else { Behaviour::starving(seed) };
        reset_in_between(&source, Behaviour { coupling, ..behaviour }, seed, seed % 4 == 3).unwrap();
    }
}

#[test]
fn after_a_reset_no_buffer_is_read_and_the_first_one_is_written() {
    let mut rig = Rig::new(&source(), Behaviour::ideal(), 5).unwrap();
    for set in [0, 1, 0] {
        rig.senders[set].beats.extend(frame(1));
        let asks = (0..10_000).any(|_| {
            rig.steps(1).unwrap();
            rig.count("dram_write_aw_valid_o") == 1
        });
        assert!(asks, "no burst of set {set}");
        assert_eq!(rig.count("dram_write_aw_addr_o"), u64::from(frames(set as u32).buffers[0]));
        rig.senders[set].beats.clear();
        rig.reset_all(20).unwrap();
    }
}

#[test]
fn an_error_that_comes_with_a_reset_is_not_counted() {
    let mut rig = Rig::new(&source(), Behaviour { read_errors: [1000; 2], ..Behaviour::ideal() }, 6).unwrap();
    let (draw, mut errors) = (&mut Draw::new(6), 0);
    for number in 0..200 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
        rig.steps(draw.whole(300, 900) as usize).unwrap();
        errors += rig.count("read_errors_o");
        rig.reset(1).unwrap();
        rig.steps(2).unwrap();
        assert_eq!(rig.count("read_errors_o"), 0);
    }
    assert!(errors > 1_000, "{errors}");
}
