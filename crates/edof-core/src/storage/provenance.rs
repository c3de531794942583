//! How a result was made: written by the program into every file and report that it makes
//! (docs/decisions/0011-provenance.md).
//!
//! ```
//! use edof_core::storage::provenance::{Host, Input, InputKind, Provenance};
//! let made = Provenance {
//!     command: "edof reconstruct raw.png --stride 8".into(),
//!     version: "0.1.0".into(),
//!     revision: Some("0123abcd-dirty".into()),
//!     seed: None,
//!     inputs: vec![Input::of_bytes(InputKind::RawFrame, "raw.png", b"its bytes")],
//!     host: Host { cpu: "some CPU".into(), isa: "avx2 fma".into(), ..Host::default() },
//! };
//! let elsewhere = Provenance { host: Host::default(), ..made.clone() };
//! assert_eq!(made.identity(), elsewhere.identity());
//! ```

use crate::frame::{ColourFrame, RawFrame};
use crate::storage::digest::{hexadecimal, sha256};
use ndarray::ArrayView1;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// How a result was made. Everything but the host identifies it: the same command of the same revision, on inputs of the same
/// content, is the same making.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The command with every option that the result depends on, defaults written out. Options that only say where files lie
    /// are left out: what these held stands under `inputs`.
    pub command: String,
    /// Version of the program.
    pub version: String,
    /// Git revision that the program was built from, followed by `-dirty` where its sources differed; none outside of git.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    /// Seed of everything random.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// What was read, in the order in which it was.
    #[serde(default)]
    pub inputs: Vec<Input>,
    /// Where it ran.
    #[serde(default)]
    pub host: Host,
}

/// Something that a result was made from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// What it is.
    pub kind: InputKind,
    /// Name of the file; the name says nothing about the contents.
    pub name: String,
    /// SHA-256 of its content, as hexadecimal digits.
    pub sha256: String,
}

/// Kinds of inputs, and what of them is hashed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputKind {
    /// A photograph or synthetic scene: its sides and values, so that neither its file's format nor its name matters.
    Photograph,
    /// A raw frame: its sides, phase and sensor values.
    RawFrame,
    /// A camera: its JSON.
    Camera,
    /// A weight file: the hash that the file states.
    Weights,
    /// A design: its JSON.
    Design,
    /// A correction of a sensor: the bytes of its file.
    Sensor,
}

/// The machine that a result was made on. It does not identify the result. Sums in floating point are taken in the order that
/// suits the instruction set, so another machine may give other LSB; one machine gives the same ones every time.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Host {
    /// Model name of the CPU.
    pub cpu: String,
    /// Numbers of its family and model, where the system states them: CPUs of one name may differ in them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub family: Option<u32>,
    /// See `family`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<u32>,
    /// Instruction sets that the program found there, of those that it has use for.
    pub isa: String,
    /// Threads; only in results that hold times and so differ from run to run anyway.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threads: Option<usize>,
}

impl Provenance {
    /// SHA-256 of everything that identifies the making: all but the host.
    #[must_use]
    pub fn identity(&self) -> String {
        let Self { command, version, revision, seed, inputs, host: _ } = self;
        let text = serde_json::json!([command, version, revision, seed, inputs]).to_string();
        sha256(text.as_bytes())
    }

    /// The same for a file that is to be the same from run to run: without the number of threads.
    #[must_use]
    pub fn for_file(mut self) -> Self {
        self.host.threads = None;
        self
    }
}

impl Input {
    /// An input by bytes that say all of it.
    #[must_use]
    pub fn of_bytes(kind: InputKind, name: &str, bytes: &[u8]) -> Self {
        Self { kind, name: name.to_owned(), sha256: sha256(bytes) }
    }

    /// A photograph, by its sides and values.
    #[must_use]
    pub fn photograph(name: &str, frame: &ColourFrame) -> Self {
        let mut digest = sides(frame.size());
        frame.planes.rows().into_iter().for_each(|row| update(&mut digest, row, f32::to_le_bytes));
        Self { kind: InputKind::Photograph, name: name.to_owned(), sha256: finished(digest) }
    }

    /// A raw frame, by its sides, phase and sensor values.
    #[must_use]
    pub fn raw_frame(name: &str, frame: &RawFrame) -> Self {
        let mut digest = sides(frame.size());
        digest.update(frame.phase().to_string());
        frame.pixels().rows().into_iter().for_each(|row| update(&mut digest, row, u16::to_le_bytes));
        Self { kind: InputKind::RawFrame, name: name.to_owned(), sha256: finished(digest) }
    }
}

fn sides((height, width): (usize, usize)) -> Sha256 {
    let mut digest = Sha256::new();
    [height, width].iter().for_each(|side| digest.update((*side as u64).to_le_bytes()));
    digest
}

/// Adds a row of values, each as the bytes that it is in a file.
fn update<T: Copy, const N: usize>(digest: &mut Sha256, row: ArrayView1<T>, bytes: impl Fn(T) -> [u8; N]) {
    let bytes: Vec<[u8; N]> = row.iter().map(|value| bytes(*value)).collect();
    digest.update(bytes.as_flattened());
}

fn finished(digest: Sha256) -> String {
    hexadecimal(digest.finalize().as_slice())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cfa::CfaPhase;
    use ndarray::{Array2, Array3};

    #[test]
    fn a_photograph_is_known_by_content_and_shape_not_by_name() {
        let frame = |planes: Array3<f32>| Input::photograph("a", &ColourFrame { planes }).sha256;
        let grey = frame(Array3::from_elem((3, 4, 6), 0.5));
        assert_eq!(
            grey,
            Input::photograph("b", &ColourFrame { planes: Array3::from_elem((3, 4, 6), 0.5) }).sha256
        );
        assert_ne!(grey, frame(Array3::from_elem((3, 6, 4), 0.5)));
        let mut one = Array3::from_elem((3, 4, 6), 0.5);
        one[(2, 3, 5)] = 0.500_001;
        assert_ne!(grey, frame(one));
    }

    #[test]
    fn a_raw_frame_is_known_by_its_phase_too() {
        let hash = |phase| {
            let frame = RawFrame::from_values(Array2::from_elem((200, 300), 77), 12, phase).unwrap();
            Input::raw_frame("raw", &frame).sha256
        };
        assert_eq!(hash(CfaPhase::Rggb), hash(CfaPhase::Rggb));
        assert_ne!(hash(CfaPhase::Rggb), hash(CfaPhase::Bggr));
    }

    #[test]
    fn every_field_but_the_host_identifies() {
        let made = Provenance { command: "edof".into(), ..Provenance::default() };
        let input = Input::of_bytes(InputKind::Camera, "clear", b"{}");
        let others = [
            Provenance { command: "edof x".into(), ..made.clone() },
            Provenance { version: "1".into(), ..made.clone() },
            Provenance { revision: Some("1".into()), ..made.clone() },
            Provenance { seed: Some(0), ..made.clone() },
            Provenance { inputs: vec![input], ..made.clone() },
        ];
        assert!(others.iter().all(|other| other.identity() != made.identity()));
        let host = Host {
            cpu: "another".into(),
            family: Some(25),
            model: Some(1),
            isa: "avx2".into(),
            threads: Some(3),
        };
        assert_eq!(Provenance { host, ..made.clone() }.identity(), made.identity());
    }
}
