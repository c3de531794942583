//! Metrics, experiments and reports.
