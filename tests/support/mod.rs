//! The real binary in a folder of its own.

use edof_core::camera::Camera;
use edof_core::overlap::Overlap;
use edof_core::{CfaPhase, ColourFrame, RawFrame, Stride, Window};
use edof_network::fixed_network::{FixedMatrix, FixedNetwork};
use edof_network::network::{Form, Network, Origin, Recurrence, Shrinkage};
use edof_network::weight_file;
use ndarray::{Array1, Array2, Array3, Axis, concatenate};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own, gone afterwards.
pub struct Place {
    dir: tempfile::TempDir,
}

impl Place {
    pub fn new() -> Self {
        Self { dir: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Runs `edof` here; arguments are the words of `line`.
    pub fn edof(&self, line: &str) -> Run {
        self.command(line).output().unwrap().into()
    }

    /// The same, ended where it takes more than a gigabyte of addresses, three seconds of a core or a minute: what is rejected
    /// takes none of these. (The program as it is tested is hardly optimised.)
    pub fn edof_within_bounds(&self, line: &str) -> Run {
        let mut command = self.prepared(Command::new("sh"));
        command.args([
            "-c",
            "ulimit -v 1048576; ulimit -t 3; exec timeout 60 \"$0\" \"$@\"",
            env!("CARGO_BIN_EXE_edof"),
        ]);
        command.args(line.split_whitespace()).output().unwrap().into()
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = self.prepared(Command::new(env!("CARGO_BIN_EXE_edof")));
        command.args(line.split_whitespace());
        command
    }

    fn prepared(&self, mut command: Command) -> Command {
        command.current_dir(self.dir.path());
        command.env("EDOF_KODAK", "no-kodak-here").env("EDOF_MORE", "");
        // Models that are compiled here are none of the user's, and every test may use them.
        command.env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR"));
        command
    }

    /// Names of all files and folders here, sorted.
    pub fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.dir.path())
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// Every file and link here and below, with its bytes.
    pub fn snapshot(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        snapshot(self.dir.path())
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    /// A 12-bit raw frame of a soft pattern.
    pub fn raw(&self, name: &str, width: usize, height: usize) {
        let codes = Array2::from_shape_fn((height, width), |(r, c)| {
            (1000 + 16 * ((r * 7 + c * 3) % 64) + c % 2) as u16
        });
        let frame = RawFrame::from_values(codes, 12, CfaPhase::Rggb).unwrap();
        edof_io::raw::save(&self.path(name), &frame).unwrap();
    }

    /// A named pipe, at whose other end nobody is.
    pub fn pipe(&self, name: &str) {
        assert!(Command::new("mkfifo").arg(self.path(name)).status().unwrap().success());
    }

    /// An 8-bit photograph of edges.
    pub fn photo(&self, name: &str, width: usize, height: usize) {
        let planes = Array3::from_shape_fn((3, height, width), |(p, r, c)| {
            0.2 + 0.2 * (p + (r / 9) % 2 + (c / 7) % 2) as f32
        });
        edof_io::photo::save(&self.path(name), &ColourFrame { planes }, 8).unwrap();
    }

    /// An 8-bit photograph of nothing: whatever is made of it is the same to the last bit.
    pub fn black_photo(&self, name: &str, width: usize, height: usize) {
        edof_io::photo::save(&self.path(name), &ColourFrame::zeros(height, width), 8).unwrap();
    }

    /// A float network that gives each pixel the mean of its CFA colours around it.
    pub fn float_network(&self, name: &str) {
        weight_file::save_network(&self.path(name), &network()).unwrap();
    }

    /// A float network of two exposures, at the foci 2 and 6 of the camera clear-mid.
    pub fn network_of_two(&self, name: &str) {
        weight_file::save_network(&self.path(name), &network_of_two([2.0, 6.0])).unwrap();
    }

    pub fn fixed_network(&self, name: &str) {
        weight_file::save_fixed(&self.path(name), &fixed_network()).unwrap();
    }
}

/// Every file and link below a folder, with its bytes.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| match path.is_dir() && !path.is_symlink() {
            true => snapshot(&path).into_iter().collect(),
            // Opening a pipe waits.
            false if !path.is_file() => vec![(path, vec![])],
            false => vec![(path.clone(), std::fs::read(&path).unwrap_or_default())],
        })
        .collect()
}

/// What a run of `edof` left.
pub struct Run {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Run {
    /// The command succeeded.
    #[track_caller]
    pub fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self
    }

