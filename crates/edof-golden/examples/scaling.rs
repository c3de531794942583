//! How the golden pipeline's time and memory grow with pixels, threads, T, stride and light (non-zero codes), beside what its loops lead
//! one to expect: a table in Markdown.
//!
//! `cargo run --release -p edof-golden --example scaling -- NETWORK.fixed.safetensors RAW.png`. Each row is a process of its own, because a process reports only its peak memory. T is changed by repeating or leaving out middle layers, the frame's size by
//! mirroring it at its edges.

use edof_core::geometry::mirror;
use edof_core::{CfaPhase, RawFrame, Stride};
use edof_golden::{Display, Golden, Picture};
use edof_network::{FixedNetwork, weight_file};
use ndarray::Array2;
use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Frames that are timed; the median counts.
const FRAMES: usize = 7;

/// What is changed: rows, columns, threads, T, stride, light in percent.
type Case = [usize; 6];

const USUAL: Case = [1080, 1920, 1, 4, 8, 100];

/// A parameter, its values, and what time and memory should do.
const CURVES: [(&str, usize, &[usize], &str); 5] = [
    (
        "lines (columns 16/9)",
        0,
        &[270, 540, 1080, 2160],
        "time and memory of the frame with pixels: 2 with lines",
    ),
    ("threads", 2, &[1, 2], "processor time 0; memory of a thread 2 MiB"),
    ("T", 3, &[2, 3, 4, 6, 8], "time a line in T: one product by the non-zeros a layer"),
    ("stride", 4, &[8, 4, 2], "time −2, as patches; memory of the frame 0"),
    ("light in %", 5, &[1, 10, 50, 100], "time a line in the non-zeros"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match &args[..] {
        [network, raw] => CURVES.iter().try_for_each(|curve| print_curve(network, raw, curve)),
        [network, raw, case @ ..] => {
            let numbers: Vec<usize> = case.iter().map(|n| n.parse()).collect::<Result<_, _>>()?;
            let case = Case::try_from(numbers).map_err(|_| "six numbers make a case")?;
            println!("{}", measure(Path::new(network), Path::new(raw), case)?);
            Ok(())
        }
        _ => Err("usage: scaling NETWORK.fixed.safetensors RAW.png".into()),
    }
}

fn print_curve(
    network: &str,
    raw: &str,
    (name, which, values, expected): &(&str, usize, &[usize], &str),
) -> Result<(), Box<dyn Error>> {
    println!("\n| {name} | non-zeros a patch | processor ms a frame | slope | ms by the clock | peak MiB |");
    println!("|---|---|---|---|---|---|");
    let mut before: Option<(f64, f64)> = None;
    for &value in *values {
        let mut case = USUAL;
        case[*which] = value;
        if *which == 0 {
            case[1] = value * 16 / 9;
        }
        let run = Command::new(std::env::current_exe()?)
            .args([network, raw])
            .args(case.map(|n| n.to_string()))
            .output()?;
        let line = String::from_utf8(run.stdout)?;
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|n| n.parse().ok()).collect();
        let [nonzeros, cpu, wall, memory] = numbers[..] else {
            return Err(String::from_utf8_lossy(&run.stderr).into());
        };
        let slope =
            before.map_or("".to_owned(), |(x, y)| format!("{:.2}", (cpu / y).ln() / (value as f64 / x).ln()));
        println!("| {value} | {nonzeros:.0} | {cpu:.1} | {slope} | {wall:.1} | {memory:.0} |");
        before = Some((value as f64, cpu));
    }
    println!("\nExpected: {expected}.");
    Ok(())
}

/// Non-zeros a patch, milliseconds of processor and clock a frame, and the most memory in MiB.
fn measure(
    network: &Path,
    raw: &Path,
    [rows, columns, threads, layers, stride, light]: Case,
) -> Result<String, Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let golden = Golden::new(changed(weight_file::load_fixed(network)?, layers, Stride::new(stride)?)?)?;
    let raw = frame(raw, rows, columns, light)?;
    let (mut stream, mut picture, display) = (golden.stream(), Picture::empty(), Display::default());
    let counts = stream.frame(&raw)?.counts.clone();
    let nonzeros: u64 = counts.stages.iter().map(|stage| stage.nonzeros).sum();
    let (mut cpu, mut wall) = (vec![], vec![]);
    for _ in 0..FRAMES {
        let (clock, processor) = (Instant::now(), processor_seconds()?);
        stream.frame(&raw)?.picture_into(&display, &mut picture);
        cpu.push(processor_seconds()? - processor);
        wall.push(clock.elapsed().as_secs_f64());
    }
    let [cpu, wall] = [cpu, wall].map(|mut times| {
        times.sort_by(f64::total_cmp);
        1e3 * times[FRAMES / 2]
    });
    Ok(format!("{} {cpu} {wall} {}", nonzeros as f64 / counts.patches as f64, peak_mib()?))
}

/// The network with another number of layers, made of its own, at another stride.
fn changed(mut network: FixedNetwork, layers: usize, stride: Stride) -> Result<FixedNetwork, Box<dyn Error>> {
    let shrinkages = layers - 1;
    network.form.layers = layers;
    network.stride = stride;
    network.recurrent = network.recurrent.iter().cloned().cycle().take(shrinkages - 1).collect();
    network.thresholds = network.thresholds.iter().cloned().cycle().take(shrinkages).collect();
    network.code_fractions = network.code_fractions.iter().copied().cycle().take(shrinkages).collect();
    network.check()?;
    Ok(network)
}

/// A grey 16-bit picture as a sensor's 12 bits, mirrored to a size, with a part of its light.
fn frame(path: &Path, rows: usize, columns: usize, light: usize) -> Result<RawFrame, Box<dyn Error>> {
    let picture = image::open(path)?.into_luma16();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let at = |i: usize, length: usize| {
        let turned = i % (2 * length - 2);
        mirror(turned as isize, length) as u32
    };
    let values = Array2::from_shape_fn((rows, columns), |(r, c)| {
        let value = usize::from(picture.get_pixel(at(c, width), at(r, height))[0] >> 4);
        (value * light / 100) as u16
    });
    Ok(RawFrame::from_values(values, 12, CfaPhase::Rggb)?)
}

/// Time that all threads of this process have spent computing.
fn processor_seconds() -> Result<f64, Box<dyn Error>> {
    let mut nanoseconds = 0;
    for task in std::fs::read_dir("/proc/self/task")? {
        let spent = std::fs::read_to_string(task?.path().join("schedstat"))?;
        nanoseconds += spent.split_whitespace().next().unwrap_or("0").parse::<u64>()?;
    }
    Ok(nanoseconds as f64 / 1e9)
}

/// The most memory that this process ever had.
fn peak_mib() -> Result<f64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let peak =
        status.lines().find(|line| line.starts_with("VmHWM")).and_then(|line| line.split_whitespace().nth(1));
    Ok(peak.unwrap_or("0").parse::<f64>()? / 1024.0)
}
