//! What a network runs on: the processor, or a device behind OpenCL.

use super::JobError;
use edof_gpu::Device as Gpu;
use std::fmt;
use std::str::FromStr;

/// `cpu`, `gpu`, or `gpu:1` for the second of the devices that `edof doctor` lists.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Device {
    /// The processor.
    #[default]
    Cpu,
    /// A device by its number, or the first.
    Gpu(Option<usize>),
}

impl Device {
    /// Number of the device; by default the first.
    #[must_use]
    pub fn number(self) -> usize {
        match self {
            Self::Cpu | Self::Gpu(None) => 0,
            Self::Gpu(Some(number)) => number,
        }
    }

    /// Opens the device; `None` stands for the processor.
    ///
    /// # Errors
    /// [`JobError::Device`].
    pub fn open(self) -> Result<Option<Gpu>, JobError> {
        match self {
            Self::Cpu => Ok(None),
            Self::Gpu(wanted) => {
                Gpu::open(wanted).map(Some).map_err(|source| JobError::Device { device: self, source })
            }
        }
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cpu => f.write_str("cpu"),
            Self::Gpu(None) => f.write_str("gpu"),
            Self::Gpu(Some(number)) => write!(f, "gpu:{number}"),
        }
    }
}

impl FromStr for Device {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || "must be cpu, gpu, or gpu:N with N from 0".to_owned();
        match text.split_once(':') {
            None if text == "cpu" => Ok(Self::Cpu),
            None if text == "gpu" => Ok(Self::Gpu(None)),
            Some(("gpu", number)) => number.parse().map(|n| Self::Gpu(Some(n))).map_err(|_| wrong()),
            _ => Err(wrong()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_read_and_told_alike() {
        for text in ["cpu", "gpu", "gpu:0", "gpu:12"] {
            assert_eq!(text.parse::<Device>().unwrap().to_string(), text);
        }
        for text in ["", "GPU", "cpu:0", "gpu:", "gpu:-1", "gpu:x"] {
            assert!(text.parse::<Device>().is_err(), "{text}");
        }
    }
}
