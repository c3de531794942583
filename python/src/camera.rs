//! Cameras.

use crate::arguments::{array, finite, name, number, owned};
use crate::error::{OrRaise, failed};
use edof::presets::lens::{self, BankFile};
use edof_core::camera::{Aberration, Camera, HeightMap, Kernels, PRESETS, PsfBank, Term, Zernike};
use edof_core::storage::json;
use edof_optics::{distance_m, psi_at};
use ndarray::{Ix1, Ix2, Ix4};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A lens, its phase mask and a sensor. See `edof.Camera` in the type stubs.
#[pyclass(frozen, name = "Camera", module = "edof")]
pub struct PyCamera(pub Arc<Camera>);

/// A camera argument: a `Camera`, a preset's name or a file.
pub fn camera(value: &Bound<'_, PyAny>) -> PyResult<Arc<Camera>> {
    if let Ok(camera) = value.cast::<PyCamera>() {
        return Ok(Arc::clone(&camera.get().0));
    }
    let name = name(value, "camera", "a Camera, the name of a preset, or the path of a JSON file")?;
    Ok(Arc::new(lens::resolve(&name, None).or_raise()?.camera))
}

/// The camera focused at ψ.
pub fn focused(camera: &Camera, psi: f64) -> PyResult<Camera> {
    if camera.psf_bank.is_some() {
        return Err(failed(format!(
            "psi {psi}: camera {} has PSFs of a bank, which has one focus",
            camera.name
        )));
    }
    Ok(Camera { focus_psi: number(psi, "psi")?, ..camera.clone() })
}

impl PyCamera {
    /// A camera that may differ in any field.
    fn checked(camera: Camera) -> PyResult<Self> {
        camera.check().or_raise()?;
        Ok(Self(Arc::new(camera)))
    }

    fn nominal(&self, given: Option<f64>) -> PyResult<f64> {
        let nominal = given.or(self.0.nominal_m);
        let nominal = nominal.ok_or_else(|| {
            failed(format!(
                "camera {}: does not know the distance at which psi is 0; give nominal_m",
                self.0.name
            ))
        })?;
        if nominal > 0.0 {
            Ok(nominal)
        } else {
            Err(failed(format!("nominal_m {nominal}: must be more than 0")))
        }
    }
}

#[pymethods]
impl PyCamera {
    #[new]
    #[pyo3(signature = (name_or_path = None, *, psf_bank = None, centre = false))]
    fn new(
        name_or_path: Option<&Bound<'_, PyAny>>,
        psf_bank: Option<PathBuf>,
        centre: bool,
    ) -> PyResult<Self> {
        if centre && psf_bank.is_none() {
            return Err(failed("centre: shifts a PSF bank; name one by psf_bank"));
        }
        let name = match name_or_path {
            Some(value) => name(value, "name_or_path", "the name of a preset, or the path of a JSON file")?,
            None => lens::DEFAULT.to_owned(),
        };
        Ok(Self(Arc::new(
            lens::resolve(&name, psf_bank.as_deref().map(|path| BankFile { path, centre }))
                .or_raise()?
                .camera,
        )))
    }

