//! From Verilog to a shared library.

use super::ports;
use super::shim::{SHIM, ports_inc};
use crate::cache::{self, Product};
use crate::error::{Error, at};
use crate::{Source, mutant, tool};
use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// How a model is built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// The compiler's `-O`, 0 to 3. 0 runs ten times slower than 1 and builds no faster; 2 is for long runs.
    pub optimize: u8,
    /// Which waveforms the model can write. A model that can write one is slower even when it does not.
    pub waveform: Waveform,
    /// What stands where Verilog says nothing.
    pub unknowns: Unknowns,
    /// Whether lines and toggles are counted. Each instance writes what it has covered into the folder `$EDOF_COVERAGE` at its end; the default is
    /// to count where that is set.
    pub coverage: bool,
    /// Where compiled models are kept, by everything that went into them; without it, nothing is kept.
    pub cache: Option<PathBuf>,
    /// Compilers at work at the same time.
    pub jobs: usize,
    /// Whether Verilator's headers are compiled once and kept in the cache, 60 MB: useful where many small models are built.
    pub precompile: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            optimize: 1,
            waveform: Waveform::None,
            unknowns: Unknowns::Random,
            coverage: std::env::var_os("EDOF_COVERAGE").is_some(),
            cache: None,
            jobs: 2,
            precompile: false,
        }
    }
}

impl Options {
    /// Where a user's compiled models belong: `edof/models` in `$XDG_CACHE_HOME`, or else in `~/.cache`.
    #[must_use]
    pub fn user_cache() -> Option<PathBuf> {
        cache::of_user("models")
    }
}

/// Format of a waveform file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Waveform {
    /// None can be written.
    None,
    /// Value change dump: large text that every viewer reads.
    Vcd,
    /// Fast signal trace: small; needs zlib's headers to build.
    Fst,
}

impl Waveform {
    /// FST where it can be built, else VCD.
    #[must_use]
    pub fn best() -> Self {
        let mut probe = tool::command("g++", Path::new("/"));
        let found = probe.args(["-E", "-x", "c++", "-include", "zlib.h", "/dev/null"]);
        if tool::run(found).is_ok() { Self::Fst } else { Self::Vcd }
    }

    /// What such a file's name ends in, without the dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Vcd => "vcd",
            Self::Fst => "fst",
        }
    }

    const fn option(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::Vcd => Some("--trace"),
            Self::Fst => Some("--trace-fst"),
        }
    }
}

/// What registers and memories hold at the start, and what an `x` in the text becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unknowns {
    /// Random by the seed of the instance, different for each: finds what reset forgot.
    Random,
    /// Whatever is fastest.
    Fast,
}

impl Unknowns {
    const fn option(self) -> &'static str {
        match self {
            Self::Random => "unique",
            Self::Fast => "fast",
        }
    }
}

/// Flags of everything that goes into a library: no symbol of it is seen by other libraries, and how it stops is ours.
const CFLAGS: &str = "-fPIC -fvisibility=hidden -fno-gnu-unique -w -DVL_USER_FATAL -DVL_USER_WARN -DVL_USER_STOP -DVL_USER_FINISH";

/// What stands for `-O1`: without two passes that take nearly half of the compiler's time on Verilator's text and win nothing there.
const QUICK: &str = "-O1 -fno-tree-pre -fno-tree-fre";
/// Bytes of C++ below which a model is compiled as one file.
const SMALL: u64 = 6 << 20;

