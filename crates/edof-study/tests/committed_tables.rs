//! The rows that README.md and docs/results.md quote are those of docs/results; each page is what its compact table says; tables and pages
//! state the clean revision that measured them; and a page of networks that ship is of the weights that ship.

use edof_core::Stride;
use edof_core::storage::digest::sha256;
use edof_io::photos::{HELD_BACK, OF_HELD_BACK};
use edof_network::weight_file;
use edof_study::aperture::Aperture;
use edof_study::aperture::networks::ApertureNetworks;
use edof_study::journal::{Header, Journal, Line, Maker, Mixing, RowsFile};
use edof_study::knobs::Knobs;
use edof_study::known_blurs::KnownBlurs;
use edof_study::lens_networks::LensNetworks;
use edof_study::made::{Made, OLD, machines};
use edof_study::methods::nets::Net;
use edof_study::methods::nets_by_noise;
use edof_study::speed::Speed;
use edof_study::study_report::StudyReport;
use edof_study::summary::Study;
use edof_study::tolerances::Tolerances;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).to_owned()
}

fn read(file: &str) -> String {
    let path = project().join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// What stands between two texts.
fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let rest = text.split_once(start).unwrap_or_else(|| panic!("no '{start}'")).1;
    rest.split_once(end).unwrap_or_else(|| panic!("no '{end}'")).0
}

/// Whether a revision is a bare commit.
fn is_clean(revision: &str) -> bool {
    revision.len() == 40 && revision.chars().all(|c| c.is_ascii_digit() || ('a'..='f').contains(&c))
}

/// The compact table of a page: what its file of rows states, and the rows as far as the page uses them (scripts/table.py).
struct Table {
    maker: Maker,
    file: RowsFile,
    rows: Vec<serde_json::Value>,
}

/// Reads the compact table of a page; nothing of a table of another form.
fn table(name: &str) -> Option<Table> {
    Table::parsed(&read(&format!("docs/results/{name}.csv")))
}

impl Table {
    fn parsed(text: &str) -> Option<Self> {
        let mut remarks = text.lines().map_while(|line| line.strip_prefix("# "));
        let header: Header = serde_json::from_str(remarks.next()?).unwrap();
        let file = serde_json::from_str(remarks.next().unwrap()).unwrap();
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
        let names = reader.headers().unwrap().clone();
        let row = |record: csv::StringRecord| {
            let mut row = serde_json::Map::new();
            for (name, cell) in names.iter().zip(&record).filter(|(_, cell)| !cell.is_empty()) {
                // JSON where it is no plain text.
                let value = serde_json::from_str(cell).unwrap_or_else(|_| cell.into());
                match name.split_once('.') {
                    Some((outer, inner)) => row.entry(outer).or_insert_with(|| json!({}))[inner] = value,
                    None => drop(row.insert(name.to_owned(), value)),
                }
            }
            serde_json::Value::Object(row)
        };
        let rows = reader.records().map(|record| row(record.unwrap())).collect();
        Some(Self { maker: header.maker, file, rows })
    }

    /// The rows of a study, as far as the table holds them.
    fn rows_of<T: StudyReport>(&self) -> Vec<T::Row> {
        assert_eq!(self.rows.len(), self.file.rows, "not all rows of the file");
        self.rows.iter().map(|row| serde_json::from_value(row.clone()).unwrap()).collect()
    }
}

/// Revisions that a result file states; none where it states none.
fn revisions(file: &str) -> Vec<String> {
    let (stem, ending) = file.rsplit_once('.').unwrap();
    match ending {
        "md" => {
            let text = read(&format!("docs/results/{file}"));
            text.split("revision `").skip(1).map(|rest| rest.split('`').next().unwrap().to_owned()).collect()
        }
        "csv" => match table(stem).map(|table| table.maker) {
            Some(Maker::Program(program)) => vec![program.revision],
            Some(Maker::Old { .. }) => vec![OLD.to_owned()],
            // Of pictures: the file of rows was never here, and the page beside it states the revision.
            None => revisions(&format!("{stem}.md")),
        },
        other => panic!("docs/results/{file}: nobody knows where .{other} states its revision"),
    }
}

