//! `edof play`: a page to look through a lens whose parameters are moved.
//!
//! | what | file |
//! |---|---|
//! | connections, and who may speak | [`server`], [`guard`] |
//! | what a page asks for | [`state`] |
//! | pictures and figures of a state | [`engine`], [`pictures`], [`networks`] |
//! | a short training for the page's lens | [`training`] |
//! | the page itself | `page/` |

mod engine;
mod guard;
mod networks;
mod pictures;
mod server;
mod state;
mod training;

use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, Lens};
use crate::ui::Ui;
use edof_io::photos::Selection;
use engine::Engine;
use guard::Guard;
use serde_json::json;
use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use training::Training;

/// Open a page with sliders for depth, lens, light and network, whose pictures and figures follow at once, until Ctrl-C
///
/// Prints an address of this computer (127.0.0.1) for a browser, with a random token that is part of it; Ctrl-C or a signal TERM ends the page, closing
/// the browser does not. On a remote computer run it by 'ssh -t -L 8080:127.0.0.1:8080 HOST edof play --port 8080', and open the address on yours.
///
/// The page shows one picture sharp, raw, demosaiced, behind this lens with its network, and
/// behind the clear lens at its best stop with a network for clear lenses, and plots PSFs, MTF, contrast and dB over depth. Its figures are those of
/// capture, reconstruct, compare and optics, and the page states these commands. For a lens that no network was trained for it offers a short training.
/// Nothing is loaded from elsewhere or sent elsewhere (docs/play.md).
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof play
  edof play photo.jpg --camera mine.json
  edof play --images photos/ --steps 4000
  edof play --port 8080 --json address.json")]
pub struct Args {
    /// Photograph to begin with: PNG, JPEG, WebP, TIFF, BMP, PPM or PGM [default: a built-in scene]
    #[arg(value_name = "PHOTO")]
    photo: Option<PathBuf>,

    /// Camera to begin with: a preset (clear, clear-mid, clear-closed, ring-2015, ring-2018, ring-depth-2018, ring-outer) or a JSON file
    #[arg(long, default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    /// Port of 127.0.0.1 [default: a free one]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    port: Option<u16>,

    /// Folder of photographs that trainings learn from; repeatable [default: those of edof train]
    #[arg(long, value_name = "DIR")]
    images: Vec<PathBuf>,

    /// Photographs of the folder to use: train, all, or numbers as in 1,2 [default: all except the study's test photographs]
    #[arg(long)]
    photos: Option<Selection>,

    /// Steps of a training, of 512 windows each
    #[arg(long, default_value_t = 2000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
}

/// # Errors
/// A camera or photograph that cannot be used, a port that is taken.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let Lens { camera, files } = lens::resolve(&args.camera, None)?;
    let files = Files::new(ui).reads_all(files).reads_all(&args.photo);
    args.images.iter().fold(files, Files::reads_pictures_of).check()?;
    ui.used(camera.input());
    let mut engine = Engine::new(camera)?;
    if let Some(file) = &args.photo {
        engine.take(&edof_io::picture::read(file)?, file)?.into_iter().for_each(|note| ui.note(note));
    }
    let port = args.port.unwrap_or(0);
    let of_port = |e: std::io::Error| {
        let reason = edof_core::storage::atomic::reason(&e);
        Error::message(format!(
            "--port {port}: cannot listen on 127.0.0.1: {reason}; name another port, or leave --port out"
        ))
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(of_port)?;
    let port = listener.local_addr()?.port();
    let guard = Guard::new(port)?;
    ui.say(format!("{}  (open the whole address in a browser; Ctrl-C ends it)", guard.address()))?;
    if std::env::var_os("SSH_CONNECTION").is_some() {
        ui.note(format!(
            "this computer is reached by ssh: run 'ssh -L {port}:127.0.0.1:{port} HOST' on yours, and open the address there"
        ));
    }
    ui.json(&json!({ "address": guard.address() }))?;
    let training = Training::new(args.images, args.photos, args.steps, ui.provenance());
    server::serve(listener, guard, engine, training)
}
