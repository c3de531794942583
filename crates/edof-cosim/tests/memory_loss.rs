//! A memory that loses what it holds while the core continues.

use crate::edof_core::{Setup, burst_begins, design, is_whole_or_cut, shifts};
use crate::frame_checks::FrameChecks;
use edof_core::DisplayMode;
use edof_core::draw::Draw;
use edof_cosim::bench::Behaviour;
use edof_cosim::system::{Rig, drawn};
use edof_device::design::memory::Shifts;
use edof_golden::video::video_out::BLACK_PIXEL;

const LOSSES: usize = 20;

/// A memory that does not serve: the screen gets black, the host reaches the calculator.
fn stays_down(rig: &mut Rig, generated: u32) {
    rig.steps(5_000).unwrap();
    assert_eq!(rig.register("status").unwrap() & 1, 0, "a memory that is not ready");
    assert_eq!(shifts(rig, 1), generated, "the calculator can be reached");
    let before = rig.screen.frames.len();
    rig.show(2).unwrap();
    let (_, whole) = &rig.screen.frames[before + 1];
    assert!(whole.iter().all(|pixel| *pixel == BLACK_PIXEL));
}

/// A reset in the middle of bursts, short or long. What the memory held is gone, so no picture of before is shown.
#[test]
fn a_memory_that_is_lost_takes_its_frames_along_and_nothing_else() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let draw = &mut Draw::new(10);
    let frames = drawn(setup.design.frame, 7 * LOSSES, 10).unwrap();
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let checks = FrameChecks::new(&setup, &frames, 0, DisplayMode::Colour);
    let generated = Shifts::of(&setup.sets[1], &setup.design.stage(1)).word();
    let mut rig = setup.start(&frames, 10);
    rig.send(1).unwrap();
    rig.show(2).unwrap();
    for loss in 0..LOSSES as u64 {
        rig.memory.behaviour = match loss % 3 {
            0 => Behaviour::starving(loss),
            1 => Behaviour::hard(loss),
            _ => Behaviour::ideal(),
        };
        rig.steps(draw.whole(1, 10_000) as usize).unwrap();
        if loss % 2 == 1 {
            burst_begins(&mut rig, loss as usize / 2 % 4);
        }
        rig.bench.set("dram_ready_i", 0).unwrap();
        rig.steps(draw.whole(10, 100) as usize).unwrap();
        if loss % 5 == 0 {
            stays_down(&mut rig, generated);
        }
        rig.bench.set("dram_ready_i", 1).unwrap();
        rig.memory.behaviour = Behaviour::hard(loss);

        let sent = rig.camera.frame;
        rig.send(sent + 3).unwrap();
        rig.show(2).unwrap();
        let is_right = |frame: &Vec<u16>| is_whole_or_cut(frame, &pictures);
        assert!(rig.screen.frames.iter().all(|(_, frame)| is_right(frame)), "a torn picture");
        let (_, last) = rig.screen.frames.last().unwrap();
        assert!(pictures[sent + 1..].contains(last), "loss {loss}: no picture of a frame after {sent}");
        assert_eq!(rig.register("status").unwrap() & 1, 1);
        checks.hold(&mut rig, sent, &format!("loss {loss}"));
    }
}
