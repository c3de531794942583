//! Connections of the page: HTTP/1.1, one thread for all of them, computing on others.

use super::engine::{Engine, advice};
use super::guard::{Guard, Refusal};
use super::state::{self, AdviceState, LensState, State};
use super::training::{Training, train};
use crate::error::Error;
use crate::interrupt;
use http_body_util::{BodyExt, Full, LengthLimitError, Limited};
use hyper::body::{Bytes, Incoming};
use hyper::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use serde_json::json;
use std::convert::Infallible;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often Ctrl-C is looked for.
const POLL: Duration = Duration::from_millis(100);
/// Most bytes of a photograph, and of a state.
const MAX_PHOTO: usize = 64 << 20;
const MAX_STATE: usize = 64 << 10;
/// The page loads nothing but its own files, and talks to nobody else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Files of the page: name, type, text.
const FILES: [(&str, &str, &str); 8] = [
    ("", "text/html", include_str!("page/index.html")),
    ("style.css", "text/css", include_str!("page/style.css")),
    ("main.js", "text/javascript", include_str!("page/main.js")),
    ("controls.js", "text/javascript", include_str!("page/controls.js")),
    ("server.js", "text/javascript", include_str!("page/server.js")),
    ("viewer.js", "text/javascript", include_str!("page/viewer.js")),
    ("training.js", "text/javascript", include_str!("page/training.js")),
    ("plots.js", "text/javascript", include_str!("page/plots.js")),
];

/// What is computed, by name, and where networks that the page trained are.
const ASKED: [&str; 9] =
    ["setup", "pictures", "depth", "lens", "advice", "photograph", "training", "train", "cancel"];
const WEIGHTS: &str = "weights/";

/// What all connections share.
pub struct Site {
    guard: Guard,
    engine: Mutex<Engine>,
    pub training: Training,
}

/// An answer: its type and its bytes.
type Answer = (&'static str, Vec<u8>);

/// Answers requests until Ctrl-C.
///
/// # Errors
/// A system that gives no more sockets.
pub fn serve(
    listener: std::net::TcpListener,
    guard: Guard,
    engine: Engine,
    training: Training,
) -> Result<(), Error> {
    listener.set_nonblocking(true)?;
    let site = Arc::new(Site { guard, engine: Mutex::new(engine), training });
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let done = runtime.block_on(accept(listener, site));
    // What is still being computed is of no use.
    runtime.shutdown_background();
    done
}

async fn accept(listener: std::net::TcpListener, site: Arc<Site>) -> Result<(), Error> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    while interrupt::check().is_ok() {
        let Ok(accepted) = tokio::time::timeout(POLL, listener.accept()).await else { continue };
        let (stream, _) = accepted?;
        let site = Arc::clone(&site);
        tokio::spawn(async move {
            let service = service_fn(move |request| respond(Arc::clone(&site), request));
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .serve_connection(TokioIo::new(stream), service);
            // A connection that breaks off is the browser's concern.
            let _ = connection.await;
        });
    }
    Ok(())
}

