//! Results of tests as text, Markdown, `JUnit` XML and annotations of GitHub.

use crate::baseline::TestChange;
use crate::report::{Finding, SuiteReport, TestReport, Verdict, count_text};

/// Maximum number of findings of a test in texts for people.
const MAX_FINDINGS: usize = 10;

/// Maximum number of changed columns of a test in a summary.
const MAX_COLUMNS: usize = 8;

fn subject(test: &TestReport, finding: &Finding) -> String {
    match finding.seed {
        Some(seed) => format!("{}, seed {seed}", test.name),
        None => test.name.clone(),
    }
}

/// Returns the lines of a finding after its expectation.
fn details(finding: &Finding) -> Vec<(&'static str, String)> {
    let optional = [
        ("first difference", finding.first_difference.clone()),
        ("repeat", finding.command.clone()),
        (
            "log",
            finding.log.as_ref().map(|log| log.display().to_string()),
        ),
    ];
    let optional = optional
        .into_iter()
        .filter_map(|(name, text)| Some((name, text?)));
    std::iter::once(("found", finding.found.clone()))
        .chain(optional)
        .collect()
}

/// Returns the findings of a test that are listed, and the number of others.
fn listed(test: &TestReport) -> (&[Finding], usize) {
    let shown = test.findings.len().min(MAX_FINDINGS);
    let first = test.findings.get(..shown).unwrap_or_default();
    (first, test.findings.len() - shown)
}

/// Returns the results as text.
pub fn text(report: &SuiteReport) -> String {
    let mut text = String::new();
    for test in &report.tests {
        text += &format!(
            "{:<13} {} ({})\n",
            test.verdict.name(),
            test.name,
            count_text(test.missions.len())
        );
        let (shown, others) = listed(test);
        for finding in shown {
            let (file, line) = (test.file.display(), finding.line);
            let seed = finding
                .seed
                .map_or_else(String::new, |seed| format!(" (seed {seed})"));
            text += &format!("  {file}:{line}: {}{seed}\n", finding.expected);
            for (name, value) in details(finding) {
                text += &format!("    {name}: {value}\n");
            }
        }
        if others > 0 {
            text += &format!("  and {others} others (--json lists all)\n");
        }
    }
    text + &report.total()
}

/// Returns the results as Markdown: a summary for a pull request, with changes since a baseline.
pub fn markdown(report: &SuiteReport, changes: &[TestChange]) -> String {
    let mut text = format!("### Missions: {}\n", report.total());
    for test in report
        .tests
        .iter()
        .filter(|test| test.verdict != Verdict::Pass)
    {
        text += &format!("\n**{}** {}\n\n", test.verdict.name(), test.name);
        let (shown, others) = listed(test);
        for finding in shown {
            let (file, line) = (test.file.display(), finding.line);
            let seed = finding
                .seed
                .map_or_else(String::new, |seed| format!(", seed {seed}"));
            text += &format!("- {file}:{line}{seed}: {}\n", code(&finding.expected));
            for (name, value) in details(finding) {
                text += &format!("  - {name}: {}\n", code(&value));
            }
        }
        if others > 0 {
            text += &format!("- and {others} others\n");
        }
    }
    if !changes.is_empty() {
        text += "\n### Changed missions\n";
    }
    for change in changes {
        let (changed, missions) = (change.seeds.len(), change.missions);
        text += &format!(
            "\n{}: {changed} of {missions} missions changed",
            change.name
        );
        let first = change
            .seeds
            .first()
            .map_or_else(String::new, ToString::to_string);
        text += &match &change.first_difference {
            Some(difference) => format!(", first {}\n", code(difference)),
            None => format!(", first seed {first}\n"),
        };
        if !change.columns.is_empty() {
            text += "\n| column | pairs | before | now | mean difference, 95 % |\n|---|---|---|---|---|\n";
        }
        for column in change.columns.iter().take(MAX_COLUMNS) {
            let interval = column.difference_95.map_or_else(
                || "-".to_owned(),
                |i| format!("{:.4} to {:.4}", i.low, i.high),
            );
            let (name, pairs) = (&column.column, column.pairs);
            let (before, now) = (column.before, column.now);
            text += &format!("| {name} | {pairs} | {before:.4} | {now:.4} | {interval} |\n");
        }
    }
    text
}

/// Returns a text as code of Markdown, on one line.
fn code(text: &str) -> String {
    format!("`{}`", text.replace('`', "'").replace('\n', " "))
}

/// Returns the results as `JUnit` XML: a test case for each test.
pub fn junit(report: &SuiteReport) -> String {
    let (tests, failures) = (report.tests.len(), report.count(Verdict::Fail));
    let skipped = report.count(Verdict::Inconclusive);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"protean\" tests=\"{tests}\" \
         failures=\"{failures}\" errors=\"0\" skipped=\"{skipped}\" time=\"{:.3}\">\n",
        report.wall_time_s
    );
    for test in &report.tests {
        let (name, file) = (escape(&test.name), escape(&test.file.display().to_string()));
        text += &format!(
            "<testcase name=\"{name}\" classname=\"{file}\" file=\"{file}\" line=\"{}\">",
            test.line
        );
        let element = match test.verdict {
            Verdict::Pass => None,
            Verdict::Inconclusive => Some("skipped"),
            Verdict::Fail => Some("failure"),
        };
        if let Some(element) = element {
            let lines: Vec<String> = test.findings.iter().map(|f| message(test, f)).collect();
            let first = lines.first().map_or("not all missions ran", |line| {
                line.lines().next().unwrap_or_default()
            });
            text += &format!(
                "<{element} message=\"{}\">{}</{element}>",
                escape(first),
                escape(&lines.join("\n"))
            );
        }
        text += "</testcase>\n";
    }
    text + "</testsuite>\n</testsuites>\n"
}

/// Returns a finding as text with several lines.
fn message(test: &TestReport, finding: &Finding) -> String {
    let mut text = format!("{}: expected {}", subject(test, finding), finding.expected);
    for (name, value) in details(finding) {
        text += &format!("\n{name}: {value}");
    }
    text
}

/// Returns a text for XML; characters that it cannot contain are left out.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            c if c < ' ' && !"\t\n\r".contains(c) => {}
            c => escaped.push(c),
        }
    }
    escaped
}

/// Returns an annotation of GitHub for each finding: an error, or a warning if it is not decided.
pub fn annotations(report: &SuiteReport) -> String {
    let mut text = String::new();
    for test in &report.tests {
        for finding in listed(test).0 {
            let level = if finding.verdict == Verdict::Fail {
                "error"
            } else {
                "warning"
            };
            let file = property(&test.file.display().to_string());
            let title = property(&subject(test, finding));
            let message = data(&message(test, finding));
            text += &format!(
                "::{level} file={file},line={},title={title}::{message}\n",
                finding.line
            );
        }
    }
    text
}

/// Returns the text of a command of a workflow.
fn data(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

/// Returns the value of a property of such a command.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}