/// Results of a dirty or unknown tree cannot be committed, nor a page of several revisions.
#[test]
fn every_result_is_of_one_clean_revision() {
    let results = std::fs::read_dir(project().join("docs/results")).unwrap();
    let files = results.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut pages: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in files {
        let own = revisions(&file);
        assert!(!own.is_empty(), "docs/results/{file}: states no revision; remake it (scripts/results.sh)");
        for revision in &own {
            assert!(is_clean(revision), "docs/results/{file}: '{revision}' is no clean revision");
        }
        pages.entry(file.rsplit_once('.').unwrap().0.to_owned()).or_default().extend(own);
    }
    for (page, revisions) in pages {
        assert_eq!(revisions.len(), 1, "docs/results/{page}: page and rows are remade together");
    }
}

/// A network that ships, with its weights in fixed point.
fn shipped(name: &str) -> Net {
    let file = |ending: &str| project().join(format!("weights/{name}{ending}"));
    let hash = |file: &Path| weight_file::parse_hash(std::fs::read(file).unwrap(), file).unwrap();
    let (float, fixed) = (file(".safetensors"), file(".fixed.safetensors"));
    let words = (weight_file::load_fixed(&fixed).unwrap(), hash(&fixed));
    let network = weight_file::load_network(&float).unwrap();
    let (net, obstacle) = Net::new(name, network, &hash(&float), Some(words), Stride::PATCH);
    assert_eq!(obstacle, None);
    net
}

/// SHA-256 of the weights of each method that a command names, as far as its networks ship.
fn hashes_of_shipped(command: &str) -> BTreeMap<String, String> {
    let ships = |name: &&str| project().join(format!("weights/{name}.safetensors")).exists();
    let entry = |names: &str| {
        let nets: Vec<Net> = names.split('+').filter(ships).map(shipped).collect();
        match nets.len() {
            0 => vec![],
            1 => nets.into_iter().next().unwrap().entry(Stride::PATCH).methods,
            _ => nets_by_noise::entry(nets, Stride::PATCH).unwrap().methods,
        }
    };
    let methods = named_networks(command).split(',').flat_map(entry);
    methods.map(|m| (m.method().to_string(), m.weights().unwrap().to_owned())).collect()
}

/// A page outlives its weights easily: a network is trained again, and its tables stay.
#[test]
fn pages_are_of_the_networks_that_ship() {
    let pages = ["one-noise", "held-back", "held-back-colourful", "kodak-linear", "kodak-srgb", "closed"];
    for page in pages.into_iter().chain(["overlap", "single-depth", "tolerances"]) {
        let hashes = hashes_of_shipped(&command(page));
        let mut measured = BTreeSet::new();
        for row in table(page).unwrap().rows {
            let Some((method, hash)) = row["method"].as_str().and_then(|m| hashes.get_key_value(m)) else {
                continue;
            };
            // At other strides a study quantizes by itself.
            if method.ends_with("float") || row["stride"] == 8 {
                let first = row["weights_sha256"].as_str().unwrap();
                assert!(
                    first.len() == 12 && hash.starts_with(first),
                    "docs/results/{page}.md: {method} has other weights now"
                );
                measured.insert(method);
            }
        }
        assert!(!measured.is_empty(), "docs/results/{page}.csv: no network that ships");
    }
}

/// A page must be what its table says. `EDOF_BLESS=1` writes it anew.
fn check_page(name: &str, study: &impl StudyReport, made: &Made) {
    let (file, page) = (format!("docs/results/{name}.md"), study.to_markdown(made));
    if std::env::var_os("EDOF_BLESS").is_some() {
        std::fs::write(project().join(&file), &page).unwrap();
    }
    assert!(read(&file) == page, "{file}: is not what its table says; run scripts/results.sh");
}

