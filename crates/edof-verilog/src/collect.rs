//! Walks a circuit and writes down what the backend needs: a tree of blocks with their signals and kernels.

use crate::describe::{Circuit, Description, Descriptions};
use rust_hdl::prelude::{Atom, AtomKind, Block, Probe, TypeDescriptor, TypeKind, Verilog};

use crate::error::rust_path;
use crate::types::Type;

/// A block: what it says of itself, its own signals, its parts.
pub(crate) struct Tree {
    /// Field name, `$` between name and array index.
    pub key: String,
    /// Path from the top, as Rust writes it.
    pub path: String,
    pub description: Option<Description>,
    pub hdl: Verilog,
    pub is_dff: bool,
    pub wires: Vec<Wire>,
    pub parts: Vec<Tree>,
}

/// A signal or constant of a block.
pub(crate) struct Wire {
    /// Field name; `$` between the words of interfaces and array elements.
    pub key: String,
    pub kind: AtomKind,
    pub ty: Type,
    pub is_clock: bool,
    pub descriptor: TypeDescriptor,
    /// Value in hexadecimal, meaningful for constants.
    pub value: String,
}

impl Tree {
    /// The tree of a circuit.
    pub fn of(top: &dyn Circuit) -> Self {
        let mut collector = Collector::default();
        top.accept("top", &mut collector);
        let mut tree = collector.root.expect("rust-hdl visits the top block");
        tree.attach(&Descriptions::of(top, "top"), "top");
        tree
    }

    fn attach(&mut self, descriptions: &Descriptions, path: &str) {
        self.description = descriptions.get(path);
        let kernel = std::mem::replace(&mut self.hdl, Verilog::Empty);
        self.hdl = descriptions.whole(path, kernel);
        for part in &mut self.parts {
            part.attach(descriptions, &format!("{path}.{}", part.key));
        }
    }

    /// The signal of this name.
    pub fn wire(&self, key: &str) -> Option<&Wire> {
        self.wires.iter().find(|wire| wire.key == key)
    }

    /// rust-hdl's register.
    pub fn is_register(&self) -> bool {
        self.is_dff && self.wires.len() == 3 && ["d", "q", "clock"].iter().all(|key| self.wire(key).is_some())
    }

    /// rust-hdl's register with a start-up value: `DFFWithInit`, which is a DFF between two exclusive-ors.
    pub fn start_value(&self) -> Option<&Wire> {
        let shape = self.description.is_none() && self.wires.len() == 4 && self.parts.len() == 1;
        let known = shape && self.parts[0].key == "dff" && self.parts[0].is_register();
        let ports = ["d", "q", "clock"].iter().all(|key| self.wire(key).is_some());
        self.wire("init").filter(|init| known && ports && init.kind == AtomKind::Constant)
    }
}

#[derive(Default)]
struct Collector {
    open: Vec<Tree>,
    namespace: Vec<String>,
    root: Option<Tree>,
}

impl Probe for Collector {
    fn visit_start_scope(&mut self, name: &str, node: &dyn Block) {
        let path = self.open.last().map_or(name.to_string(), |up| format!("{}.{}", up.path, rust_path(name)));
        let timing = node.timing();
        self.open.push(Tree {
            key: name.into(),
            path,
            description: None,
            hdl: node.hdl(),
            is_dff: timing.iter().any(|info| info.name == "dff"),
            wires: vec![],
            parts: vec![],
        });
    }

    fn visit_end_scope(&mut self, _name: &str, _node: &dyn Block) {
        let Some(done) = self.open.pop() else { return };
        match self.open.last_mut() {
            Some(up) => up.parts.push(done),
            None => self.root = Some(done),
        }
    }

    fn visit_start_namespace(&mut self, name: &str, _node: &dyn Block) {
        self.namespace.push(name.into());
    }

    fn visit_end_namespace(&mut self, _name: &str, _node: &dyn Block) {
        self.namespace.pop();
    }

    fn visit_atom(&mut self, name: &str, signal: &dyn Atom) {
        let Some(block) = self.open.last_mut() else { return };
        let descriptor = signal.descriptor();
        let signed = matches!(descriptor.kind, TypeKind::Signed(_));
        let literal = format!("{:x}", signal.verilog());
        block.wires.push(Wire {
            key: self.namespace.iter().map(String::as_str).chain([name]).collect::<Vec<_>>().join("$"),
            kind: signal.kind(),
            ty: Type { bits: signal.bits(), signed },
            is_clock: descriptor.name == "clock",
            descriptor,
            value: literal.rsplit("'h").next().unwrap_or_default().into(),
        });
    }
}
