//! Pursuits and k-SVD on numbers from standard input, for oracles in other languages (tests/oracles/peers.py).
//!
//! Words in, separated by white space: `omp` or `ista` or `fista` or `ksvd`, length, atoms, signals, limit (atoms of a code, steps), μ,
//! rounds; then the dictionary (length × atoms) and the signals (signals × length), row by row. Out come codes (signals × atoms), or the
//! dictionary of k-SVD, row by row; seconds go to standard error.

use edof_numerics::sparse::ksvd::{Settings, ksvd};
use edof_numerics::sparse::lasso::{Effort, Lasso};
use edof_numerics::sparse::omp::{Omp, Stop};
use ndarray::{Array1, Array2};
use std::error::Error;
use std::io::{Read, Write};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let mut words = text.split_ascii_whitespace();
    let mut word = || words.next().ok_or("the input ends too early");
    let method = word()?.to_owned();
    let [length, atoms, signals, limit] = [(); 4].map(|()| word().map(str::parse::<usize>));
    let (length, atoms, signals, limit) = (length??, atoms??, signals??, limit??);
    let (penalty, rounds): (f64, usize) = (word()?.parse()?, word()?.parse()?);
    let mut matrix = |rows: usize, columns: usize| -> Result<Array2<f64>, Box<dyn Error>> {
        let values = (0..rows * columns)
            .map(|_| Ok(word()?.parse()?))
            .collect::<Result<Vec<f64>, Box<dyn Error>>>()?;
        Ok(Array2::from_shape_vec((rows, columns), values)?)
    };
    let (dictionary, signals) = (matrix(length, atoms)?, matrix(signals, length)?);
    let start = Instant::now();
    let lasso = || Lasso::new(dictionary.view(), Array1::from_elem(atoms, penalty).view(), 0);
    let effort = Effort { steps: limit, tolerance: 1e-13 };
    let out = match method.as_str() {
        "omp" => Omp::new(dictionary.view(), 0).codes(signals.view(), Stop::at_atoms(limit)).to_dense(atoms),
        "ista" => lasso().ista(signals.view(), effort).codes,
        "fista" => lasso().fista(signals.view(), effort).codes,
        "ksvd" => {
            let settings = Settings { atoms: limit, rounds, free: 0 };
            let fitted = ksvd(signals.mapv(|v| v as f32).view(), dictionary.mapv(|v| v as f32), settings);
            fitted.dictionary.mapv(f64::from)
        }
        other => return Err(format!("method '{other}': must be omp, ista, fista or ksvd").into()),
    };
    eprintln!("{}", start.elapsed().as_secs_f64());
    let mut to = std::io::BufWriter::new(std::io::stdout().lock());
    for row in out.outer_iter() {
        let line: Vec<String> = row.iter().map(|v| format!("{v:e}")).collect();
        writeln!(to, "{}", line.join(" "))?;
    }
    Ok(to.flush()?)
}
