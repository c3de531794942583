//! What `sta` prints: the worst path, its end first.

use super::Step;

/// The delay in picoseconds and the path, where it begins first.
///
/// A cell has a line of arrival, name and `(TYPE.PIN->PIN)`, and one of the net on which the path comes to it. A path that ends at a port
/// begins with a net alone.
pub fn path(text: &str) -> Result<(u64, Vec<Step>), String> {
    let mut lines = text.lines().skip_while(|line| !line.starts_with("Latest arrival time"));
    let title = lines.next().ok_or("no 'Latest arrival time' in the timing report")?;
    let delay = title.trim_end_matches(':').rsplit(' ').next().and_then(|word| word.parse().ok());
    let delay = delay.ok_or_else(|| format!("no delay in '{title}'"))?;
    let mut steps: Vec<Step> = Vec::new();
    for line in lines.take_while(|line| !line.trim().is_empty()) {
        match (cell(line), steps.last_mut()) {
            (Some((arrival_ps, cell)), _) => steps.push(Step { arrival_ps, cell, net: String::new() }),
            (None, Some(step)) => step.net = name(line).into(),
            (None, None) => (),
        }
    }
    if steps.is_empty() {
        return Err("a timing report without a path".into());
    }
    // The report states the net at a cell's input; listed is the net at its output.
    for i in (1..steps.len()).rev() {
        steps[i].net = steps[i - 1].net.clone();
    }
    steps[0].net = String::new();
    steps.reverse();
    Ok((delay, steps))
}

/// Whether a path goes through the cell, which is no register and no port.
pub fn is_logic(cell: &str) -> bool {
    ["LUT", "MUXF", "CARRY4", "INV"].iter().any(|kind| cell.starts_with(kind)) && cell.contains("->")
}

/// Arrival and type, of `5061 some.name (RAMB18E1.ADDRARDADDR)`.
fn cell(line: &str) -> Option<(u64, String)> {
    let arrival = line.split_whitespace().next()?.parse().ok()?;
    let kind = line.rsplit_once('(')?.1.strip_suffix(')').filter(|kind| !kind.starts_with('<'))?;
    Some((arrival, kind.into()))
}

/// The name of a net without its escape, if it is a name of the source.
fn name(line: &str) -> &str {
    line.trim().strip_prefix('\\').unwrap_or("")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\n\nLatest arrival time in 'stage' is 1541:\n    \
        1541 ring.words.0.0 (RAMB18E1.ADDRARDADDR)\n           \\ring.read_address_i [8]\n     \
        975 $auto$carry4 (CARRY4.S->CO)\n           $auto$X [5]\n     \
        541 $abc$1 (LUT2.I1->O)\n           \\count_q [1]\n     \
        303 $auto$ff (FDRE.C->Q)\n       0   \\clock_i (<primary input>)\n\nArrival histogram:\n";

    #[test]
    fn a_path_is_reported_from_its_register_on() {
        let (delay, path) = path(TEXT).unwrap();
        assert_eq!(delay, 1541);
        let told: Vec<_> = path.iter().map(|s| (s.arrival_ps, s.cell.as_str(), s.net.as_str())).collect();
        let expected = [
            (303, "FDRE.C->Q", "count_q [1]"),
            (541, "LUT2.I1->O", ""),
            (975, "CARRY4.S->CO", "ring.read_address_i [8]"),
            (1541, "RAMB18E1.ADDRARDADDR", ""),
        ];
        assert_eq!(told, expected);
        assert_eq!(path.iter().filter(|step| is_logic(&step.cell)).count(), 2);
    }

    #[test]
    fn a_report_without_a_path_is_rejected() {
        assert_eq!(path("nothing").unwrap_err(), "no 'Latest arrival time' in the timing report");
        let cut = TEXT.split("    1541").next().unwrap();
        assert_eq!(path(cut).unwrap_err(), "a timing report without a path");
        assert_eq!(
            path("Latest arrival time in 'x' is y:").unwrap_err(),
            "no delay in 'Latest arrival time in 'x' is y:'"
        );
    }
}
