//! Speed against error as a table for a paper.

use super::{Claims, Point, Speed};
use crate::latex::{DASH, cell, escaped, noise_in_latex, tabular};
use crate::made::Made;
use crate::tables::psi_words;
use edof_core::Tone;

impl Speed {
    /// Returns a table for the package booktabs: for each method, depth and noise the PSNR in dB as mean ± standard error over photographs, and CPU
    /// seconds per megapixel.
    #[must_use]
    pub fn to_latex(&self, made: &Made) -> String {
        let mut methods: Vec<&str> = vec![];
        for Point { method, .. } in &self.points {
            if !methods.contains(&method.as_str()) {
                methods.push(method);
            }
        }
        let rows = methods.into_iter().map(|method| {
            let of = |group: &Claims| {
                let found = self.points.iter().find(|point| point.method == method && group.hold(point));
                found.map_or_else(
                    || [DASH, DASH].map(str::to_owned),
                    |point| {
                        let mark = if self.has_cpu_seconds() && point.is_wall_clock() { "^*" } else { "" };
                        let cost = format!("${:.3}{mark}$", point.cost());
                        [cell((point.psnr_db, point.standard_error())), cost]
                    },
                )
            };
            std::iter::once(escaped(method)).chain(self.claims.iter().flat_map(of)).collect()
        });
        let groups = self.claims.iter().map(|Claims { psi, noise, tone, .. }| {
            let tone = if *tone == Tone::Srgb { ", real light" } else { "" };
            format!("$\\psi = {}$, {}{tone}", psi_words(*psi), noise_in_latex(*noise))
        });
        let starred = self.has_cpu_seconds() && self.points.iter().any(Point::is_wall_clock);
        let remarks = format!(
            "{made}\nPSNR in dB, mean and standard error over photographs. s/MP: {}{}; on {}.",
            self.cost_in_words(),
            if starred { "; with *: wall-clock seconds" } else { "" },
            self.machine
        );
        tabular(&remarks, &["method"], groups, &["dB", "s/MP"].map(str::to_owned), rows)
    }
}
