//! A result in the XML that continuous integration reads.

/// Returns JUnit's XML for one suite of one case; `failure` is why it failed, summarised by its first line.
///
/// ```
/// let xml = edof_cosim::junit::report("tiny", "a < b", 0.25, Some("want \"x\"\n\u{1} more"));
/// assert_eq!(
///     xml,
///     r#"<?xml version="1.0" encoding="UTF-8"?>
/// <testsuites tests="1" failures="1" time="0.250">
///   <testsuite name="tiny" tests="1" failures="1" time="0.250">
///     <testcase classname="tiny" name="a &lt; b" time="0.250">
///       <failure message="want &quot;x&quot;">want &quot;x&quot;
/// � more</failure>
///     </testcase>
///   </testsuite>
/// </testsuites>
/// "#
/// );
/// ```
#[must_use]
pub fn report(suite: &str, case: &str, seconds: f64, failure: Option<&str>) -> String {
    let (suite, case) = (escaped(suite), escaped(case));
    let counts = format!("tests=\"1\" failures=\"{}\" time=\"{seconds:.3}\"", u8::from(failure.is_some()));
    let result = failure.map_or_else(
        || "/>".to_owned(),
        |why| {
            let (summary, why) = (escaped(why.lines().next().unwrap_or_default()), escaped(why));
            format!(">\n      <failure message=\"{summary}\">{why}</failure>\n    </testcase>")
        },
    );
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts}>\n  <testsuite name=\"{suite}\" {counts}>\n    \
         <testcase classname=\"{suite}\" name=\"{case}\" time=\"{seconds:.3}\"{result}\n  </testsuite>\n</testsuites>\n"
    )
}

/// Text for an attribute or an element. XML 1.0 knows no control characters except tab and line breaks.
fn escaped(text: &str) -> String {
    let is_illegal =
        |c: char| c.is_control() && c != '\t' && c != '\n' || matches!(c, '\u{fffe}' | '\u{ffff}');
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    text.replace(is_illegal, "\u{fffd}")
}