/// The command that a page states.
fn command(name: &str) -> String {
    between(&read(&format!("docs/results/{name}.md")), "Made by `", "`").to_owned()
}

/// A study from its compact table; its page must be the table's.
fn study_of_page<T: StudyReport>(name: &str) -> T {
    let table = table(name).unwrap();
    let (rows, makers) = (table.rows_of::<T>(), vec![table.maker]);
    let study = T::new(&rows, machines(&makers)).unwrap();
    check_page(name, &study, &Made { command: command(name), makers, rows: Some(table.file) });
    study
}

/// The page of a file of rows, and that of the table that scripts/table.py makes of the file.
fn is_the_same_page<T: StudyReport>() {
    let study = <T::Row as Line>::STUDY;
    let file = project().join(format!("crates/edof-study/tests/rows/{study}.jsonl"));
    let program = ["-B".into(), project().join("scripts/table.py"), file.clone()];
    let made = std::process::Command::new("python3").args(program).output().expect("python3");
    let table = Table::parsed(&String::from_utf8(made.stdout).unwrap()).unwrap();
    let rows =
        Journal::<T::Row>::merged(Path::new("nowhere"), std::slice::from_ref(&file), Mixing::default())
            .unwrap()
            .rows();
    let page = |rows: &[T::Row]| {
        let made = Made { command: "edof".into(), makers: vec![], rows: None };
        T::new(rows, "a CPU".into()).unwrap().to_markdown(&made)
    };
    assert_eq!(page(&table.rows_of::<T>()), page(&rows), "{study}");
    assert_eq!(table.file.sha256, sha256(&std::fs::read(file).unwrap()), "{study}");
}

#[test]
fn a_table_gives_the_page_of_the_rows_that_it_was_made_from() {
    is_the_same_page::<Study>();
    is_the_same_page::<Speed>();
    is_the_same_page::<Knobs>();
    is_the_same_page::<KnownBlurs>();
    is_the_same_page::<Aperture>();
    is_the_same_page::<ApertureNetworks>();
    is_the_same_page::<LensNetworks>();
    is_the_same_page::<Tolerances>();
}

#[test]
fn the_tables_of_photographs_say_what_their_rows_say() {
    ["linear", "srgb"].iter().for_each(|tone| drop(study_of_page::<Study>(&format!("kodak-{tone}"))));
    study_of_page::<Study>("one-noise");
    study_of_page::<Aperture>("aperture");
}

#[test]
fn tables_of_pages_take_three_megabytes_at_most() {
    let results = std::fs::read_dir(project().join("docs/results")).unwrap().map(Result::unwrap);
    let files: Vec<(String, u64)> = results
        .map(|file| (file.file_name().into_string().unwrap(), file.metadata().unwrap().len()))
        .collect();
    let tables = files.iter().filter(|(name, _)| name.ends_with(".csv"));
    let bytes: u64 = tables.map(|(_, bytes)| bytes).sum();
    assert!((1..=3 << 20).contains(&bytes), "docs/results/*.csv: {bytes} bytes");
    let full: Vec<_> = files.iter().filter(|(name, _)| name.ends_with(".jsonl")).collect();
    assert!(full.is_empty(), "{full:?}: full rows are an artefact of scripts/results.sh, not of the tree");
}

#[test]
fn the_page_of_tolerances_says_what_its_rows_say() {
    let study: Tolerances = study_of_page("tolerances");
    assert_eq!(study.method, "edof-t4w12-outer-by-noise.float");
}

#[test]
fn the_page_of_smaller_apertures_with_networks_says_what_its_rows_say() {
    let study: ApertureNetworks = study_of_page("aperture-networks");
    assert_eq!(study.photographs, 8);
}

#[test]
fn the_page_of_masks_says_what_its_rows_say() {
    let study: LensNetworks = study_of_page("masks");
    assert!(study.photographs == 8 && study.lenses.iter().all(|lens| !lens.known));
}

