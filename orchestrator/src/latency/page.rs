//! Everything that was measured as one page for a browser, which loads nothing from anywhere.

use std::fmt::Write as _;

use super::chain::{REACTION, Stage, WHOLE};
use super::micro::Micro;
use super::report::{Report, Run};
use super::text::{deadlines, headline, us, varied, way_name, way_of};
use crate::bench::link::{Carrier, Placement};
use crate::figures::{Bar, Chart, Point, Scale, Series, Stack, Unit, draw};
use crate::mission::report::machine;
use crate::picture::canvas::escape;
use crate::statistics::{Distribution, Percentiles};

const STYLE: &str = include_str!("page.css");

/// Most points of a curve.
const POINTS: usize = 240;

/// The page.
pub fn page(report: &Report) -> String {
    let names: Vec<String> = report.runs.iter().map(headline).collect();
    let title = match (names.first(), &report.micro) {
        (Some(first), _) => format!("Latency: {first}"),
        (None, Some(_)) => "Latency of one hop".to_owned(),
        (None, None) => "Latency".to_owned(),
    };
    let [one, five, fifteen] = report.load;
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
         <p class=\"hint\">{}; load {one:.1} {five:.1} {fifteen:.1} when it began; protean {}; all \
         times in microseconds</p>\n",
        escape(&machine()),
        env!("CARGO_PKG_VERSION"),
        title = escape(&title),
    );
    if report.interrupted {
        page += "<p class=\"warn\">It was interrupted: not everything was measured.</p>\n";
    }
    for error in &report.errors {
        let _ = writeln!(page, "<p class=\"warn\">{}</p>", escape(error));
    }
    if !report.runs.is_empty() {
        figure(&mut page, &stages(&report.runs).draw().svg());
    }
    for run in &report.runs {
        of_run(&mut page, run);
    }
    if let Some(micro) = &report.micro {
        of_micro(&mut page, micro);
    }
    page += "</body>\n</html>\n";
    page
}

fn figure(page: &mut String, svg: &str) {
    // A drawing is a document of its own; within a page its first line has no place.
    let svg = svg.find("<svg").and_then(|at| svg.get(at..));
    let _ = writeln!(page, "<figure>{}</figure>", svg.unwrap_or_default());
}

/// What takes how long on average, without the wait for the tick.
fn stages(runs: &[Run]) -> Stack {
    let shown = |stage: &Stage| *stage != Stage::Wait;
    Stack {
        title: "From the state of the world to the commands for it".to_owned(),
        subtitle: "mean per tick, stage by stage; without the wait of finished commands for the \
                   next tick"
            .to_owned(),
        label: "time [us]".to_owned(),
        parts: Stage::ALL
            .iter()
            .filter(|s| shown(s))
            .map(|s| s.name().to_owned())
            .collect(),
        bars: runs
            .iter()
            .map(|run| Bar {
                name: match run.measured.period_ns {
                    Some(period) => format!("{:.0} Hz", 1e9 / period.max(1) as f64),
                    None => "lock-step".to_owned(),
                },
                parts: Stage::ALL
                    .iter()
                    .zip(run.means())
                    .filter(|(s, _)| shown(s))
                    .map(|(_, mean)| mean)
                    .collect(),
            })
            .collect(),
    }
}

/// Shares of a distribution as a curve.
fn curve(name: &str, distribution: &Distribution) -> Series {
    let all = distribution.shares();
    let every = all.len().div_ceil(POINTS).max(1);
    let last = all.len().saturating_sub(1);
    let kept = all.iter().enumerate();
    Series {
        name: name.to_owned(),
        points: kept
            .filter(|(at, _)| at % every == 0 || *at == last)
            .map(|(_, (us, share))| Point {
                x: *us,
                y: *share,
                interval: None,
            })
            .collect(),
        reference: Vec::new(),
    }
}

fn shares(title: &str, subtitle: &str, series: Vec<Series>) -> Chart {
    Chart {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        x_label: "time [us], logarithmic".to_owned(),
        x_scale: Scale::Logarithmic,
        lines_only: true,
        y_label: "took at most that long".to_owned(),
        unit: Unit::Share,
        series,
        ..Chart::default()
    }
}