    /// The command was rejected: status 1, one line on standard error that holds all of `words`, nothing on standard output.
    #[track_caller]
    pub fn refused(self, words: &[&str]) {
        assert_eq!(self.code, Some(1), "out: {} err: {}", self.out, self.err);
        assert_eq!(self.err.lines().count(), 1, "{}", self.err);
        assert!(self.err.starts_with("edof: ") && !self.err.contains("panicked"), "{}", self.err);
        for word in words {
            assert!(self.err.contains(word), "'{word}' is not in: {}", self.err);
        }
        assert_eq!(self.out, "");
    }
}

pub fn form() -> Form {
    Form {
        window: Window::new(8).unwrap(),
        codes: 4,
        layers: 3,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    }
}

fn origin() -> Origin {
    Origin::untrained("small", Camera::resolve("clear").unwrap())
}

/// Copies every raw pixel to all three colours through R; codes stay zero.
pub fn network() -> Network {
    let pixel = |output: usize, input: usize| f32::from(u8::from(output % 64 == input));
    Network {
        form: form(),
        analysis: Array2::zeros((4, 64)),
        thresholds: vec![Array1::zeros(4); 2],
        recurrent: vec![Array2::zeros((4, 4))],
        dictionary: Array2::zeros((192, 4)),
        linear_path: Some(Array2::from_shape_fn((192, 64), |(o, i)| pixel(o, i))),
        origin: origin(),
    }
}

/// Gives the mean of what [`network`] makes of each of two raw frames, taken at these foci of the camera `clear-mid`.
pub fn network_of_two(foci: [f64; 2]) -> Network {
    let twice = |matrix: Array2<f32>| concatenate![Axis(1), matrix, matrix];
    let Network { form, analysis, linear_path, origin, .. } = network();
    let camera = Camera { focus_psi: foci[0], ..Camera::resolve("clear-mid").unwrap() };
    Network {
        form: Form { exposures: 2, ..form },
        analysis: twice(analysis),
        linear_path: linear_path.map(|r| 0.5 * twice(r)),
        origin: Origin { name: "two".into(), camera, further_foci: vec![foci[1]], ..origin },
        ..network()
    }
}

/// Copies every raw pixel to luma; no colour.
pub fn fixed_network() -> FixedNetwork {
    let zeros = |rows, columns| FixedMatrix { weights: Array2::zeros((rows, columns)), fraction: 14 };
    let copy = Array2::from_shape_fn((128, 64), |(o, i)| if o == i { 1 << 13 } else { 0 });
    FixedNetwork {
        form: form(),
        code_bits: 16,
        stride: Stride::PATCH,
        overlap: Overlap::Hann,
        analysis: zeros(4, 64),
        thresholds: vec![Array1::zeros(4); 2],
        recurrent: vec![zeros(4, 4)],
        dictionary: zeros(128, 4),
        linear_path: Some(FixedMatrix { weights: copy, fraction: 13 }),
        code_fractions: vec![13, 13],
        origin: origin(),
        float_hash: "0".into(),
        quantized: None,
    }
}

/// The weight file again with `change` made to its metadata and its tensors, and a hash that agrees: what only someone who
/// writes such files can get wrong.
pub fn forge(path: &Path, change: impl FnOnce(&mut String, &mut Vec<(String, Vec<usize>, Vec<u8>)>)) {
    let bytes = std::fs::read(path).unwrap();
    let (_, header) = SafeTensors::read_metadata(&bytes).unwrap();
    let mut text = header.metadata().as_ref().unwrap()["edof"].clone();
    let file = SafeTensors::deserialize(&bytes).unwrap();
    let mut dtype = Dtype::F32;
    let mut tensors: Vec<(String, Vec<usize>, Vec<u8>)> = file
        .tensors()
        .into_iter()
        .map(|(name, view)| {
            dtype = view.dtype();
            (name, view.shape().to_vec(), view.data().to_vec())
        })
        .collect();
    let metadata: serde_json::Value = serde_json::from_str(&text).unwrap();
    let old = metadata["sha256"].as_str().unwrap();
    change(&mut text, &mut tensors);
    let blank = text.replace(old, &"0".repeat(64));
    let text = text.replace(old, &hash(&blank, dtype, &mut tensors));
    let views = tensors.iter().map(|(n, s, b)| (n.as_str(), TensorView::new(dtype, s.clone(), b).unwrap()));
    let forged = safetensors::serialize(views, Some(HashMap::from([("edof".to_owned(), text)]))).unwrap();
    std::fs::write(path, forged).unwrap();
}

fn hash(text: &str, dtype: Dtype, tensors: &mut [(String, Vec<usize>, Vec<u8>)]) -> String {
    tensors.sort();
    let mut digest = Sha256::new();
    digest.update(text);
    for (name, shape, bytes) in tensors {
        digest.update(format!("{name} {dtype:?} {shape:?}"));
        digest.update(bytes);
    }
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
