//! Description of a log as text.

use recorder::{MessageCounts, time_text};
use tables::TerminalTable;

use super::info::LogInfo;

/// Returns the summary as text.
pub fn text(info: &LogInfo) -> String {
    let mut text = head(info);
    let columns = [
        ("topic", 0),
        ("messages", 0),
        ("bytes", 3),
        ("rate (Hz)", 1),
        ("first (s)", 5),
        ("last (s)", 4),
        ("longest pause (s)", 2),
        ("lost", 0),
    ];
    let mut table = TerminalTable::new(columns, 1);
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.2}"));
    let time = |value: Option<f64>| value.map_or_else(String::new, time_text);
    let with = info.topics.iter().filter(|(_, topic)| topic.messages > 0);
    for (name, topic) in with {
        table.add_row([
            name.clone(),
            topic.messages.to_string(),
            topic.bytes.to_string(),
            number(topic.rate_hz),
            time(topic.first_s),
            time(topic.last_s),
            time(topic.longest_pause_s),
            topic
                .gaps
                .map_or_else(|| "?".to_owned(), |gaps| gaps.to_string()),
        ]);
    }
    text += &format!("\n{table}\n");
    let without = info.topics.values().filter(|topic| topic.messages == 0);
    let without = without.count();
    if without > 0 {
        text += &format!("{without} topics have no messages\n");
    }
    for (name, topic) in &info.topics {
        if topic.gaps_by_source.len() > 1 || topic.gaps.is_some_and(|gaps| gaps > 0) {
            let of: Vec<String> = topic
                .gaps_by_source
                .iter()
                .map(|(source, gaps)| format!("{gaps} of source {source}"))
                .collect();
            text += &format!("lost        {name}: {}\n", of.join(", "));
        }
    }
    text += &condition(info);
    text.trim_end().to_owned()
}

fn head(info: &LogInfo) -> String {
    let mut text = match (&info.scenario, info.seed) {
        (Some(scenario), Some(seed)) => format!("{scenario} (seed {seed})"),
        (Some(scenario), None) => scenario.clone(),
        _ if info.ours => "Protean log".to_owned(),
        _ => "not a Protean log (no scenario, seed or digest)".to_owned(),
    };
    text += &format!(
        ": {} s, from {} to {} s\n",
        time_text(info.duration_s),
        time_text(info.start_s),
        time_text(info.end_s),
    );
    let mut line = |name: &str, value: &str| {
        if !value.is_empty() {
            text += &format!("{name:<12}{value}\n");
        }
    };
    line("written by", &info.library);
    line("profile", &info.profile);
    line("mode", info.mode.as_deref().unwrap_or_default());
    line("machine", info.machine.as_deref().unwrap_or_default());
    match (&info.digest, &info.run_digest) {
        (Some(digest), _) => line("digest", digest),
        (None, Some(digest)) => line(
            "digest",
            &format!("{digest} (of the whole run, not of this part)"),
        ),
        _ if info.ours => line("digest", "none: the run did not reach its end"),
        _ => {}
    }
    for branch in &info.branches {
        let parent = branch["parent"].as_str().unwrap_or_default();
        let at = time_text(branch["at_s"].as_f64().unwrap_or_default());
        line(
            "branch",
            &format!("of {parent} from {at} s on, with {}", branch["change"]),
        );
    }
    let list = |map: &std::collections::BTreeMap<String, String>| {
        let entries = map.iter().filter(|(key, _)| *key != "faults");
        let entries: Vec<String> = entries.map(|(k, v)| format!("{k} {v}")).collect();
        entries.join(", ")
    };
    line("recovered", &list(&info.recovered));
    for robot in &info.robots {
        let outcome = robot.outcome.replace('_', " ");
        let when = if outcome == "active" { "until" } else { "at" };
        let time = time_text(robot.time_s);
        let what = format!("{} {outcome} {when} {time} s", robot.name);
        line("outcome", &what);
    }
    for (name, bytes) in &info.attachments {
        line("attached", &format!("{name} ({bytes} bytes)"));
    }
    text
}

fn condition(info: &LogInfo) -> String {
    let c = &info.condition;
    let mb = |bytes: u64| bytes as f64 * 1e-6;
    let messages = if info.ours {
        MessageCounts::from_topics(&info.topics, |topic| topic.messages).to_string()
    } else {
        info.messages.to_string()
    };
    let mut text = format!(
        "messages    {messages} in a file of {:.2} MB\n",
        mb(c.file_bytes)
    );
    for (compression, chunks) in &c.chunks {
        let (count, packed) = (chunks.count, mb(chunks.compressed_bytes));
        text += &match compression.as_str() {
            "" => format!("data        {packed:.2} MB in {count} chunks, not compressed\n"),
            name => format!(
                "data        {:.2} MB, compressed with {name} to {packed:.2} MB in {count} chunks\n",
                mb(chunks.uncompressed_bytes)
            ),
        };
    }
    if c.messages_unchecked > 0 {
        text += &format!(
            "unchecked   {} of {} messages: no checksum covers them{}\n",
            c.messages_unchecked,
            info.messages,
            match c.chunks_unchecked {
                0 => String::new(),
                chunks => format!(" ({chunks} chunks without a checksum)"),
            }
        );
    }
    if info.unsorted > 0 {
        text += &format!(
            "order       {} messages follow a later one of their topic\n",
            info.unsorted
        );
    }
    text += match (c.summary, c.index) {
        (true, true) => "index       complete: programs can jump to any time\n",
        (true, false) => {
            "index       of a part of the messages: programs must read the whole file\n"
        }
        (false, _) => "index       none: programs must read the whole file\n",
    };
    if c.is_whole() {
        text += &match c.checksums {
            0 => "condition   complete, not verified: the file has no checksums\n".to_owned(),
            1 => "condition   complete: its checksum is correct\n".to_owned(),
            all => format!("condition   complete: every checksum is correct ({all})\n"),
        };
    } else {
        text += "condition   INCOMPLETE: `protean recover` makes a log of the readable part\n";
        for line in c.lines() {
            text += &format!("            {line}\n");
        }
        if let Some(lost) = c
            .claimed_messages
            .and_then(|n| n.checked_sub(info.messages))
        {
            text += &format!("            {lost} messages are lost\n");
        }
    }
    text
}
