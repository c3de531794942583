//! Foldings of a design: how many lanes and rows each stage has, from the cheapest to the fastest.

use super::Stalls;
use super::chain::Chain;
use super::estimate::{StageCycles, mean_steps};
use edof_device::Design;
use edof_device::design::stage::MAX_ROWS;
use edof_device::design::{BANK_LANES, StagePlan, StageSize};

/// The foldings worth a look for patches with these mean numbers of pairs: for every number of cycles per patch that some stage can
/// reach, each stage is the one with the fewest multipliers that is fast enough. Cheapest first.
///
/// ```
/// use edof_golden::cycle::explore::foldings;
/// let tiny = edof_device::Design::from_json(include_str!("../../../../designs/tiny.json"))?;
/// let all = foldings(&tiny, &[64.0, 8.0, 8.0, 8.0]);
/// let dsps = |design: &edof_device::Design| design.stages().map(|stage| stage.dsps()).sum::<usize>();
/// assert!(all.windows(2).all(|two| dsps(&two[0]) < dsps(&two[1])));
/// # Ok::<(), edof_device::design::DesignError>(())
/// ```
#[must_use]
pub fn foldings(design: &Design, pairs: &[f64]) -> Vec<Design> {
    let stages: Vec<Vec<Choice>> =
        (0..design.stages.len()).map(|index| choices(design, index, pairs[index])).collect();
    let mut limits: Vec<f64> = stages.iter().flatten().map(|choice| choice.cycles).collect();
    limits.sort_by(|a, b| b.total_cmp(a));
    limits.dedup();
    let mut all: Vec<Design> = vec![];
    for limit in limits {
        // Choices stand from the cheapest to the fastest: the first that is fast enough.
        let fast = |choices: &Vec<Choice>| choices.iter().find(|c| c.cycles <= limit).map(|c| c.size);
        let Some(sizes) = stages.iter().map(fast).collect::<Option<Vec<StageSize>>>() else { continue };
        if all.last().is_none_or(|last| last.stages != sizes) {
            all.push(Design { stages: sizes, ..design.clone() });
        }
    }
    all
}

/// A size of a stage, and the cycles per patch that it would take alone.
struct Choice {
    size: StageSize,
    dsps: usize,
    cycles: f64,
}

/// The sizes of a stage than which none is both as cheap and faster, cheapest first.
fn choices(design: &Design, index: usize, pairs: f64) -> Vec<Choice> {
    let outputs = design.stage(index).outputs;
    let sizes = (BANK_LANES..=outputs)
        .step_by(BANK_LANES)
        .flat_map(|lanes| (1..=MAX_ROWS).map(move |rows| StageSize { lanes, rows }));
    let choice = |size: StageSize| {
        let plan = StagePlan { lanes: size.lanes, rows: size.rows, ..design.stage(index) };
        plan.check().ok()?;
        let cycles = StageCycles::new(&plan, mean_steps(&plan, pairs)).largest();
        Some(Choice { size, dsps: plan.dsps(), cycles })
    };
    let mut all: Vec<Choice> = sizes.filter_map(choice).collect();
    all.sort_by(|a, b| a.dsps.cmp(&b.dsps).then(a.cycles.total_cmp(&b.cycles)));
    let mut fastest = f64::INFINITY;
    all.retain(|choice| {
        let faster = choice.cycles < fastest;
        fastest = fastest.min(choice.cycles);
        faster
    });
    all
}

/// Cycles per patch of a checked design for patches of which each stage keeps N pairs; 0 for fewer than two.
#[must_use]
pub fn cycles_per_patch(design: &Design, patches: &[Vec<usize>]) -> f64 {
    let mut chain = Chain::new(design, Stalls::NEVER);
    let mut ends = patches.iter().map(|pairs| chain.next(pairs).end());
    match (ends.next(), ends.last()) {
        (Some(first), Some(last)) => (last - first) as f64 / (patches.len() - 1) as f64,
        _ => 0.0,
    }
}

/// The points than which no other is as good in everything and better in something; each figure better where it is less.
#[must_use]
pub fn front<const N: usize>(points: &[[f64; N]]) -> Vec<bool> {
    let beats = |a: &[f64; N], b: &[f64; N]| a != b && a.iter().zip(b).all(|(a, b)| a <= b);
    points.iter().map(|point| !points.iter().any(|other| beats(other, point))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kc705() -> Design {
        Design::from_json(include_str!("../../../../designs/kc705.json")).unwrap()
    }

    #[test]
    fn the_committed_folding_is_found_for_the_networks_that_it_is_for() {
        let kc705 = kc705();
        let found = foldings(&kc705, &[144.0, 65.0, 65.0, 58.0]);
        assert!(found.iter().any(|design| design.stages == kc705.stages));
    }

    #[test]
    fn every_folding_can_be_built_and_more_multipliers_are_never_slower() {
        let design = kc705();
        let pairs = [144, 60, 50, 40];
        let patches = vec![pairs.to_vec(); 300];
        let found = foldings(&design, &pairs.map(|p| p as f64));
        assert!(found.len() > 10);
        let cycles: Vec<f64> = found.iter().map(|design| cycles_per_patch(design, &patches)).collect();
        assert!(found.iter().all(|design| design.check().is_ok()));
        let dsps = |design: &Design| design.stages().map(|stage| stage.dsps()).sum::<usize>();
        assert!(found.windows(2).all(|two| dsps(&two[0]) < dsps(&two[1])));
        assert!(cycles.windows(2).all(|two| two[1] <= two[0]), "{cycles:?}");
    }

    #[test]
    fn the_front_has_what_nothing_beats() {
        let points = [[1.0, 5.0], [2.0, 2.0], [3.0, 2.0], [2.0, 2.0], [5.0, 1.0], [6.0, 6.0]];
        assert_eq!(front(&points), [true, true, false, true, true, false]);
    }
}
