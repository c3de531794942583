//! `edof study blind`: blind deconvolution where the blur is known.

use super::options::{MayKeepRows, Outputs, Photographs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use edof_deblur::blind::Settings;
use edof_study::known_blurs::{DrawnBlurs, KnownBlurs};

/// PSNR gain of blind deconvolution on photographs blurred with synthetic kernels, and correlation of estimated and true kernels
///
/// Each photograph is blurred with a disc, a stroke and a bow, and rounded to 8 bits. The kernel is estimated on the grey picture, and
/// the colours are deconvolved with the estimate. PSNR is over red, green and blue, a border of 8 pixels cropped.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study blind --markdown blind.md
  edof study blind --photos all --side 25 --rows blind.jsonl --csv blind.csv")]
pub struct Args {
    #[command(flatten)]
    rows: MayKeepRows,

    #[command(flatten)]
    photographs: Photographs,

    /// Side in pixels of the estimated kernel, odd
    #[arg(long, default_value_t = 15, value_name = "PIXELS", value_parser = clap::value_parser!(u16).range(3..=99))]
    side: u16,

    #[command(flatten)]
    outputs: Outputs,
}

/// # Errors
/// No photographs, files that cannot be written, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    if args.side.is_multiple_of(2) {
        return Err(Error::message(format!(
            "--side {}: must be odd, so that the kernel has a middle",
            args.side
        )));
    }
    let files = Files::new(ui).reads_pictures_of(args.photographs.folder.path()?);
    args.rows.of(args.outputs.of(files)).check()?;
    let (photos, notes) = args.photographs.load(ui)?;
    notes.iter().for_each(|note| ui.note(note));
    let settings = Settings { side: args.side.into(), ..Settings::default() };
    let mut experiment = DrawnBlurs::new(&photos, settings);
    let journal = measured(&mut experiment, args.rows.rows.as_ref(), &args.rows.part, ui)?;
    tell::<KnownBlurs>(&journal, &args.outputs, ui)
}
