//! Several trained networks as one method by noise ([`crate::methods::by_noise`]), in every format that all of them have.

use crate::methods::by_noise::ByNoise;
use crate::methods::nets::{self, Entry, Net};
use crate::methods::spec::MethodSpec;
use edof_core::Stride;
use edof_network::network::Origin;

/// Networks that make no method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum ByNoiseError {
    /// Nothing to choose from.
    #[error("nets: none given")]
    None,
    /// A network of another kind than the first.
    #[error(
        "net '{net}': differs from '{first}' in its {what}; networks of one method by noise need the same"
    )]
    Differs { net: String, first: String, what: &'static str },
    /// A network that cannot be chosen.
    #[error("net '{net}': states no noise that it was trained for")]
    NoNoise { net: String },
    /// A network given twice.
    #[error("net '{net}': given twice in one method by noise")]
    Twice { net: String },
}

/// Several networks as one entry of tables, in every format that all of them have. Its name is what theirs begin with, and `by-noise`.
///
/// # Errors
/// [`ByNoiseError`] where they cannot stand for one another.
pub fn entry(nets: Vec<Net>, stride: Stride) -> Result<Entry, ByNoiseError> {
    check(&nets)?;
    let names: Vec<&str> = nets.iter().map(|net| net.name.as_str()).collect();
    let name = name(&names);
    let each: Vec<(Origin, Vec<MethodSpec>)> =
        nets.into_iter().map(|net| (net.float.origin.clone(), net.entry(stride).methods)).collect();
    let Some(((first, _), _)) = each.split_first() else { return Err(ByNoiseError::None) };
    let (camera, further_foci) = (nets::camera(first), first.further_foci.clone());
    let formats = each.iter().map(|(_, methods)| methods.len()).min().unwrap_or(0);
    let in_format = |format: usize| {
        let mut networks = each.iter().map(|(origin, methods)| (origin.clone(), methods[format].clone()));
        let first = networks.next()?;
        let others: Vec<_> = networks.collect();
        let all = std::iter::once(&first).chain(&others);
        let hashes: Vec<String> = all.filter_map(|(_, spec)| spec.weights().map(str::to_owned)).collect();
        let hashes: Vec<&str> = hashes.iter().map(String::as_str).collect();
        Some(MethodSpec::ByNoise(Box::new(ByNoise::new(name.clone(), first, others, &hashes))))
    };
    let methods = (0..formats).filter_map(in_format).collect();
    Ok(Entry { name: name.clone(), camera, further_foci, methods })
}

/// Whether networks can stand for one another: one lens, one form, one tone, one stride and format of words.
fn check(nets: &[Net]) -> Result<(), ByNoiseError> {
    let Some(first) = nets.first() else { return Err(ByNoiseError::None) };
    let tones = |net: &Net| net.float.origin.conditions.iter().map(|c| c.tone).collect::<Vec<_>>();
    let words = |net: &Net| net.fixed.as_ref().map(|(f, _)| (f.stride, f.overlap, f.code_bits));
    for (place, net) in nets.iter().enumerate() {
        if net.float.origin.conditions.is_empty() {
            return Err(ByNoiseError::NoNoise { net: net.name.clone() });
        }
        if nets[..place].iter().any(|other| other.name == net.name) {
            return Err(ByNoiseError::Twice { net: net.name.clone() });
        }
        let differs = [
            (net.float.origin.camera != first.float.origin.camera, "camera"),
            (net.float.origin.further_foci != first.float.origin.further_foci, "foci"),
            (net.float.form != first.float.form, "architecture"),
            (tones(net) != tones(first), "tone"),
            (words(net).zip(words(first)).is_some_and(|(own, other)| own != other), "fixed-point format"),
        ];
        if let Some((_, what)) = differs.into_iter().find(|(differs, _)| *differs) {
            return Err(ByNoiseError::Differs { net: net.name.clone(), first: first.name.clone(), what });
        }
    }
    Ok(())
}