/// Verilator's own makefile knows which objects there are and how they are compiled. `make runtime.o` gives its library in
/// one piece, which all models with the same kind of waveform share; `make headers.h.gch` its headers; `make model.so` what Rust loads. A small
/// model and the shim are one file for the compiler: the headers take it longer than the rest.
const MAKEFILE: &str = "\
include Vdut.mk
runtime.o: $(VK_GLOBAL_OBJS)
\tld -r -o $@ $^
headers.h.gch: shim.cpp
\tsed -n '/^#include </p' $< > headers.h
\techo '#include \"verilated.h\"' >> headers.h
\t$(CXX) $(CXXFLAGS) $(CPPFLAGS) $(OPT_FAST) -x c++-header -o $@ headers.h
whole.cpp: Vdut__ALL.cpp shim.cpp
\tprintf '#include \"%s\"\\n' $^ > $@
ifeq ($(VM_PARALLEL_BUILDS),0)
OBJECTS = whole.o
else
OBJECTS = shim.o $(VK_OBJS)
endif
model.so: $(OBJECTS)
\t$(CXX) -shared -Wl,-Bsymbolic -Wl,--wrap=fopen -o $@ $^ $(RUNTIME) $(LDLIBS)
";

/// The compiled model, from the cache if nothing changed.
pub fn build(source: &Source, options: &Options) -> Result<Product, Error> {
    let simulated = mutant::simulated(source)?;
    let cache = match simulated {
        Cow::Borrowed(_) => options.cache.clone(),
        Cow::Owned(_) => mutant::folder(),
    };
    let counted = if options.coverage { Some(named_by_text(&simulated)?) } else { None };
    let source = counted.as_ref().unwrap_or(&simulated);
    let tools = tools()?;
    let key = cache::key(inputs(source, options, &tools).iter().map(String::as_str));
    let name = format!("{}-{}.so", source.top, &key[..24]);
    cache::obtain(cache.as_deref(), &name, |work| {
        verilate(source, options, work)?;
        ports::check(source, work)?;
        let runtime = runtime(options, &tools, work)?;
        let mut variables = vec![format!("RUNTIME={}", runtime.path.display())];
        let headers = if is_small(work)? {
            variables.push("VM_PARALLEL_BUILDS=0".into());
            options.precompile.then(|| headers(options, &tools, work)).transpose()?
        } else {
            None
        };
        if let Some(headers) = &headers {
            variables.push(format!("USER_CPPFLAGS=-include {}", headers.path.with_extension("").display()));
        }
        make(work, options, "model.so", &variables)?;
        fs::rename(work.join("model.so"), work.join(&name)).map_err(at(work))
    })
}

/// The same with the hash of its text in the name of each file, under which the folder `$EDOF_COVERAGE/texts` has it: what covers a line says where
/// it stands, and a block of other sizes may have it elsewhere.
fn named_by_text(source: &Source) -> Result<Source, Error> {
    let mut named = source.clone();
    let texts = std::env::var_os("EDOF_COVERAGE").map(|folder| Path::new(&folder).join("texts"));
    for (name, text) in &mut named.files {
        let (stem, extension) = name.rsplit_once('.').unwrap_or((name, "v"));
        *name = format!("{stem}.{}.{extension}", &cache::key([text.as_str()])[..12]);
        if let Some(texts) = &texts {
            let path = texts.join(&*name);
            fs::create_dir_all(texts).and_then(|()| fs::write(&path, &*text)).map_err(at(&path))?;
        }
    }
    Ok(named)
}

/// Everything that a model depends on.
fn inputs(source: &Source, options: &Options, tools: &str) -> Vec<String> {
    let mut parts = vec![tools.into(), CFLAGS.into(), MAKEFILE.into(), SHIM.into(), ports_inc(source)];
    parts.push(source.top.clone());
    parts.extend(verilator_options(options).into_iter().map(String::from));
    parts.extend([options.optimize.to_string(), QUICK.into(), SMALL.to_string()]);
    source.files.iter().for_each(|(name, text)| parts.extend([name.clone(), text.clone()]));
    parts
}

/// Versions of Verilator and of the compiler, and the options that `make` takes from `$CXXFLAGS`; asked once.
fn tools() -> Result<String, Error> {
    static TOOLS: Mutex<Option<String>> = Mutex::new(None);
    let mut known = TOOLS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(tools) = &*known {
        return Ok(tools.clone());
    }
    let version = |name| tool::run(tool::command(name, Path::new("/")).arg("--version"));
    version("make")?;
    let options = std::env::var("CXXFLAGS").unwrap_or_default();
    Ok(known.insert(version("verilator")? + &version("g++")? + &options).clone())
}

