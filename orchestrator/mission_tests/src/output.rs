//! Results of tests as text, Markdown, `JUnit` XML and annotations of GitHub.

use draw::canvas::escape;

use crate::baseline::TestChange;
use crate::report::{Finding, SuiteReport, TestReport, Verdict, count_text};

/// Maximum number of findings of a test in texts for people.
const MAX_FINDINGS: usize = 10;

/// Maximum number of changed columns of a test in a summary.
const MAX_COLUMNS: usize = 8;

/// Returns the lines of a finding: place and expectation, the value, and what helps to find the reason.
fn lines(test: &TestReport, finding: &Finding) -> Vec<String> {
    let (file, line, expected) = (test.file.display(), finding.line, &finding.expected);
    let seed = finding.seed.map(|seed| format!(" (seed {seed})"));
    let log = finding.log.as_ref().map(|log| log.display().to_string());
    let rest = [
        ("found", Some(&finding.found)),
        ("first difference", finding.first_difference.as_ref()),
        ("repeat", finding.command.as_ref()),
        ("log", log.as_ref()),
    ];
    let rest = rest.into_iter();
    let rest = rest.filter_map(|(name, text)| Some(format!("{name}: {}", text?)));
    let first = format!("{file}:{line}: {expected}{}", seed.unwrap_or_default());
    std::iter::once(first).chain(rest).collect()
}

/// Returns the findings of a test that are listed, and the number of others.
fn listed(test: &TestReport) -> (&[Finding], usize) {
    let shown = test.findings.len().min(MAX_FINDINGS);
    let first = test.findings.get(..shown).unwrap_or_default();
    (first, test.findings.len() - shown)
}

/// Returns the findings of a test as lines.
fn findings(test: &TestReport) -> String {
    let (shown, others) = listed(test);
    let mut text = String::new();
    for finding in shown {
        text += &format!("  {}\n", lines(test, finding).join("\n    "));
    }
    if others > 0 {
        text += &format!("  and {others} others (--json lists all)\n");
    }
    text
}

/// Returns the results as text.
pub fn text(report: &SuiteReport) -> String {
    let mut text = String::new();
    for test in &report.tests {
        let (verdict, missions) = (test.verdict.name(), count_text(test.missions.len()));
        text += &format!("{verdict:<13} {} ({missions})\n", test.name);
        text += &findings(test);
    }
    text + &report.total()
}

/// Returns the results as Markdown: a summary for a pull request, with changes since a baseline.
pub fn markdown(report: &SuiteReport, changes: &[TestChange]) -> String {
    let mut text = format!("### Missions: {}\n", report.total());
    let open = |test: &&TestReport| test.verdict != Verdict::Pass;
    for test in report.tests.iter().filter(open) {
        let findings = findings(test).replace('`', "'");
        let (verdict, name) = (test.verdict.name(), &test.name);
        text += &format!("\n**{verdict}** {name}\n\n```text\n{findings}```\n");
    }
    if !changes.is_empty() {
        text += "\n### Changed missions\n";
    }
    for change in changes {
        let (name, changed, missions) = (&change.name, change.seeds.len(), change.missions);
        let seed = change.seeds.first().map(|seed| format!("seed {seed}"));
        let difference = change.first_difference.as_ref();
        let difference = difference.map(|text| format!("`{}`", text.replace('`', "'")));
        let first = difference.or(seed).unwrap_or_default();
        text += &format!("\n{name}: {changed} of {missions} missions changed, first {first}\n");
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

/// Returns the results as `JUnit` XML: a test case for each test.
pub fn junit(report: &SuiteReport) -> String {
    let (tests, failures) = (report.tests.len(), report.count(Verdict::Fail));
    let (skipped, time) = (report.count(Verdict::Inconclusive), report.wall_time_s);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"protean\" tests=\"{tests}\" \
         failures=\"{failures}\" errors=\"0\" skipped=\"{skipped}\" time=\"{time:.3}\">\n"
    );
    for test in &report.tests {
        let (name, file) = (escape(&test.name), escape(&test.file.display().to_string()));
        let line = test.line;
        text += &format!(
            "<testcase name=\"{name}\" classname=\"{file}\" file=\"{file}\" line=\"{line}\">"
        );
        let element = match test.verdict {
            Verdict::Pass => "",
            Verdict::Inconclusive => "skipped",
            Verdict::Fail => "failure",
        };
        if !element.is_empty() {
            let lines = test
                .findings
                .iter()
                .flat_map(|finding| lines(test, finding));
            let lines: Vec<String> = lines.map(|line| escape(&line)).collect();
            let first = lines.first().map_or("not all missions ran", String::as_str);
            let all = lines.join("\n");
            text += &format!("<{element} message=\"{first}\">{all}</{element}>");
        }
        text += "</testcase>\n";
    }
    text + "</testsuite>\n</testsuites>\n"
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
            let (file, name) = (
                property(&test.file.display().to_string()),
                property(&test.name),
            );
            let (line, message) = (finding.line, data(&lines(test, finding).join("\n")));
            text += &format!("::{level} file={file},line={line},title={name}::{message}\n");
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
