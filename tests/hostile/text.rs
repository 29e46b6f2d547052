//! Untrusted text on the terminal and in pages, and untrusted commands in logs.

use super::changed;
use crate::support::Sandbox;
use crate::support::call::Outcome;

/// Asserts that nothing of this steers a terminal.
#[track_caller]
fn harmless(outcome: &Outcome) {
    for text in [&outcome.stdout, &outcome.stderr] {
        let steers = |c: char| {
            c.is_control() && c != '\n' && c != '\t'
                || matches!(c, '\u{61c}' | '\u{202e}' | '\u{2067}')
        };
        assert!(!text.contains(steers), "{text:?}");
    }
}

#[test]
fn titles_topics_and_stderr_lines_are_escaped_on_the_terminal() {
    let sandbox = Sandbox::new();
    let evil = "\\u001b]0;owned\\u0007\\u009b31m\\u202e\\u061c\\u2067</script><script>alert(1)</script>\\\"'";
    let title = format!("title = \"{evil}\"");
    let text = changed("title = \"Hello\"", &title).replacen(
        "[world]",
        &format!("name = \"{evil}\"\n[world]"),
        1,
    );
    sandbox.file("evil.toml", &text);
    let ran = sandbox
        .protean(["run", "evil.toml", "--out", "evil.mcap"])
        .set(crate::support::call::PATIENCE)
        .run();
    assert_eq!(ran.code, Some(0), "{ran}");
    harmless(&ran);
    assert!(
        ran.stdout
            .contains("\\u001b]0;owned\\u0007\\u009b31m\\u202e\\u061c\\u2067"),
        "{ran}"
    );
    for call in [
        &["check", "evil.toml"][..],
        &["check", "evil.toml", "--print"],
        &["check", "evil.toml", "--json"],
        &["info", "evil.mcap"],
        &["info", "evil.mcap", "--json"],
        &["verify", "evil.mcap", "--in-process"],
        &["report", "evil.mcap", "--out", "evil.html"],
        &["picture", "evil.mcap", "--out", "evil.svg"],
        &["export", "evil.mcap", "--out", "tables"],
    ] {
        let outcome = sandbox.protean(call.iter().copied()).run();
        assert_eq!(outcome.code, Some(0), "{call:?}: {outcome}");
        harmless(&outcome);
    }
    // The printed text is readable.
    let printed = sandbox.protean(["check", "evil.toml", "--print"]).run();
    sandbox.file("again.toml", &printed.stdout);
    let again = sandbox.protean(["check", "again.toml", "--print"]).run();
    assert_eq!(again.stdout, printed.stdout);
    let page = std::fs::read_to_string(sandbox.path().join("evil.html")).unwrap();
    assert!(page.contains("owned"), "the title is somewhere");
    assert!(!page.contains("<script>alert(1)"), "and ends no script");
    let picture = std::fs::read_to_string(sandbox.path().join("evil.svg")).unwrap();
    assert!(!picture.contains("<script"), "{picture}");
    sandbox.assert_nothing_left();
}

#[test]
fn stderr_lines_of_a_process_cannot_control_the_terminal() {
    let sandbox = Sandbox::new();
    let text = changed(
        "kind = \"evader_potential\"",
        "name = \"liar\"\ncommand = [\"/bin/sh\", \"-c\", \"printf 'bye \\\\033[2J\\\\n' >&2; exit 3\"]",
    );
    sandbox.file("liar.toml", text);
    let outcome = sandbox
        .protean(["run", "liar.toml", "--allow-external"])
        .run();
    assert_eq!(outcome.code, Some(1), "{outcome}");
    harmless(&outcome);
    assert!(outcome.stderr.contains("bye \\u001b[2J"), "{outcome}");
}

#[test]
fn no_command_starts_programs_of_a_scenario_or_of_a_log_unasked() {
    let sandbox = Sandbox::new();
    let mark = sandbox.path().join("started");
    let command = format!("name = \"liar\"\ncommand = [\"/usr/bin/touch\", {mark:?}]");
    let evil = changed("kind = \"evader_potential\"", &command);
    sandbox.file("evil.toml", &evil);
    // The log of a harmless run with its scenario replaced.
    let named = "name = \"liar\"\nkind = \"evader_potential\"";
    sandbox.file("good.toml", changed("kind = \"evader_potential\"", named));
    let ran = sandbox
        .protean(["run", "good.toml", "--out", "good.mcap"])
        .set(crate::support::call::PATIENCE)
        .run();
    assert_eq!(ran.code, Some(0), "{ran}");
    exchange_scenario(
        &sandbox.path().join("good.mcap"),
        &sandbox.path().join("evil.mcap"),
        &evil,
    );
    sandbox.file(
        "experiment.toml",
        "scenario = \"evil.toml\"\nseeds = { first = 1, count = 1 }\n[[cases]]\nname = \"a\"\n",
    );
    for call in [
        &["run", "evil.toml"][..],
        &["verify", "evil.mcap"],
        &["replay", "evil.mcap", "--test", "liar"],
        &["sweep", "experiment.toml"],
    ] {
        let outcome = sandbox.protean(call.iter().copied()).run();
        outcome.refused(2, &["--allow-external"]);
    }
    for call in [
        &["check", "evil.toml"][..],
        &["info", "evil.mcap"],
        &["report", "evil.mcap", "--out", "evil.html"],
    ] {
        let outcome = sandbox.protean(call.iter().copied()).run();
        assert_eq!(outcome.code, Some(0), "{call:?}: {outcome}");
    }
    assert!(!mark.exists(), "it was started");
}

/// Copies a log with another scenario in its attachment.
fn exchange_scenario(from: &std::path::Path, to: &std::path::Path, scenario: &str) {
    use std::borrow::Cow;
    let bytes = std::fs::read(from).unwrap();
    let mut writer = mcap::Writer::new(std::fs::File::create(to).unwrap()).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    for (id, schema) in &summary.schemas {
        writer
            .add_schema_with_id(*id, &schema.name, &schema.encoding, &schema.data)
            .unwrap();
    }
    for (id, channel) in &summary.channels {
        writer
            .add_channel_with_id(
                *id,
                channel.schema.as_ref().map_or(0, |schema| schema.id),
                &channel.topic,
                &channel.message_encoding,
                &channel.metadata,
            )
            .unwrap();
    }
    for index in &summary.metadata_indexes {
        let mut metadata = mcap::read::metadata(&bytes, index).unwrap();
        // An attacker would remove the scenario's hash as well.
        metadata.metadata.remove("scenario_blake3");
        writer.write_metadata(&metadata).unwrap();
    }
    for index in &summary.attachment_indexes {
        let attachment = mcap::read::attachment(&bytes, index).unwrap();
        let data = match &*attachment.name {
            "scenario.toml" => Cow::Owned(scenario.as_bytes().to_vec()),
            _ => attachment.data.clone(),
        };
        writer
            .attach(&mcap::Attachment { data, ..attachment })
            .unwrap();
    }
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let header = mcap::records::MessageHeader {
            channel_id: message.channel.id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        writer
            .write_to_known_channel(&header, &message.data)
            .unwrap();
    }
    writer.finish().unwrap();
}
