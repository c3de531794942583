//! Results in the XML that continuous integration reads.

use std::fmt::Write;

/// Named suites of cases.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// In order.
    pub suites: Vec<Suite>,
}

/// A group of cases, such as one design.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Suite {
    /// What they have in common.
    pub name: String,
    /// In order.
    pub cases: Vec<Case>,
}

/// Something that passed or failed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Case {
    /// What was checked.
    pub name: String,
    /// How long it took.
    pub seconds: f64,
    /// Why it failed, if it did; the first line is the summary.
    pub failure: Option<String>,
}

impl Report {
    /// The XML text.
    #[must_use]
    pub fn to_xml(&self) -> String {
        let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        let _ = writeln!(xml, "<testsuites {}>", counts(self.suites.iter().flat_map(|suite| &suite.cases)));
        self.suites.iter().for_each(|suite| suite.write(&mut xml));
        xml + "</testsuites>\n"
    }
}

impl Suite {
    fn write(&self, xml: &mut String) {
        let _ = writeln!(xml, "  <testsuite name=\"{}\" {}>", escaped(&self.name), counts(&self.cases));
        for case in &self.cases {
            let (name, suite) = (escaped(&case.name), escaped(&self.name));
            let _ = write!(
                xml,
                "    <testcase classname=\"{suite}\" name=\"{name}\" time=\"{:.3}\"",
                case.seconds
            );
            let _ = match &case.failure {
                None => writeln!(xml, "/>"),
                Some(why) => writeln!(xml, ">\n      {}\n    </testcase>", failure(why)),
            };
        }
        xml.push_str("  </testsuite>\n");
    }
}

fn failure(why: &str) -> String {
    let summary = escaped(why.lines().next().unwrap_or(""));
    format!("<failure message=\"{summary}\">{}</failure>", escaped(why))
}

fn counts<'a>(cases: impl IntoIterator<Item = &'a Case>) -> String {
    let (mut tests, mut failures, mut seconds) = (0, 0, 0.0);
    for case in cases {
        tests += 1;
        failures += usize::from(case.failure.is_some());
        seconds += case.seconds;
    }
    format!("tests=\"{tests}\" failures=\"{failures}\" time=\"{seconds:.3}\"")
}

/// Text for an attribute or an element. XML 1.0 knows no control characters but tab and line breaks.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' => out.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_is_counted_and_its_text_escaped() {
        let passed = Case { name: "a < b".into(), seconds: 0.25, failure: None };
        let failed = Case { name: "\u{1}".into(), seconds: 1.0, failure: Some("want \"x\"\n& more".into()) };
        let report = Report { suites: vec![Suite { name: "tiny".into(), cases: vec![passed, failed] }] };
        assert_eq!(
            report.to_xml(),
            r#"<?xml version="1.0" encoding="UTF-8"?>
<testsuites tests="2" failures="1" time="1.250">
  <testsuite name="tiny" tests="2" failures="1" time="1.250">
    <testcase classname="tiny" name="a &lt; b" time="0.250"/>
    <testcase classname="tiny" name="�" time="1.000">
      <failure message="want &quot;x&quot;">want &quot;x&quot;
&amp; more</failure>
    </testcase>
  </testsuite>
</testsuites>
"#
        );
    }
}