/// The parts between hyphens that all names begin with, and `by-noise`.
fn name(names: &[&str]) -> String {
    let parts = |name: &'_ &str| name.split('-').map(str::to_owned).collect::<Vec<_>>();
    let shared = names.iter().map(parts).reduce(|shared, other| {
        shared.into_iter().zip(other).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
    });
    let shared = shared.unwrap_or_default().into_iter();
    shared.chain(["by-noise".to_owned()]).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Noise;
    use edof_core::Tone;
    use edof_core::camera::Camera;
    use edof_network::network::Condition;
    use edof_network::{FixedNetwork, Network};

    fn net(name: &str, camera: &str, [least, most]: [f64; 2]) -> Net {
        let [least_noise, noise] = [least, most].map(Noise::gaussian);
        let mut float: Network = edof_device::random::silent(Camera::resolve(camera).unwrap());
        float.origin.conditions = vec![Condition { tone: Tone::Linear, noise, least_noise }];
        Net::new(name, float, name, None, Stride::PATCH).0
    }

    fn low_and_high() -> Vec<Net> {
        vec![net("n-x-low", "clear", [0.0, 0.01]), net("n-x-high", "clear", [0.01, 0.03])]
    }

    /// The method in its first format, RGB in floating point.
    fn float(nets: Vec<Net>) -> MethodSpec {
        entry(nets, Stride::PATCH).unwrap().methods.remove(0)
    }

    #[test]
    fn each_noise_meets_its_network_and_rows_have_one_name() {
        let method = float(low_and_high());
        let MethodSpec::ByNoise(networks) = &method else { panic!("no method by noise") };
        let at = |sigma| networks.at(Noise::gaussian(sigma)).weights().unwrap();
        assert_eq!([0.0, 0.005, 0.02, 0.3].map(at), ["n-x-low", "n-x-low", "n-x-high", "n-x-high"]);
        assert_eq!(method.method().to_string(), "n-x-by-noise.float");
        let [a, b] = [0, 1].map(|place| low_and_high()[place].float.form.layers);
        assert_eq!((method.method().layers, a), (Some(a), b));
        let formats = entry(low_and_high(), Stride::PATCH).unwrap().methods;
        let names: Vec<String> = formats.iter().map(|spec| spec.method().to_string()).collect();
        assert_eq!(names, ["n-x-by-noise.float", "n-x-by-noise.float422"], "fixed only where all have it");
    }

    #[test]
    fn every_network_and_its_range_counts_in_the_hashes() {
        let method = float(low_and_high());
        let mut other = low_and_high();
        other[1].float_sha256 = "other".into();
        assert_ne!(float(other).weights(), method.weights());
        let mut other = low_and_high();
        other[1] = net("n-x-high", "clear", [0.01, 0.04]);
        assert_ne!(float(other).settings(), method.settings());
    }

    #[test]
    fn all_formats_are_those_that_all_networks_have() {
        let with_fixed = |name: &str, range| {
            let plain = net(name, "clear", range);
            let fixed = FixedNetwork { float_hash: name.into(), ..edof_device::random::natural(8, 8, 7) };
            Net::new(name, plain.float, name, Some((fixed, format!("{name} fixed"))), Stride::PATCH).0
        };
        let nets = vec![with_fixed("low", [0.0, 0.01]), with_fixed("high", [0.01, 0.03])];
        let methods = entry(nets, Stride::PATCH).unwrap().methods;
        assert_eq!(methods.last().unwrap().method().to_string(), "by-noise.fixed");
        let nets = vec![with_fixed("low", [0.0, 0.01]), net("high", "clear", [0.01, 0.03])];
        assert_eq!(entry(nets, Stride::PATCH).unwrap().methods.len(), 2);
    }

    #[test]
    fn networks_that_cannot_stand_for_one_another_are_rejected() {
        let why = |nets| entry(nets, Stride::PATCH).unwrap_err().to_string();
        let other = net("b", "ring-outer", [0.01, 0.03]);
        let expected =
            "net 'b': differs from 'a' in its camera; networks of one method by noise need the same";
        assert_eq!(why(vec![net("a", "clear", [0.0, 0.01]), other]), expected);
        let same = || net("a", "clear", [0.0, 0.01]);
        assert_eq!(why(vec![same(), same()]), "net 'a': given twice in one method by noise");
        let mut silent = same();
        silent.float.origin.conditions.clear();
        assert_eq!(why(vec![silent]), "net 'a': states no noise that it was trained for");
        assert_eq!(why(vec![]), "nets: none given");
    }

    #[test]
    fn the_name_is_what_the_names_share() {
        assert_eq!(name(&["edof-t4w12-outer-low", "edof-t4w12-outer-high"]), "edof-t4w12-outer-by-noise");
        assert_eq!(name(&["edof-t4w12-outer", "edof-t4w12-outer-high"]), "edof-t4w12-outer-by-noise");
        assert_eq!(name(&["low", "high"]), "by-noise");
    }
}