async fn respond(site: Arc<Site>, request: Request<Incoming>) -> Result<Response<Full<Bytes>>, Infallible> {
    let (status, (kind, bytes)) = match answer(site, request).await {
        Ok(answer) => (StatusCode::OK, answer),
        Err((status, line)) => (status, ("application/json", json!({ "error": line }).to_string().into())),
    };
    let mut response = Response::new(Full::new(Bytes::from(bytes)));
    *response.status_mut() = status;
    let headers = [
        (CONTENT_TYPE, kind),
        (CACHE_CONTROL, "no-store"),
        (CONTENT_SECURITY_POLICY, POLICY),
        (REFERRER_POLICY, "no-referrer"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    for (name, value) in headers {
        response.headers_mut().insert(name, hyper::header::HeaderValue::from_static(value));
    }
    Ok(response)
}

async fn answer(site: Arc<Site>, request: Request<Incoming>) -> Result<Answer, Refusal> {
    let path = site.guard.path(request.uri(), request.headers())?.to_owned();
    let is_page = FILES.iter().find(|(name, ..)| *name == path);
    match (request.method(), path.as_str(), is_page) {
        (&Method::GET, _, Some((_, kind, text))) => Ok((kind, text.as_bytes().to_vec())),
        (&Method::GET, "setup", _) => {
            computed(site, vec![], |site, _| json_of(&site.engine().setup(&site.training)?)).await
        }
        (&Method::GET, "training", _) => {
            computed(site, vec![], |site, _| json_of(&site.training.status())).await
        }
        (&Method::GET, path, None) if path.starts_with(WEIGHTS) => {
            let file = path[WEIGHTS.len()..].to_owned();
            computed(site, vec![], move |site, _| {
                Ok(("application/octet-stream", site.engine().weights(&file)?))
            })
            .await
        }
        (&Method::POST, "pictures" | "depth" | "lens" | "advice", _) => {
            let body = body(request, MAX_STATE).await?;
            computed(site, body, move |site, body| posted(site, &path, body)).await
        }
        (&Method::POST, "photograph", _) => {
            let body = body(request, MAX_PHOTO).await?;
            let file = Path::new("photograph");
            computed(site, body, |site, body| json_of(&json!({ "notes": site.engine().take(body, file)? })))
                .await
        }
        (&Method::POST, "train", _) => {
            let body = body(request, MAX_STATE).await?;
            computed(site, body, |site, body| {
                train(site, &state::read(body)?)?;
                json_of(&site.training.status())
            })
            .await
        }
        (&Method::POST, "cancel", _) => {
            computed(site, vec![], |site, _| {
                site.training.cancel();
                json_of(&site.training.status())
            })
            .await
        }
        (_, path, page) if page.is_some() || path.starts_with(WEIGHTS) || ASKED.contains(&path) => {
            Err((StatusCode::METHOD_NOT_ALLOWED, format!("{}: not answered here", request.method())))
        }
        _ => Err((StatusCode::NOT_FOUND, format!("{path}: no such page"))),
    }
}

/// What a state is answered.
fn posted(site: &Site, path: &str, body: &[u8]) -> Result<Answer, Error> {
    match path {
        "pictures" => {
            let state: State = state::read(body)?;
            Ok(("application/octet-stream", site.engine().pictures(&state)?))
        }
        "depth" => {
            let state: State = state::read(body)?;
            json_of(&site.engine().depth_db(&state)?)
        }
        "lens" => {
            let state: LensState = state::read(body)?;
            json_of(&site.engine().lens(&state)?)
        }
        _ => {
            let state: AdviceState = state::read(body)?;
            json_of(&advice(&state)?)
        }
    }
}

fn json_of(value: &impl serde::Serialize) -> Result<Answer, Error> {
    Ok(("application/json", serde_json::to_vec(value)?))
}

impl Site {
    /// The engine, for one request at a time. A request that failed left it as it was.
    pub fn engine(&self) -> std::sync::MutexGuard<'_, Engine> {
        self.engine.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Computes an answer beside the connections.
async fn computed(
    site: Arc<Site>,
    body: Vec<u8>,
    compute: impl FnOnce(&Arc<Site>, &[u8]) -> Result<Answer, Error> + Send + 'static,
) -> Result<Answer, Refusal> {
    let task = tokio::task::spawn_blocking(move || compute(&site, &body).map_err(|e| e.to_string()));
    match task.await {
        Ok(answer) => answer.map_err(|line| (StatusCode::BAD_REQUEST, line)),
        Err(failed) => Err((StatusCode::INTERNAL_SERVER_ERROR, failed.to_string())),
    }
}

/// The bytes of a request.
async fn body(request: Request<Incoming>, most: usize) -> Result<Vec<u8>, Refusal> {
    let too_large = || (StatusCode::PAYLOAD_TOO_LARGE, format!("larger than {} kB", most >> 10));
    // Without waiting for what would be thrown away.
    let length = hyper::body::Body::size_hint(request.body()).lower();
    if length > most as u64 {
        return Err(too_large());
    }
    match Limited::new(request.into_body(), most).collect().await {
        Ok(body) => Ok(body.to_bytes().to_vec()),
        Err(error) if error.is::<LengthLimitError>() => Err(too_large()),
        Err(error) => Err((StatusCode::BAD_REQUEST, error.to_string())),
    }
}
