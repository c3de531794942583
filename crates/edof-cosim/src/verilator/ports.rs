//! The ports as Verilator found them in the text, compared with the ports of the design.

use super::shim::member;
use crate::error::{Error, at};
use crate::{Direction, Port, Source};
use std::collections::BTreeMap;
use std::path::Path;

type Found = BTreeMap<String, (Direction, usize)>;

/// The top module has exactly the ports of the source: names, directions, widths.
pub fn check(source: &Source, work: &Path) -> Result<(), Error> {
    let path = work.join("Vdut.h");
    let found = found(&std::fs::read_to_string(&path).map_err(at(&path))?);
    let refuse = |problem| Err(Error::Source { top: source.top.clone(), problem });
    if let Some(problem) = source.ports.iter().find_map(|port| difference(port, &found)) {
        return refuse(problem);
    }
    let is_told = |name: &str| source.ports.iter().any(|port| member(&port.name) == name);
    match found.keys().find(|name| !is_told(name)) {
        Some(name) => refuse(format!("port {name} of the Verilog is not in the list of ports")),
        None => Ok(()),
    }
}

fn difference(port: &Port, found: &Found) -> Option<String> {
    let name = &port.name;
    match found.get(&member(name)) {
        None => Some(format!("port {name} is not in the Verilog")),
        Some((direction, _)) if *direction != port.direction => {
            Some(format!("port {name} has the other direction in the Verilog"))
        }
        Some((_, bits)) if *bits != port.bits => {
            Some(format!("port {name} has {bits} bits in the Verilog, not {}", port.bits))
        }
        Some(_) => None,
    }
}

/// From lines such as `VL_IN8(&clock_i,0,0);` and `VL_OUTW(&sum_o,99,0,4);`: name, highest and lowest bit.
fn found(header: &str) -> Found {
    header.lines().filter_map(|line| declaration(line.trim())).collect()
}

fn declaration(line: &str) -> Option<(String, (Direction, usize))> {
    let (kind, rest) = line.strip_suffix(");")?.split_once("(&")?;
    let direction = match kind {
        kind if kind.starts_with("VL_IN") && !kind.starts_with("VL_INOUT") => Direction::In,
        kind if kind.starts_with("VL_OUT") => Direction::Out,
        _ => return None,
    };
    let mut fields = rest.split(',');
    let name = fields.next()?.into();
    let mut bound = || fields.next()?.parse::<usize>().ok();
    let (high, low) = (bound()?, bound()?);
    Some((name, (direction, high.checked_sub(low)? + 1)))
}
