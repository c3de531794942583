//! The predicted time of a load.

use crate::common::{BAUD, board, job, network, open, retrained, tiny};
use edof_board::contents::parts;
use edof_board::dry_run::plan;
use edof_board::load::{Job, unwatched};
use edof_device::design::memory::Set;
use std::ops::ControlFlow;

#[test]
fn a_plan_is_what_the_load_takes() {
    let design = tiny();
    let [old, other] = [1, 2].map(|seed| network(&design, seed));
    let new = retrained(&old);
    let known = [old.clone()];
    for (network, full, known) in [(&other, true, &[][..]), (&new, false, &[][..]), (&new, false, &known[..])]
    {
        let mut simulated = board(&design, &old);
        let job = Job { full, known, ..job(&design, network) };
        let mut reader = open(&mut simulated);
        let wanted = parts(&design, network, Set::Second);
        let held = reader.crcs(&wanted.iter().collect::<Vec<_>>(), &mut unwatched).unwrap();
        let plan = plan(&job, Set::Second, Some(&held), BAUD).unwrap();
        let mut reader = open(&mut simulated);
        let (start, bytes) = (reader.line().now(), reader.line().bytes);
        let loaded = reader.load(&job, &mut |_, _| ControlFlow::Continue(())).unwrap();
        assert_eq!((plan.words, plan.written_parts), (loaded.words, loaded.written_parts));
        let seconds = (simulated.now() - start) as f64 * 1e-9;
        assert!((plan.seconds / seconds - 1.0).abs() < 0.01, "{plan:?} took {seconds} s");
        assert!((simulated.bytes[0] - bytes[0]).abs_diff(plan.bytes[0]) < 100, "{plan:?}");
    }
}

#[test]
fn a_plan_for_a_board_that_nobody_asked_is_of_all_words() {
    let design = tiny();
    let network = network(&design, 1);
    let plan = plan(&job(&design, &network), Set::Second, None, BAUD).unwrap();
    assert_eq!(plan.written_parts, plan.parts);
    // Bytes at ten bits each are nearly all of it: the circuit's CRCs take the rest.
    let line = (plan.bytes[0] + plan.bytes[1]) as f64 * 10.0 / f64::from(BAUD);
    assert!(plan.seconds >= line * 0.999 && plan.seconds < 1.1 * line, "{plan:?}");
}
