//! The HTML around the data: one file that loads nothing else.

use serde_json::Value as Json;

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
/// Scripts of the whole page.
const SHARED: [&str; 2] = [
    include_str!("page/clock.js"),
    include_str!("page/difference.js"),
];
/// The scripts of a run, each after those that it uses.
const VIEWER: [&str; 12] = [
    include_str!("page/data.js"),
    include_str!("page/ground.js"),
    include_str!("page/view.js"),
    include_str!("page/paths.js"),
    include_str!("page/areas.js"),
    include_str!("page/marks.js"),
    include_str!("page/layers.js"),
    include_str!("page/timeline.js"),
    include_str!("page/plots.js"),
    include_str!("page/decided.js"),
    include_str!("page/tables.js"),
    include_str!("page/player.js"),
];
/// The scripts that start all.
const START: [&str; 4] = [
    include_str!("page/live.js"),
    include_str!("page/world.js"),
    include_str!("page/what_if.js"),
    include_str!("page/start.js"),
];

/// A run on the page: its facts (JSON), and its lists of numbers (base64).
#[derive(Debug)]
pub struct Run {
    pub(super) facts: Json,
    pub(super) data: String,
}

impl Run {
    fn title(&self) -> &str {
        let title = self.facts.get("title").and_then(Json::as_str);
        title
            .filter(|title| !title.is_empty())
            .or_else(|| self.facts.get("scenario").and_then(Json::as_str))
            .unwrap_or("Mission")
    }
}

/// Inserts runs, and the comparison of two, into the page; without a run it shows that of its server.
pub fn page(runs: &[Run], comparison: Option<&Json>, colours: &str) -> String {
    let mut titles: Vec<&str> = runs.iter().map(Run::title).collect();
    titles.dedup();
    if runs.is_empty() {
        titles.push("Live");
    }
    let size: usize = runs.iter().map(|run| run.data.len()).sum();
    let mut page = String::with_capacity(size + (256 << 10));
    let mut rest = PAGE;
    // Inserted parts are not searched for placeholders: they may contain any text.
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((mark, after)) = after.split_once("}}") else {
            break;
        };
        page.push_str(before);
        match mark {
            "title" => page.push_str(&escaped(&titles.join(", "))),
            "colours" => page.push_str(colours),
            // Without runs, the page asks its server for one.
            "connect" if runs.is_empty() => page.push_str("; connect-src 'self'"),
            "style" => page.push_str(STYLE),
            "runs" => {
                for Run { facts, data } in runs {
                    page.push_str("<script class=\"facts\" type=\"application/json\">");
                    page.push_str(&in_script(&facts.to_string()));
                    page.push_str("</script>\n<script type=\"application/octet-stream\">");
                    page.push_str(data);
                    page.push_str("</script>\n");
                }
            }
            "difference" => {
                if let Some(comparison) = comparison {
                    page.push_str("<script id=\"compared\" type=\"application/json\">");
                    page.push_str(&in_script(&comparison.to_string()));
                    page.push_str("</script>");
                }
            }
            "shared" => SHARED.iter().for_each(|script| page.push_str(script)),
            "viewer" => VIEWER.iter().for_each(|script| page.push_str(script)),
            "start" => START.iter().for_each(|script| page.push_str(script)),
            _ => {}
        }
        rest = after;
    }
    page.push_str(rest);
    page
}

/// Text escaped for use between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// JSON escaped so that no string in it ends the script element.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn run(facts: Json) -> Run {
        let data = "QUJD".to_owned();
        Run { facts, data }
    }

    #[test]
    fn names_from_the_log_are_escaped() {
        let evil = "</script><script>alert(1)</script>{{data}}<!--";
        let page = page(
            &[run(json!({ "title": evil, "x": evil }))],
            Some(&json!({ "error": evil })),
            "--ink:#000;",
        );
        assert!(!page.contains("alert(1)<"), "escaped");
        assert_eq!(page.matches("QUJD").count(), 1);
        assert!(page.contains("&lt;/script&gt;"));
        assert!(page.contains("\\u003c/script>"));
    }

    #[test]
    fn the_page_is_complete_and_loads_nothing() {
        let page = page(
            &[
                run(json!({ "scenario": "chase" })),
                run(json!({ "title": "Hello" })),
            ],
            None,
            "",
        );
        assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
        assert!(page.contains("<title>chase, Hello"));
        assert!(page.contains("default-src 'none'") && !page.contains("connect-src"));
        for outside in ["http://", "https://", "src=", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
    }
}
