//! Methods of whole frames that need no weights, prepared when they are first asked for.

use crate::methods::dictionary::Dictionary;
use crate::methods::spec::{self, MethodSpec};
use crate::stability::case::Frame;
use crate::stability::outcome::Stopped;
use edof_core::camera::Camera;
use edof_core::{Reconstructor, Stride};
use edof_optics::psf::Settings;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// The paper's camera, behind which methods without weights are tried.
pub(crate) const CAMERA: &str = "ring-2018";
/// Methods without weights, and whether their preparation depends on depth or noise.
const METHODS: [(&str, bool); 10] = [
    ("directional", false),
    ("wiener", true),
    ("richardson-lucy", true),
    ("hyper-laplacian", true),
    ("blind", false),
    ("omp", false),
    ("omp-known", true),
    ("fista", false),
    ("fista-known", true),
    ("untrained", false),
];

/// Methods that were prepared once.
#[derive(Default)]
pub struct Methods {
    prepared: RefCell<HashMap<String, Rc<Box<dyn Reconstructor>>>>,
    dictionary: RefCell<Option<Arc<Dictionary>>>,
}

impl Methods {
    /// All methods without weights behind the paper's camera.
    pub(crate) fn all(&self, frame: &Frame) -> Result<Vec<Rc<Box<dyn Reconstructor>>>, Stopped> {
        let camera = Camera::resolve(CAMERA)?;
        let dictionary = self.dictionary()?;
        let case =
            spec::Case { camera: &camera, psi: frame.psi, noise: frame.noise, optics: Settings::default() };
        METHODS
            .iter()
            .map(|(name, depends)| {
                let key =
                    if *depends { format!("{name} {} {}", frame.psi, frame.noise) } else { (*name).into() };
                if let Some(known) = self.prepared.borrow().get(&key) {
                    return Ok(Rc::clone(known));
                }
                let mut specs = MethodSpec::named(name, &[Stride::PATCH], &dictionary)?;
                // Of networks before training the second: the paper's T = 4.
                let spec = specs.swap_remove(usize::from(specs.len() > 1));
                let method = Rc::new(spec.prepare(&case)?);
                self.prepared.borrow_mut().insert(key, Rc::clone(&method));
                Ok(method)
            })
            .collect()
    }

    fn dictionary(&self) -> Result<Arc<Dictionary>, Stopped> {
        if let Some(known) = &*self.dictionary.borrow() {
            return Ok(Arc::clone(known));
        }
        let loaded = Arc::new(Dictionary::load(None)?);
        *self.dictionary.borrow_mut() = Some(Arc::clone(&loaded));
        Ok(loaded)
    }
}
