//! From the calculator's patches to lines.

use super::overlap_add::OverlapAdd;
use super::patch_pairs::PatchPairs;
use super::raster_reorder::RasterReorder;
use crate::blocks::Pair;
use crate::describe::{Circuit, kernel};
use crate::verilog::Optional;
use edof_device::Design;
use rust_hdl::prelude::*;

/// From the calculator's patches to the lines of the 4:2:2 frame: pairs of pixels, added where patches overlap, in the order of a raster.
#[derive(Circuit)]
#[circuit(default(PatchPairs))]
pub struct Lines {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the picture.
    pub reset: Signal<In, Bit>,
    /// Two input words of a patch are valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Two words of a patch, the even one low.
    pub data: Signal<In, Pair>,
    /// A pair of pixels stands on the output.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Luma words of the pair, the left pixel low.
    pub out_luma: Signal<Out, Pair>,
    /// Chroma words of the pair, Cb low.
    pub out_chroma: Signal<Out, Pair>,
    /// The pair is the first of its frame.
    pub out_first: Signal<Out, Bit>,
    /// The pair is the last of its line.
    pub out_last: Signal<Out, Bit>,
    /// Sets the counter to zero.
    pub clear: Signal<In, Bit>,
    /// Sums that did not fit 16 bits; 0 where patches do not overlap.
    pub saturated_sums: Signal<Out, Bits<32>>,
    pairs: PatchPairs,
    overlap: Optional<OverlapAdd>,
    raster: RasterReorder,
}

impl Lines {
    /// For the frame and the stride of a design.
    #[must_use]
    pub fn of(design: &Design) -> Self {
        Self::from_parts(LinesParts {
            overlap: OverlapAdd::of(design).into(),
            raster: RasterReorder::of(design),
        })
    }
}

impl Logic for Lines {
    #[kernel]
    fn update(&mut self) {
        self.pairs.clock.next = self.clock.val();
        self.pairs.reset.next = self.reset.val();
        self.raster.clock.next = self.clock.val();
        self.raster.reset.next = self.reset.val();
        self.pairs.valid.next = self.valid.val();
        self.ready.next = self.pairs.ready.val();
        self.pairs.data.next = self.data.val();

        // Patches that overlap are added; others are blocks already.
        self.raster.valid.next = self.pairs.out_valid.val();
        self.pairs.out_ready.next = self.raster.ready.val();
        self.raster.luma.next = self.pairs.out_luma.val();
        self.raster.chroma.next = self.pairs.out_chroma.val();
        self.saturated_sums.next = 0.into();
        for i in 0..self.overlap.count() {
            self.overlap[i].clock.next = self.clock.val();
            self.overlap[i].reset.next = self.reset.val();
            self.overlap[i].clear.next = self.clear.val();
            self.overlap[i].valid.next = self.pairs.out_valid.val();
            self.pairs.out_ready.next = self.overlap[i].ready.val();
            self.overlap[i].luma.next = self.pairs.out_luma.val();
            self.overlap[i].chroma.next = self.pairs.out_chroma.val();
            self.raster.valid.next = self.overlap[i].out_valid.val();
            self.overlap[i].out_ready.next = self.raster.ready.val();
            self.raster.luma.next = self.overlap[i].out_luma.val();
            self.raster.chroma.next = self.overlap[i].out_chroma.val();
            self.saturated_sums.next = self.overlap[i].saturated_sums.val();
        }
        self.raster.out_ready.next = self.out_ready.val();
        self.out_valid.next = self.raster.out_valid.val();
        self.out_luma.next = self.raster.out_luma.val();
        self.out_chroma.next = self.raster.out_chroma.val();
        self.out_first.next = self.raster.out_first.val();
        self.out_last.next = self.raster.out_last.val();
    }
}
