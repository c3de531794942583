//! What the backend must know of a block and its syntax tree does not say: name, source, header.
//!
//! rust-hdl has no room for these; [`rust_hdl::prelude::Logic::timing`] is a hook that nothing of ours uses otherwise.

use rust_hdl::prelude::TimingInfo;

/// Name, source file and header comment of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// The Rust type's own name, without path and parameters, for instance `PairBuffer`.
    pub name: String,
    /// Rust file and line.
    pub source: String,
    /// What a user of the block must know.
    pub header: String,
}

/// Marks [`TimingInfo`] as a description.
const MARK: &str = "described";

/// Used by [`described!`](crate::described).
#[must_use]
pub fn describe(type_name: &str, file: &str, line: u32, header: &str) -> Vec<TimingInfo> {
    let path = type_name.split('<').next().unwrap_or(type_name);
    let name = path.rsplit("::").next().unwrap_or(path);
    vec![TimingInfo {
        name: MARK.into(),
        clock: name.into(),
        inputs: vec![format!("{file}:{line}")],
        outputs: vec![header.into()],
    }]
}

/// The description of a block, if it has one.
#[must_use]
pub fn description(timing: &[TimingInfo]) -> Option<Description> {
    let found = timing.iter().find(|info| info.name == MARK)?;
    Some(Description {
        name: found.clock.clone(),
        source: found.inputs.first()?.clone(),
        header: found.outputs.first()?.clone(),
    })
}

/// Inside `impl Logic for …`: says what the block is. The text becomes the header of its Verilog module.
///
/// ```
/// use edof_hdl::described;
/// use rust_hdl::prelude::*;
///
/// #[derive(LogicBlock, Default)]
/// struct Inverter { pub x: Signal<In, Bit>, pub y: Signal<Out, Bit> }
///
/// impl Logic for Inverter {
///     described!("y is not x.");
///     #[hdl_gen]
///     fn update(&mut self) { self.y.next = !self.x.val(); }
/// }
/// let found = edof_hdl::describe::description(&Inverter::default().timing()).unwrap();
/// assert_eq!((found.name.as_str(), found.header.as_str()), ("Inverter", "y is not x."));
/// ```
#[macro_export]
macro_rules! described {
    ($header:expr) => {
        fn timing(&self) -> Vec<rust_hdl::prelude::TimingInfo> {
            $crate::describe::describe(std::any::type_name::<Self>(), file!(), line!(), $header)
        }
    };
}