#[test]
fn the_page_of_known_depths_says_what_its_rows_say() {
    for page in ["depth-known", "depth-known-16"] {
        let study: LensNetworks = study_of_page(page);
        assert!(study.photographs == 8 && study.lenses.iter().any(|lens| lens.known), "{page}");
    }
}

#[test]
fn the_page_of_two_exposures_says_what_its_rows_say() {
    let study: LensNetworks = study_of_page("two-exposures");
    let two = study.lenses.iter().filter(|lens| lens.foci == [2.0, 6.0]);
    assert!(study.photographs == 8 && two.clone().count() > 1 && two.clone().all(|lens| lens.seeds == 3));
}

#[test]
fn the_comparison_says_what_its_rows_say() {
    study_of_page::<Knobs>("knobs");
    study_of_page::<Speed>("overlap");
    let speed: Speed = study_of_page("single-depth");
    if std::env::var_os("EDOF_BLESS").is_some() {
        std::fs::write(project().join("docs/figures/speed.svg"), speed.diagrams()).unwrap();
    }
    assert!(read("docs/figures/speed.svg") == speed.diagrams(), "run scripts/results.sh speed");
}

/// Three blurs of every photograph.
fn diverges_on_none(name: &str, photographs: usize) {
    let study: KnownBlurs = study_of_page(name);
    assert_eq!((study.rows.len(), study.diverged), (3 * photographs, 0), "{name}");
}

#[test]
fn blind_deconvolution_diverges_on_no_photograph() {
    diverges_on_none("blind", 8);
    diverges_on_none("blind-train", 16);
}

/// What documents quote of a page's first table, without SSIM and standard errors, and narrow: demosaicing and the networks in fixed point, for each of the two lenses.
fn quotable(file: &str) -> Vec<String> {
    let page = read(file);
    let table: Vec<Vec<&str>> = page
        .lines()
        .skip_while(|line| !line.starts_with('|'))
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    assert!(table.len() > 4, "{file}");
    // Those by noise alone, where the page has them.
    let kinds =
        if page.contains("-by-noise.fixed") { ["-by-noise", "-light-by-noise"] } else { ["", "-light"] };
    let is_network = |name: &str| {
        let lens = ["edof-t4w12-outer", "edof-t4w12-clear"].into_iter().find_map(|n| name.strip_prefix(n));
        lens.is_some_and(|kind| kinds.contains(&kind))
    };
    let is_method =
        |name: &str| name == "demosaic-malvar" || name.strip_suffix(".fixed").is_some_and(is_network);
    let is_quoted = |row: &[&str]| is_method(row[1]) && ["ring-outer", "clear-mid"].contains(&row[2]);
    let (head, rows) = table.split_at(2);
    let rows: Vec<_> = rows.iter().filter(|row| is_quoted(row)).collect();
    assert!(rows.len() >= 4, "{file}: demosaicing and a network for each lens");
    let cells = |row: &Vec<&str>| {
        let means = |cell: &str| cell.split(" ± ").next().unwrap_or_default().to_owned();
        let narrow = |cell: &str| cell.split(" / ").map(means).collect::<Vec<_>>().join("/");
        let kept = [1, 2, 3, 5, 7].map(|column| narrow(row[column]));
        if row[1].starts_with('-') {
            "|---|---|---|---|---|".into()
        } else {
            format!("| {} |", kept.join(" | "))
        }
    };
    head.iter().chain(rows).map(cells).collect()
}

#[test]
fn readme_and_results_quote_rows_of_the_pages() {
    for (document, tone) in
        [("README.md", "srgb"), ("docs/results.md", "linear"), ("docs/results.md", "srgb")]
    {
        let file = format!("docs/results/kodak-{tone}.md");
        let text = read(document);
        let quoted = between(&text, &format!("<!-- rows: {file} -->\n"), "<!-- end -->");
        assert_eq!(
            quoted.lines().collect::<Vec<_>>(),
            quotable(&file),
            "{document}: run scripts/results.sh {tone}"
        );
    }
}