    /// Names of the cameras that come with edof.
    #[staticmethod]
    fn presets() -> Vec<&'static str> {
        PRESETS.iter().map(|(name, _)| *name).collect()
    }

    #[staticmethod]
    #[pyo3(signature = (text, *, folder = None))]
    fn from_json(text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let mut camera = Camera::from_json(text, "text").or_raise()?;
        let folder = folder.unwrap_or_default();
        camera.read_bank(&folder).or_raise()?;
        lens::read_mask(&mut camera, &folder).or_raise()?;
        Ok(Self(Arc::new(camera)))
    }

    fn json(&self) -> String {
        self.0.to_json()
    }

    #[pyo3(signature = (psi, psf, *, name = "array"))]
    fn with_psfs(&self, psi: &Bound<'_, PyAny>, psf: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let psi = array::<f64, Ix1>(psi, "psi", "one depth per kernel")?;
        let psf = array::<f32, Ix4>(psf, "psf", "depths x 3 channels x rows x columns")?;
        let kernels =
            Kernels::new(psi.as_array().to_vec(), owned(psf.as_array()).mapv(f64::from).view(), None)
                .or_raise()?;
        let bank = PsfBank {
            file: name.to_owned(),
            sha256: kernels.sha256(),
            centre: false,
            kernels: Some(Arc::new(kernels)),
        };
        Ok(Self(Arc::new(lens::with_bank((*self.0).clone(), bank))))
    }

    #[pyo3(signature = (heights, *, white_um, cauchy, name = "array"))]
    fn with_height_map(
        &self,
        heights: &Bound<'_, PyAny>,
        white_um: f64,
        cauchy: [f64; 2],
        name: &str,
    ) -> PyResult<Self> {
        let heights = finite::<Ix2>(heights, "heights", "rows x columns, square")?;
        let heights = owned(heights.as_array());
        if let Some(value) = heights.iter().find(|v| !(0.0..=1.0).contains(*v)) {
            return Err(failed(format!("heights: holds {value}, expected 0 to 1, in units of white_um")));
        }
        let mut map =
            HeightMap { file: name.to_owned(), white_um, cauchy, sha256: String::new(), heights: None };
        map.take(heights, PathBuf::from(name), &self.0.name).or_raise()?;
        let others = self.0.mask.terms().iter().filter(|term| !matches!(term, Term::HeightMap(_)));
        let mask = others.cloned().chain([map.into()]).collect();
        Self::checked(Camera { mask, ..(*self.0).clone() })
    }

    fn with_aberrations(&self, rms_nm: std::collections::BTreeMap<u32, f64>) -> PyResult<Self> {
        let aberrations = rms_nm.into_iter().map(|(noll, rms_nm)| Aberration { noll, rms_nm }).collect();
        Self::checked(Camera { aberrations: Zernike(aberrations), ..(*self.0).clone() })
    }

    fn with_focus(&self, psi: f64) -> PyResult<Self> {
        focused(&self.0, psi).and_then(Self::checked)
    }

    fn with_mask(&self, terms: &Bound<'_, PyAny>) -> PyResult<Self> {
        let text: String = terms.py().import("json")?.call_method1("dumps", (terms,))?.extract()?;
        let terms: Vec<Term> = json::parse(&text).map_err(|e| failed(format!("terms {e}")))?;
        let mut camera = Camera { mask: terms.into_iter().collect(), ..(*self.0).clone() };
        lens::read_mask(&mut camera, Path::new("")).or_raise()?;
        Self::checked(camera)
    }

    #[pyo3(signature = (metres, *, nominal_m = None))]
    fn psi_at(&self, metres: f64, nominal_m: Option<f64>) -> PyResult<f64> {
        if metres.is_nan() || metres <= 0.0 {
            return Err(failed(format!("metres {metres}: must be more than 0")));
        }
        Ok(psi_at(&self.0, metres, self.nominal(nominal_m)?))
    }

    #[pyo3(signature = (psi, *, nominal_m = None))]
    fn metres_at(&self, psi: f64, nominal_m: Option<f64>) -> PyResult<Option<f64>> {
        Ok(distance_m(&self.0, number(psi, "psi")?, self.nominal(nominal_m)?))
    }

    fn same_lens(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        Ok(self.0.same_lens(&*camera(other)?))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn psi_range(&self) -> (f64, f64) {
        self.0.psi_range.into()
    }

    #[getter]
    fn f_number(&self) -> f64 {
        self.0.f_number()
    }

    #[getter]
    fn pixel_pitch_um(&self) -> f64 {
        self.0.pixel_pitch_um
    }

    #[getter]
    fn nominal_m(&self) -> Option<f64> {
        self.0.nominal_m
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| *other.get().0 == *self.0)
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut state = DefaultHasher::new();
        self.0.to_json().hash(&mut state);
        state.finish()
    }

    fn __repr__(&self) -> String {
        format!("Camera({}, F/{:.2})", self.0.in_words(), self.0.f_number())
    }
}