fn verilator_options(options: &Options) -> Vec<&'static str> {
    let unknowns = options.unknowns.option();
    let mut all = vec!["--cc", "-O3", "--x-assign", unknowns, "--x-initial", unknowns];
    all.extend(["--timescale", "1ns/1ns"]);
    all.extend(runtime_options(options));
    all
}

/// Those of them that change what Verilator's own library has to do.
fn runtime_options(options: &Options) -> Vec<&'static str> {
    let coverage: &[_] = if options.coverage { &["--coverage-line", "--coverage-toggle"] } else { &[] };
    options.waveform.option().into_iter().chain(coverage.iter().copied()).collect()
}

/// Verilog to C++. Warnings are for [`crate::lint`].
fn verilate(source: &Source, options: &Options, work: &Path) -> Result<(), Error> {
    source.write(work)?;
    for (name, text) in [("shim.cpp", SHIM), ("ports.inc", &ports_inc(source)), ("model.mk", MAKEFILE)] {
        fs::write(work.join(name), text).map_err(at(work))?;
    }
    let mut command = tool::command("verilator", work);
    command.args(verilator_options(options)).args(["-Wno-fatal", "-Wno-lint", "-Wno-style"]);
    command.args(["--prefix", "Vdut", "--Mdir", ".", "--top-module", &source.top, "-CFLAGS", CFLAGS]);
    tool::run(command.args(source.file_names())).map(drop)
}

/// Verilator's own library, which takes longer to compile than a small design: once for each kind of waveform.
fn runtime(options: &Options, tools: &str, work: &Path) -> Result<Product, Error> {
    let key = cache::key([tools, CFLAGS, MAKEFILE].into_iter().chain(runtime_options(options)));
    let name = format!("runtime-{}.o", &key[..24]);
    cache::obtain(options.cache.as_deref(), &name, |dir| {
        make(work, options, "runtime.o", &[])?;
        fs::copy(work.join("runtime.o"), dir.join(&name)).map(drop).map_err(at(work))
    })
}

/// Verilator's headers as the compiler reads them faster, for one kind of waveform and one level of optimisation.
fn headers(options: &Options, tools: &str, work: &Path) -> Result<Product, Error> {
    let fast = fast(options);
    let key = cache::key([tools, CFLAGS, MAKEFILE, SHIM, &fast].into_iter().chain(runtime_options(options)));
    let name = format!("headers-{}.h.gch", &key[..24]);
    cache::obtain(options.cache.as_deref(), &name, |dir| {
        make(work, options, "headers.h.gch", &[])?;
        fs::copy(work.join("headers.h.gch"), dir.join(&name)).map(drop).map_err(at(work))
    })
}

/// The compiler's options for what runs all the time.
fn fast(options: &Options) -> String {
    match options.optimize {
        1 => QUICK.to_owned(),
        level => format!("-O{}", level.min(3)),
    }
}

fn make(work: &Path, options: &Options, target: &str, variables: &[String]) -> Result<(), Error> {
    let mut command = tool::command("make", work);
    command.args(["-s", "-f", "model.mk", target, "OPT_SLOW=-O0", "OPT_GLOBAL=-O1"]).args(variables);
    command.arg(format!("-j{}", options.jobs.max(1))).arg(format!("OPT_FAST={}", fast(options)));
    tool::run(&mut command).map(drop)
}

/// Whether all C++ of the model is less than several compilers are worth.
fn is_small(work: &Path) -> Result<bool, Error> {
    let mut bytes = 0;
    for file in fs::read_dir(work).map_err(at(work))? {
        let file = file.map_err(at(work))?;
        if file.path().extension().is_some_and(|e| e == "cpp") {
            bytes += file.metadata().map_err(at(work))?.len();
        }
    }
    Ok(bytes < SMALL)
}
