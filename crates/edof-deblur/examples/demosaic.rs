//! Demosaicing of sensor values from standard input, for oracles in other languages (tests/oracles/peers.py).
//!
//! Words in, separated by white space: `malvar` or `directional`, a phase such as `rggb`, height, width, then sensor values of 16 bits
//! row by row. Out come the red, green and blue planes, row by row.

use edof_core::{CfaPhase, RawFrame, Reconstructor};
use edof_deblur::{Directional, Malvar};
use ndarray::Array2;
use std::error::Error;
use std::io::{Read, Write};

fn main() -> Result<(), Box<dyn Error>> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let mut words = text.split_ascii_whitespace();
    let mut word = || words.next().ok_or("the input ends too early");
    let method: Box<dyn Reconstructor> = match word()? {
        "malvar" => Box::new(Malvar::default()),
        "directional" => Box::new(Directional::default()),
        other => return Err(format!("method '{other}': must be malvar or directional").into()),
    };
    let phase = word()?;
    let phase = CfaPhase::ALL.into_iter().find(|p| p.to_string() == phase).ok_or("unknown phase")?;
    let (height, width): (usize, usize) = (word()?.parse()?, word()?.parse()?);
    let values =
        (0..height * width).map(|_| Ok(word()?.parse()?)).collect::<Result<Vec<u16>, Box<dyn Error>>>()?;
    let raw = RawFrame::from_values(Array2::from_shape_vec((height, width), values)?, 16, phase)?;
    let planes = method.reconstruct(&raw)?.frame.planes;
    let mut to = std::io::BufWriter::new(std::io::stdout().lock());
    for row in planes.rows() {
        let line: Vec<String> = row.iter().map(f32::to_string).collect();
        writeln!(to, "{}", line.join(" "))?;
    }
    Ok(to.flush()?)
}