fn of_run(page: &mut String, run: &Run) {
    let _ = writeln!(page, "<h2>{}</h2>\n<ul>", escape(&headline(run)));
    for line in deadlines(run) {
        let _ = writeln!(page, "<li>{}</li>", escape(&line));
    }
    page.push_str("</ul>\n");
    let m = &run.measured;
    let of = |names: &[&str]| -> Vec<Series> {
        let known = names
            .iter()
            .filter_map(|name| Some((name, m.distribution(name)?)));
        known.map(|(name, own)| curve(name, own)).collect()
    };
    let names = Stage::ALL.map(Stage::name);
    let mut names: Vec<&str> = names.to_vec();
    names.extend([REACTION, WHOLE]);
    let chart = shares(
        "Stages from sense to act",
        "share of ticks by the time that a stage took",
        of(&names),
    );
    figure(page, &draw(&chart).svg());
    let mut hops: Vec<Series> = m
        .hops()
        .filter(|(name, _)| name.contains(" to "))
        .map(|(name, own)| curve(name, own))
        .collect();
    hops.extend(
        run.baselines
            .iter()
            .filter(|b| b.placement == Placement::Unpinned && b.topic == "world/state")
            .map(|b| curve(&format!("baseline: {}", way_name(b)), &b.latency)),
    );
    let chart = shares(
        "Hops between processes",
        "and messages as large as world/state between two idle processes, unpinned; a hop to the \
         simulator in real time includes the wait for the tick",
        hops,
    );
    figure(page, &draw(&chart).svg());
    let rows = run.stages();
    percentiles(
        page,
        "from sense to act",
        rows.iter().map(|(n, p)| ((*n).to_owned(), *p)),
    );
    let row = |(name, own): (&String, &Distribution)| (name.clone(), own.percentiles());
    percentiles(page, "hop", m.hops().map(row));
    percentiles(page, "part of a turn", m.turns.iter().map(row));
    if !run.baselines.is_empty() {
        let rows = run.baselines.iter().map(|b| {
            let name = format!(
                "{}, {} B, {}, {}",
                b.topic,
                b.bytes,
                b.way.name(),
                b.placement.name()
            );
            (name, b.latency.percentiles())
        });
        percentiles(page, "baseline", rows);
    }
}

fn percentiles(page: &mut String, title: &str, rows: impl Iterator<Item = (String, Percentiles)>) {
    let _ = write!(
        page,
        "<div class=\"scroll\"><table>\n<thead><tr><th>{}</th><th>count</th><th>p50</th><th>p90</th>\
         <th>p99</th><th>p99.9</th><th>max</th><th>jitter</th></tr></thead>\n<tbody>\n",
        escape(title)
    );
    for (name, p) in rows {
        let _ = write!(page, "<tr><td>{}</td><td>{}</td>", escape(&name), p.count);
        for value in [p.p50, p.p90, p.p99, p.p999, p.max, p.jitter] {
            let _ = write!(page, "<td>{}</td>", us(value));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody></table></div>\n");
}

fn of_micro(page: &mut String, micro: &Micro) {
    page.push_str("<h2>One hop</h2>\n");
    let chart = by_payload(micro);
    if !chart.series.is_empty() {
        figure(page, &draw(&chart).svg());
    }
    page.push_str(
        "<div class=\"scroll\"><table>\n<thead><tr><th>varied</th><th class=\"text\">way</th><th>p50</th><th>p90</th>\
         <th>p99</th><th>max</th><th>sending p50</th><th>to raw</th></tr></thead>\n<tbody>\n",
    );
    for hop in &micro.hops {
        let _ = write!(
            page,
            "<tr><td>{}: {}</td><td class=\"text\">{}</td>",
            hop.part,
            escape(&varied(hop)),
            escape(&way_of(hop))
        );
        let l = &hop.latency;
        for value in [l.p50, l.p90, l.p99, l.max, hop.sending.p50] {
            let _ = write!(page, "<td>{}</td>", us(value));
        }
        let ratio = hop.ratio.map_or_else(String::new, |r| format!("{r:.2}×"));
        let _ = writeln!(page, "<td>{ratio}</td></tr>");
    }
    page.push_str("</tbody></table></div>\n");
}

/// Median latency by payload, untouched, where it has to be flat; and written.
fn by_payload(micro: &Micro) -> Chart {
    let of = |name: &str, carrier: Carrier, written: bool| Series {
        name: name.to_owned(),
        points: micro
            .hops
            .iter()
            .filter(|hop| {
                hop.part == "payload" && hop.way.carrier == carrier && hop.way.written == written
            })
            .map(|hop| Point {
                x: hop.bytes as f64,
                y: hop.latency.p50,
                interval: None,
            })
            .collect(),
        reference: Vec::new(),
    };
    let mut series = vec![
        of("protean, untouched", Carrier::Ours, false),
        of("raw iceoryx2, untouched", Carrier::Raw, false),
        of("protean, written", Carrier::Ours, true),
        of("raw iceoryx2, written", Carrier::Raw, true),
    ];
    series.retain(|s| !s.points.is_empty());
    Chart {
        title: "One hop by payload".to_owned(),
        subtitle: "median; written: every byte is copied into the message; untouched: memory is \
                   handed over as it is"
            .to_owned(),
        x_label: "payload [bytes], logarithmic".to_owned(),
        x_scale: Scale::Logarithmic,
        y_label: "one way [us], logarithmic".to_owned(),
        y_scale: Scale::Logarithmic,
        unit: Unit::Number,
        series,
        ..Chart::default()
    }
}
