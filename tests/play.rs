//! `edof play` over HTTP: who is answered, and that every figure is that of the commands.

use crate::support::Place;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, Stdio};

/// The program with its page, ended when it is dropped.
struct Page {
    program: Child,
    address: SocketAddr,
    token: String,
}

/// Status, headers and body of an answer.
struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    fn json(&self) -> Value {
        assert_eq!(self.status, 200, "{}", String::from_utf8_lossy(&self.body));
        serde_json::from_slice(&self.body).unwrap()
    }

    /// The text of the answer with pictures, and the bytes of each picture.
    fn pictures(&self) -> (Value, Vec<Vec<u8>>) {
        assert_eq!(self.status, 200, "{}", String::from_utf8_lossy(&self.body));
        let (length, rest) = self.body.split_at(4);
        let (text, pixels) = rest.split_at(u32::from_le_bytes(length.try_into().unwrap()) as usize);
        let text: Value = serde_json::from_slice(text).unwrap();
        let size = 4 * text["width"].as_u64().unwrap() * text["height"].as_u64().unwrap();
        assert_eq!(pixels.len() as u64, size * text["pictures"].as_array().unwrap().len() as u64);
        (text, pixels.chunks(size as usize).map(<[u8]>::to_vec).collect())
    }
}

impl Page {
    fn open(place: &Place, options: &str) -> Self {
        let mut program = place.command(&format!("play {options}"));
        let mut program = program.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(program.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.split_whitespace().next().unwrap();
        let (host, path) = address.strip_prefix("http://").unwrap().split_once('/').unwrap();
        let token = path.strip_suffix('/').unwrap().to_owned();
        Self { program, address: host.parse().unwrap(), token }
    }

    /// Sends a whole request and reads the answer to its end.
    fn sent(&self, request: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.write_all(request).unwrap();
        let mut answer = vec![];
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head, body: answer[end + 4..].to_vec() }
    }

    fn ask(&self, method: &str, path: &str, headers: &str, body: &[u8]) -> Answer {
        let host =
            if headers.contains("Host:") { String::new() } else { format!("Host: {}\r\n", self.address) };
        let length = body.len();
        let head = format!(
            "{method} {path} HTTP/1.1\r\n{host}{headers}Connection: close\r\nContent-Length: {length}\r\n\r\n"
        );
        self.sent(&[head.as_bytes(), body].concat())
    }

    fn get(&self, path: &str) -> Answer {
        self.ask("GET", &format!("/{}/{path}", self.token), "", b"")
    }

