//! Numbers of an opcode, which are big-endian in every file.

/// What is left to read of an opcode's bytes.
#[derive(Debug, Clone, Copy)]
pub struct Parameters<'a>(&'a [u8]);

impl<'a> Parameters<'a> {
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// The next bytes, none if there are not as many.
    pub fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(head)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    /// The next number of 32 bits.
    pub fn whole(&mut self) -> Option<u32> {
        self.array().map(u32::from_be_bytes)
    }

    /// The next N of them, and nothing behind.
    pub fn wholes<const N: usize>(mut self) -> Option<[u32; N]> {
        let mut all = [0; N];
        for value in &mut all {
            *value = self.whole()?;
        }
        self.is_empty().then_some(all)
    }

    /// The next finite number of double precision.
    pub fn double(&mut self) -> Option<f64> {
        self.array().map(f64::from_be_bytes).filter(|v| v.is_finite())
    }

    /// The next N of them.
    pub fn doubles<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut all = [0.0; N];
        for value in &mut all {
            *value = self.double()?;
        }
        Some(all)
    }

    /// `count` finite numbers of single precision.
    pub fn floats(&mut self, count: usize) -> Option<Vec<f32>> {
        let bytes = self.bytes(count.checked_mul(4)?)?;
        let number = |b: &[u8]| f32::from_be_bytes([b[0], b[1], b[2], b[3]]);
        let all: Vec<f32> = bytes.chunks_exact(4).map(number).collect();
        all.iter().all(|v| v.is_finite()).then_some(all)
    }

    /// `count` numbers of 16 bits.
    pub fn words(&mut self, count: usize) -> Option<Vec<u16>> {
        let bytes = self.bytes(count.checked_mul(2)?)?;
        Some(bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect())
    }

    pub const fn is_empty(self) -> bool {
        self.0.is_empty()
    }
}