/// What a document quotes of a page's verdict: all but what its rows do not state, and where the page is.
fn quotable_verdict(name: &str, folder: &str) -> String {
    let page = read(&format!("docs/results/{name}.md"));
    let verdict = between(&page, "**Verdict.** ", " The rows do not state");
    format!("{verdict} ([{name}.md]({folder}/{name}.md))")
}

#[test]
fn results_quote_the_verdicts_of_the_pages() {
    let text = read("docs/results.md");
    for name in ["kodak-linear", "held-back", "held-back-colourful"] {
        let found = between(&text, &format!("<!-- verdict: {name} -->\n"), "\n<!-- end -->");
        assert_eq!(found, quotable_verdict(name, "results"), "run scripts/results.sh for {name}.md");
    }
}

/// Pages of the photographs that nothing is trained on, and which they are.
const UNSEEN: [(&str, &[&str]); 2] =
    [("held-back", &HELD_BACK), ("held-back-colourful", &["more04", "more15", "more16", "more21"])];

/// What the command that a page states gives as its networks, as in `low+high,other`.
fn named_networks(command: &str) -> &str {
    let after = |option: &str| command.split_once(option).map(|(_, rest)| rest);
    let rest = after(" --nets ").or_else(|| after(" --net "));
    rest.and_then(|rest| rest.split(' ').next()).unwrap_or_else(|| panic!("{command}: names no network"))
}

#[test]
fn pages_of_unseen_photographs_are_of_them_and_of_both_lenses_by_noise() {
    for (name, photographs) in UNSEEN {
        if !project().join(format!("docs/results/{name}.md")).exists() {
            continue;
        }
        let study: Study = study_of_page(name);
        let measured: BTreeSet<&str> = study.rows.iter().map(|row| row.image.as_str()).collect();
        assert_eq!(measured, photographs.iter().copied().collect(), "{name}");
        assert!(read(&format!("docs/results/{name}.md")).contains(OF_HELD_BACK), "{name}");
        let methods: BTreeSet<&str> = study.rows.iter().map(|row| row.method.as_str()).collect();
        let by_noise = |lens: &str| methods.contains(format!("edof-t4w12-{lens}-by-noise.fixed").as_str());
        assert!(by_noise("outer") && by_noise("clear"), "{name}: {methods:?}");
        named_networks(&command(name)).split([',', '+']).for_each(|net| assert!(is_of_others(net), "{net}"));
    }
}

/// Whether no photograph that is held back is among those that a network was trained on.
fn is_of_others(network: &str) -> bool {
    let file = project().join(format!("weights/{network}.safetensors"));
    let inputs = weight_file::load_network(&file).unwrap().origin.provenance.inputs;
    assert!(inputs.len() > 20, "{network}: {} photographs", inputs.len());
    let is_held_back = |name: &str| HELD_BACK.iter().any(|held_back| name.ends_with(held_back));
    !inputs.iter().any(|input| is_held_back(&input.name))
}

#[test]
fn no_class_of_noise_has_seen_a_photograph_that_is_held_back() {
    let scripts = read("scripts/held-back.sh");
    for (_, photographs) in UNSEEN {
        assert!(scripts.contains(&format!("={}\n", photographs.join(","))), "{photographs:?}");
    }
    let classes = ["outer", "clear"]
        .into_iter()
        .flat_map(|lens| ["low", "mid", "high"].map(|class| format!("edof-t4w12-{lens}-{class}")));
    for network in classes {
        if project().join(format!("weights/{network}.safetensors")).exists() {
            assert!(is_of_others(&network), "{network}: trained on a photograph that is held back");
        }
    }
    assert!(!is_of_others("edof-t4w12-outer"), "its training saw all of them");
}