    fn post(&self, path: &str, state: &Value) -> Answer {
        self.ask("POST", &format!("/{}/{path}", self.token), "", state.to_string().as_bytes())
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn state(page: &Page) -> Value {
    let setup = page.get("setup").json();
    json!({
        "scene": "chart", "camera": setup["camera"], "psi": 2.0, "stops": 0.0, "electrons": 3000.0, "read_noise_e": 2.5, "seed": 3,
        "network": null, "layers": null, "stride": 8, "clear": { "stops": 1.0, "focus_psi": 4.0 },
    })
}

fn error(answer: &Answer) -> String {
    let text: Value = serde_json::from_slice(&answer.body).unwrap();
    text["error"].as_str().unwrap().to_owned()
}

#[test]
fn only_the_page_of_the_printed_address_is_answered() {
    let place = Place::new();
    let page = Page::open(&place, "");
    assert_eq!((page.address.ip().to_string().as_str(), page.token.len()), ("127.0.0.1", 32));
    let root = format!("/{}/", page.token);
    let first = page.get("");
    assert_eq!(first.status, 200);
    assert!(
        first.head.contains("content-security-policy: default-src 'none'; script-src 'self';"),
        "{}",
        first.head
    );
    let html = String::from_utf8(first.body).unwrap();
    for file in ["style.css", "main.js", "controls.js", "server.js", "viewer.js", "plots.js", "training.js"] {
        assert_eq!(page.get(file).status, 200, "{file}");
    }
    assert!(!html.contains("://"), "something from elsewhere");
    let other = Page::open(&place, "");
    assert_ne!(other.token, page.token);
    let port = page.address.port();
    let refused: [(u16, &str, &str, String); 11] = [
        (403, "GET", "/", String::new()),
        (403, "GET", &format!("/{}/", other.token), String::new()),
        (403, "GET", &root[..32], String::new()),
        (403, "GET", &root, "Host: edof.example\r\n".into()),
        (403, "GET", &root, format!("Host: edof.example:{port}\r\n")),
        (403, "POST", &format!("{root}setup"), "Origin: http://edof.example\r\n".into()),
        (403, "POST", &format!("{root}setup"), "Origin: null\r\n".into()),
        (405, "POST", &format!("{root}setup"), format!("Origin: http://127.0.0.1:{port}\r\n")),
        (405, "GET", &format!("{root}train"), String::new()),
        (404, "GET", &format!("{root}../../etc/passwd"), String::new()),
        (400, "GET", &format!("{root}weights/../../etc/passwd"), String::new()),
    ];
    for (status, method, path, headers) in refused {
        let answer = page.ask(method, path, &headers, b"");
        assert_eq!(answer.status, status, "{method} {path} {headers}");
        assert!(!error(&answer).is_empty());
    }
}

#[test]
fn over_ssh_the_tunnel_to_the_page_is_named() {
    let place = Place::new();
    let mut command = place.command("play");
    let pipes = command.env("SSH_CONNECTION", "192.0.2.1 50000 192.0.2.2 22").stdout(Stdio::piped());
    let mut program = pipes.stderr(Stdio::piped()).spawn().unwrap();
    let [mut address, mut remark] = [String::new(), String::new()];
    BufReader::new(program.stdout.as_mut().unwrap()).read_line(&mut address).unwrap();
    BufReader::new(program.stderr.as_mut().unwrap()).read_line(&mut remark).unwrap();
    program.kill().unwrap();
    program.wait().unwrap();
    let port = address.strip_prefix("http://127.0.0.1:").unwrap().split('/').next().unwrap();
    assert!(remark.contains(&format!("'ssh -L {port}:127.0.0.1:{port} HOST'")), "{remark}");
}

#[test]
fn what_is_larger_than_the_limits_is_refused_before_it_is_read() {
    let place = Place::new();
    let page = Page::open(&place, "");
    for (path, bytes, words) in [("photograph", 65 << 20, "65536 kB"), ("pictures", 65 << 10, "64 kB")] {
        let (address, token) = (page.address, &page.token);
        let head = format!("POST /{token}/{path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n");
        let stated = page.sent(format!("{head}Content-Length: {bytes}\r\n\r\n").as_bytes());
        assert_eq!((stated.status, error(&stated)), (413, format!("larger than {words}")), "{path}");
    }
    // Without a length, as it comes.
    let head = format!(
        "POST /{}/lens HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nTransfer-Encoding: chunked\r\n\r\n",
        page.token, page.address
    );
    let chunk = format!("10001\r\n{}\r\n", "x".repeat(0x10001));
    assert_eq!(page.sent((head + &chunk).as_bytes()).status, 413);
}

#[test]
fn a_state_that_cannot_be_is_refused_in_one_line() {
    let place = Place::new();
    let page = Page::open(&place, "");
    let good = state(&page);
    let rows = [
        ("/scene", json!("sea"), "scene 'sea': expected chart, labels or leaves"),
        ("/psi", json!(900.0), "psi 900: must lie within 200 of the focus of camera ring-outer, at 4.44"),
        ("/stops", json!(6.0), "stops 6: must be from 0 to 5"),
        ("/electrons", json!(0.0), "electrons 0: must be from 1 to 1000000000"),
        ("/read_noise_e", json!(-1.0), "read_noise_e -1: must be from 0 to 1000000"),
        ("/network", json!("none"), "network 'none': expected one of "),
        ("/layers", json!(5), "layers 5: must be 2 to 4, the layers of this network"),
        ("/stride", json!(3), "stride 3: must be 2, 4 or 8"),
        ("/camera/rings/0/outer", json!(0.1), "ring"),
        ("/camera/focal_length_mm", json!(-3.0), "camera ring-outer: focal_length_mm is -3"),
        ("/clear/stops", json!(-1.0), "stops -1: must be from 0 to 5"),
        ("/camera", json!(7), "camera"),
    ];
    for (field, value, words) in rows {
        let mut wrong = good.clone();
        *wrong.pointer_mut(field).unwrap() = value;
        for path in ["pictures", "depth"] {
            let answer = page.post(path, &wrong);
            let line = error(&answer);
            assert_eq!(answer.status, 400, "{field}");
            assert!(line.contains(words) && !line.contains('\n'), "{field}: {line}");
        }
    }
    for body in ["", "{}", "[", "\u{e9}"] {
        let answer = page.ask("POST", &format!("/{}/pictures", page.token), "", body.as_bytes());
        assert_eq!(answer.status, 400, "{body}");
    }
    assert_eq!(
        error(&page.ask("POST", &format!("/{}/photograph", page.token), "", b"no photograph")),
        "photograph: not a PNG, JPEG, WebP, TIFF, BMP, PPM or PGM file"
    );
    assert_eq!(page.post("pictures", &good).status, 200, "refusals change nothing");
}

/// The words of a command's JSON.
fn run(place: &Place, line: &str) -> Value {
    let done = place.edof(&format!("{line} --json")).done();
    serde_json::from_str(&done.out).unwrap_or_else(|e| panic!("{line}: {e}: {}", done.out))
}

/// PSNR of a picture by capture, reconstruct and compare.
fn by_commands(place: &Place, lens: &Value, seed: u64, rest: &str) -> f64 {
    place.write("page.json", lens["camera"].to_string());
    let (psi, noise, name) =
        (&lens["psi"], lens["noise"].as_str().unwrap(), lens["network"]["name"].as_str().unwrap());
    let taken = format!(
        "capture chart --size 512x384 --camera page.json --psi {psi} --noise {noise} --seed {seed} --out raw.png --sharp sharp.png"
    );
    place.edof(&taken).done();
    place
        .edof(&format!("reconstruct raw.png --float --weights {name} --out out.png --bits 16 --force {rest}"))
        .done();
    run(place, "compare sharp.png out.png")["psnr_db"].as_f64().unwrap()
}

fn number(answer: &Value, id: &str) -> f64 {
    let all = answer["pictures"].as_array().unwrap();
    all.iter().find(|picture| picture["id"] == id).unwrap()["psnr_db"].as_f64().unwrap()
}

#[test]
fn every_figure_is_that_of_the_commands() {
    let place = Place::new();
    let page = Page::open(&place, "");
    let state = state(&page);
    let (text, pictures) = page.post("pictures", &state).pictures();
    assert_eq!(pictures.len(), 5);
    // Sixteen bits of the files are all that differs.
    for (id, lens, picture) in [("network", "lens", 3), ("clear", "clear", 4)] {
        let db = by_commands(&place, &text[lens], 3, "--stride 8");
        assert!((number(&text, id) - db).abs() < 2e-3, "{id}: {} {db}", number(&text, id));
        let file = edof_io::photo::load(&place.path("out.png")).unwrap();
        let shown = edof_study::report::picture::rgba(&file, edof_core::Tone::Linear);
        assert!(pictures[picture].iter().zip(&shown).all(|(a, b)| a.abs_diff(*b) <= 1), "{id}");
    }
    let depth = page.post("depth", &state).json();
    for id in ["network", "clear", "demosaiced"] {
        assert_eq!(depth[id].as_f64(), Some(number(&text, id)));
    }
    let lens = page.post("lens", &json!({ "camera": state["camera"], "psi": 2.0, "stops": 0.0 })).json();
    let optics = run(&place, "optics ring-outer --psi 2");
    assert_eq!(lens["contrast_quarter_cutoff"], optics["depths"][0]["contrast_quarter_cutoff"]);
    assert_eq!(lens["kernel_side"], optics["depths"][0]["kernel_side"]);
    assert_eq!(lens["centroid"], optics["depths"][0]["centroid"]);
    let advice = page
        .post("advice", &json!({ "camera": state["camera"], "electrons": 3000.0, "read_noise_e": 2.5 }))
        .json();
    let said = place.edof("optics advise ring-outer --electrons 3000 --json advice.json").done().out;
    let lines: Vec<&str> =
        advice["lines"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
    assert!(said.starts_with(&lines.join("\n")), "{said}");
    let advised: Value = serde_json::from_slice(&std::fs::read(place.path("advice.json")).unwrap()).unwrap();
    let best = std::iter::once(&advised["advised"])
        .chain(advised["others"].as_array().unwrap())
        .find(|one| one["lens"] == "clear")
        .unwrap();
    assert_eq!(advice["clear"], json!({ "stops": best["stops"], "focus_psi": best["focus_psi"] }));
}

#[test]
fn every_position_changes_what_it_should_and_nothing_else() {
    let place = Place::new();
    let page = Page::open(&place, "");
    let good = state(&page);
    let shot = |state: &Value| page.post("pictures", state).pictures();
    let (text, first) = shot(&good);
    assert_eq!(shot(&good).1, first);
    assert_eq!(text["lens"]["network"]["differs"], json!([]));
    // Which of sharp, raw, demosaiced, network and clear change.
    let rows = [
        ("/scene", json!("leaves"), [true; 5]),
        ("/psi", json!(2.5), [false, true, true, true, true]),
        ("/camera/focus_psi", json!(3.0), [false, true, true, true, false]),
        ("/stops", json!(1.0), [false, true, true, true, false]),
        ("/electrons", json!(1500.0), [false, true, true, true, true]),
        ("/read_noise_e", json!(9.0), [false, true, true, true, true]),
        ("/seed", json!(4), [false, true, true, true, true]),
        ("/camera/rings/0/inner", json!(0.5), [false, true, true, true, false]),
        ("/camera/rings/0/delay/phase/rad", json!(2.0), [false, true, true, true, false]),
        ("/network", json!("edof-t4w12-outer-light-dark"), [false, false, false, true, false]),
        ("/layers", json!(2), [false, false, false, true, false]),
        ("/stride", json!(4), [false, false, false, true, true]),
        ("/clear/stops", json!(2.0), [false, false, false, false, true]),
    ];
    for (field, value, changes) in rows {
        let mut moved = good.clone();
        *moved.pointer_mut(field).unwrap() = value;
        let (text, pictures) = shot(&moved);
        let found: Vec<bool> = pictures.iter().zip(&first).map(|(a, b)| a != b).collect();
        assert_eq!(found, changes, "{field}");
        // Another lens than the network's is said.
        let is_foreign = field.starts_with("/camera") || field == "/stops";
        assert_eq!(text["lens"]["network"]["differs"] != json!([]), is_foreign, "{field}");
    }
}

#[test]
fn a_photograph_is_taken_from_a_file_and_from_the_page() {
    let place = Place::new();
    place.photo("given.png", 300, 200);
    let page = Page::open(&place, "given.png --camera clear-mid");
    let mut state = state(&page);
    assert_eq!(state["camera"]["name"], "clear-mid");
    state["scene"] = json!("photograph");
    let (text, given) = page.post("pictures", &state).pictures();
    assert_eq!((&text["width"], &text["height"]), (&json!(300), &json!(200)));
    place.photo("other.png", 1100, 900);
    let bytes = std::fs::read(place.path("other.png")).unwrap();
    let taken = page.ask("POST", &format!("/{}/photograph", page.token), "", &bytes).json();
    assert_eq!(taken["notes"], json!([]));
    let (text, other) = page.post("pictures", &state).pictures();
    assert_eq!((&text["width"], &text["height"]), (&json!(512), &json!(384)));
    assert_ne!(given[0].len(), other[0].len());
    place.photo("small.png", 40, 40);
    let bytes = std::fs::read(place.path("small.png")).unwrap();
    let small = page.ask("POST", &format!("/{}/photograph", page.token), "", &bytes);
    assert_eq!(
        (small.status, error(&small)),
        (400, "photograph: 40x40, both sides must be at least 64 pixels".into())
    );
}

/// Waits until how the training goes is what is wanted.
fn when(page: &Page, wanted: impl Fn(&Value) -> bool) -> Value {
    let end = std::time::Instant::now() + std::time::Duration::from_secs(600);
    loop {
        let status = page.get("training").json();
        if wanted(&status) {
            return status;
        }
        assert!(std::time::Instant::now() < end, "still {status}");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

fn end(page: &Page) -> Value {
    when(page, |status| status["is"] != "running")
}

/// A lens that no network was trained for: a clear one that is closed, so that the blur is small and small photographs are large enough.
fn foreign(page: &Page) -> Value {
    let presets = page.get("setup").json()["presets"].clone();
    let clear = presets.as_array().unwrap().iter().find(|camera| camera["name"] == "clear-mid").unwrap();
    let mut state = state(page);
    state["camera"] = clear.clone();
    state["stops"] = json!(3.0);
    state["psi"] = json!(1.0);
    state
}

#[test]
fn a_training_beside_the_pictures_makes_the_network_of_the_command() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a1.png", 256, 192);
    place.photo("photos/a2.png", 192, 256);
    let page = Page::open(&place, "--images photos --photos all --steps 8");
    assert_eq!(page.get("training").json(), json!({ "is": "none" }));
    let state = foreign(&page);
    let (before, _) = page.post("pictures", &state).pictures();
    assert_ne!(before["lens"]["network"]["differs"], json!([]));
    assert_eq!(page.post("train", &state).json()["is"], "running");
    assert_eq!(error(&page.post("train", &state)), "a training is running; wait for its end, or cancel it");
    assert_eq!(page.post("pictures", &state).status, 200);
    let done = end(&page);
    assert_eq!((&done["is"], &done["network"]), (&json!("done"), &json!("page-1")), "{done}");
    // It is the one for this lens and noise from now on.
    let (text, _) = page.post("pictures", &state).pictures();
    let own = &text["lens"]["network"];
    assert_eq!((&own["name"], &own["weights"]), (&json!("page-1"), &json!("page-1.safetensors")));
    assert_eq!((&own["differs"], &own["is_noise_known"]), (&json!([]), &json!(true)));
    let listed = page.get("setup").json();
    assert_eq!(listed["networks"].as_array().unwrap().last().unwrap()["name"], "page-1");
    // In other noise it is still the only one for this lens; another lens has another one.
    let network = |field: &str, value: f64| {
        let mut moved = state.clone();
        moved[field] = json!(value);
        page.post("pictures", &moved).pictures().0["lens"]["network"].clone()
    };
    let noisy = network("electrons", 300.0);
    assert_eq!((&noisy["name"], &noisy["is_noise_known"]), (&json!("page-1"), &json!(false)));
    let other = network("stops", 2.0);
    assert!(other["name"] != "page-1" && other["differs"] != json!([]), "{other}");
    // Its file does what the page shows, and the command makes the same weights.
    place.write("page-1.safetensors", page.get("weights/page-1.safetensors").body);
    let mut lens = text["lens"].clone();
    lens["network"]["name"] = lens["network"]["weights"].clone();
    let db = by_commands(&place, &lens, 3, "--stride 8");
    assert!((number(&text, "network") - db).abs() < 2e-3, "{} {db}", number(&text, "network"));
    assert_ne!(number(&text, "network"), number(&before, "network"));
    let saved = edof_network::weight_file::load_network(&place.path("page-1.safetensors")).unwrap();
    let command = done["command"].as_str().unwrap();
    assert_eq!(saved.origin.provenance.command, command);
    let again = command.strip_prefix("edof ").unwrap().replace("page-1", "again");
    place.edof(&format!("{again} --images photos --photos all --no-cache")).done();
    let again = edof_network::weight_file::load_network(&place.path("again.safetensors")).unwrap();
    let weights = edof_network::float::parameters::flatten;
    assert!(weights(&saved) == weights(&again), "other weights than those of {command}");
}

#[test]
fn a_training_is_cancelled_and_one_that_fails_says_why() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    let page = Page::open(&place, "--images photos --photos all --steps 1000000");
    let state = foreign(&page);
    page.post("train", &state).json();
    let failed = end(&page);
    assert_eq!(failed["is"], "failed");
    assert!(failed["error"].as_str().unwrap().contains("photos"), "{failed}");
    place.photo("photos/a1.png", 256, 192);
    page.post("train", &state).json();
    let steps = when(&page, |status| status["part"] == "steps" || status["is"] != "running");
    assert_eq!(steps["is"], "running", "{steps}");
    page.post("cancel", &json!({}));
    assert_eq!(end(&page), json!({ "is": "cancelled" }));
    let networks = page.get("setup").json()["networks"].to_string();
    assert!(!networks.contains("page-"), "{networks}");
    let mut wrong = state;
    wrong["electrons"] = json!(0.0);
    assert_eq!(page.post("train", &wrong).status, 400);
}

#[test]
fn a_port_that_is_taken_and_a_signal_end_the_program() {
    let place = Place::new();
    let mut page = Page::open(&place, "");
    let port = page.address.port();
    place
        .edof(&format!("play --port {port}"))
        .refused(&[&format!("--port {port}: cannot listen on 127.0.0.1: "), "in use"]);
    place.edof("play none.png").refused(&["none.png: cannot read"]);
    place.edof("play --camera none").refused(&["camera 'none': no such file"]);
    let id = page.program.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(page.program.wait().unwrap().code(), Some(0));
}
