//! What a method is: the facts by which rows and tables tell methods apart. Its name is made from them, never read back.

use serde::{Deserialize, Serialize};

/// Identity of a method.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Method {
    /// What kind of method.
    pub family: Family,
    /// Name of the network, for a network.
    pub network: Option<String>,
    /// Numbers that it computes with and format that it gives, for a network.
    pub format: Option<Format>,
    /// Pixels from one patch to the next, for a method that works in patches.
    pub stride: Option<usize>,
    /// Layers T, for a network.
    pub layers: Option<usize>,
}

/// Kind of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// The frame as a plain camera shows it: demosaiced after Malvar, He and Cutler, not deblurred.
    DemosaicMalvar,
    /// Demosaiced along edges after Menon, Andriani and Calvagno, not deblurred.
    DemosaicDirectional,
    /// Demosaiced, then Wiener's filter with the PSF known.
    Wiener,
    /// Demosaiced, then Richardson and Lucy's steps with the PSF known.
    RichardsonLucy,
    /// Demosaiced, then the prior of Krishnan and Fergus with the PSF known.
    HyperLaplacian,
    /// Demosaiced, then blind deconvolution of each colour after Krishnan, Tay and Fergus.
    BlindDeconvolution,
    /// Orthogonal matching pursuit in the dictionary of all depths.
    Omp,
    /// Orthogonal matching pursuit with ψ known.
    OmpKnownDepth,
    /// FISTA in the dictionary of all depths.
    Fista,
    /// FISTA with ψ known.
    FistaKnownDepth,
    /// An unrolled sparse-coding network.
    Network,
    /// The paper's network before training: ISTA in one dictionary of all depths, cut off after T − 1 shrinkages.
    Untrained,
    /// The same with each colour's mean taken out.
    UntrainedDcRemoved,
    /// Anybody's program; its network is its name.
    External,
}

impl Family {
    /// Name of a method other than a network.
    const fn name(self) -> &'static str {
        match self {
            Self::DemosaicMalvar => "demosaic-malvar",
            Self::DemosaicDirectional => "demosaic-directional",
            Self::Wiener => "wiener",
            Self::RichardsonLucy => "richardson-lucy",
            Self::HyperLaplacian => "hyper-laplacian",
            Self::BlindDeconvolution => "blind-deconvolution",
            Self::Omp => "omp",
            Self::OmpKnownDepth => "omp-known-depth",
            Self::Fista => "fista",
            Self::FistaKnownDepth => "fista-known-depth",
            Self::Network => "network",
            Self::Untrained => "untrained",
            Self::UntrainedDcRemoved => "untrained-dc-removed",
            Self::External => "external",
        }
    }
}

/// Numbers that a network computes with and the format of its picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// Floating point, RGB.
    Float,
    /// Floating point, the result rounded once into the board's 4:2:2 words.
    Float422,
    /// The board's integers, 4:2:2.
    Fixed,
    /// The same, its time the cycles of a design at its planned clock.
    Board,
    /// Floating point on a device behind OpenCL, RGB; its CPU time is the host's alone.
    FloatGpu,
    /// The board's integers on a device behind OpenCL, 4:2:2.
    FixedGpu,
}

impl Method {
    /// Demosaicing alone.
    #[must_use]
    pub const fn demosaic() -> Self {
        Self::of_frames(Family::DemosaicMalvar)
    }

    /// A method that works on whole frames.
    #[must_use]
    pub const fn of_frames(family: Family) -> Self {
        Self { family, network: None, format: None, stride: None, layers: None }
    }

    /// A program by its name.
    #[must_use]
    pub fn external(name: impl Into<String>) -> Self {
        Self { network: Some(name.into()), ..Self::of_frames(Family::External) }
    }

    /// A pursuit, which works in patches.
    #[must_use]
    pub const fn of_patches(family: Family, stride: usize) -> Self {
        Self { family, network: None, format: None, stride: Some(stride), layers: None }
    }

    /// A network of `layers` layers in one of its formats.
    #[must_use]
    pub fn network(name: impl Into<String>, format: Format, stride: usize, layers: usize) -> Self {
        Self {
            family: Family::Network,
            network: Some(name.into()),
            format: Some(format),
            stride: Some(stride),
            layers: Some(layers),
        }
    }

    /// A network of `layers` layers that nobody trained, in floating point.
    #[must_use]
    pub const fn untrained(family: Family, stride: usize, layers: usize) -> Self {
        let layers = Some(layers);
        Self { family, network: None, format: Some(Format::Float), stride: Some(stride), layers }
    }

    /// Whether the method is an untrained network.
    #[must_use]
    pub const fn is_untrained(&self) -> bool {
        matches!(self.family, Family::Untrained | Family::UntrainedDcRemoved)
    }

    /// The same network in another format.
    #[must_use]
    pub fn in_format(&self, format: Format) -> Self {
        Self { format: Some(format), ..self.clone() }
    }
}

impl std::fmt::Display for Method {
    /// Short name for tables, as in `edof-t4w12.fixed` and `untrained-t8.float`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = self.network.as_deref().unwrap_or(self.family.name());
        let layers =
            self.layers.filter(|_| self.is_untrained()).map_or_else(String::new, |t| format!("-t{t}"));
        let format = self.format.map_or("", |format| match format {
            Format::Float => ".float",
            Format::Float422 => ".float422",
            Format::Fixed => ".fixed",
            Format::Board => ".board",
            Format::FloatGpu => ".float.gpu",
            Format::FixedGpu => ".fixed.gpu",
        });
        f.pad(&format!("{name}{layers}{format}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_is_data_in_json_and_a_name_in_tables() {
        let method = Method::network("paper-t4", Format::Float422, 8, 4);
        assert_eq!(method.to_string(), "paper-t4.float422");
        assert_eq!(
            serde_json::to_value(&method).unwrap(),
            serde_json::json!({
                "family": "network", "network": "paper-t4", "format": "float422", "stride": 8, "layers": 4
            })
        );
        assert_eq!(Method::demosaic().to_string(), "demosaic-malvar");
        assert_eq!(Method::untrained(Family::Untrained, 8, 10).to_string(), "untrained-t10.float");
    }
}
