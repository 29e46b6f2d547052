//! Moving things on the page, as lists of numbers.

use geometry::pose::Pose2;
use ipc_types::messages::referee::Verdict;

use super::content::{Frame, PageContent};
use super::layers::{Beams, Cloud, Edge, Layers, MethodPrediction, PLACES, Path};
use super::pack::{Lists, NONE, Raster, pack_angle, pack_time};
use super::thinning::Sample;
use crate::picture::Cells;

/// Flag bits above a robot's status.
const IN_CONTACT: u8 = 1 << 4;
const FAIL_SAFE: u8 = 1 << 5;
const PRESENT: u8 = 1 << 6;

/// Packs everything that has a position; moves the layers out of `content`.
pub fn pack(content: &mut PageContent, raster: Raster, lists: &mut Lists) {
    states(content, raster, lists);
    let layers = core::mem::take(&mut content.layers);
    content.layers.horizons_s.clone_from(&layers.horizons_s);
    let Layers {
        beliefs,
        plans,
        trees,
        scans,
        predictions,
        verdicts,
        regions,
        visits,
        horizons_s: _,
    } = layers;
    clouds(&beliefs.finish(), raster, lists);
    plan_points(&plans.finish(), raster, lists);
    edges(&trees.finish(), raster, lists);
    beams(&scans.finish(), lists);
    predicted(&predictions.finish(), raster, lists);
    judged(&verdicts.finish(), lists);
    owners(&regions.finish(), lists);
    place_visits(&visits.finish(), lists);
    places(content, raster, lists);
    content.marks.pack(raster, lists);
    waypoints(content, raster, lists);
    rectangles(content, raster, lists);
}

/// Packs the states robot by robot, because successive states of a robot are similar.
fn states(content: &PageContent, raster: Raster, lists: &mut Lists) {
    // Without states, the page shows the start poses.
    let start = [Sample::default()];
    let is_empty = content.frames.is_empty();
    let frames: &[Sample<Frame>] = if is_empty { &start } else { &content.frames };
    let ticks = frames.iter().map(|f| f.item.tick as u32).collect();
    lists.u32("tick", ticks, 2);
    let times = frames.iter().map(|f| pack_time(f.time_ns)).collect();
    lists.u32("time", times, 2);
    let robots = content.scenario.robots.len();
    let [mut x, mut y, mut theta] = [const { Vec::<u16>::new() }; 3];
    let mut flags = Vec::new();
    for robot in 0..robots {
        let put = content.scenario.robots.get(robot).map(|r| r.start);
        let mut last = put.unwrap_or(Pose2::new(0.0, 0.0, 0.0));
        for frame in frames {
            let state = frame.item.robots.iter().find(|s| s.robot as usize == robot);
            if let Some(s) = state {
                last = Pose2::new(s.x, s.y, s.theta);
            }
            let [px, py] = raster.pack([last.x, last.y]);
            x.push(px);
            y.push(py);
            theta.push(pack_angle(last.theta));
            flags.push(state.map_or(PRESENT, |s| {
                let flag = |on: u8, bit| if on == 0 { 0 } else { bit };
                s.status & 0xf
                    | flag(s.in_contact, IN_CONTACT)
                    | flag(s.fail_safe, FAIL_SAFE)
                    | flag(s.present, PRESENT)
            }));
        }
    }
    lists.u16("x", x, 2);
    lists.u16("y", y, 2);
    lists.u16("theta", theta, 2);
    lists.u8("flags", flags, 1);
}

/// Packs the time, the robot and the number of parts of each item of a layer.
fn index<T>(name: &str, all: &[Sample<T>], parts: impl Fn(&T) -> usize, lists: &mut Lists) {
    let times = all.iter().map(|s| pack_time(s.time_ns)).collect();
    lists.u32(&format!("{name}.time"), times, 1);
    let keys = all.iter().map(|s| s.key as u8).collect();
    lists.u8(&format!("{name}.robot"), keys, 0);
    let counts = all.iter().map(|s| parts(&s.item) as u32).collect();
    lists.u32(&format!("{name}.count"), counts, 1);
}

/// Packs particles in 256 × 256 parts of their bounding rectangle, sorted: their order has no
/// meaning.
fn clouds(all: &[Sample<Cloud>], raster: Raster, lists: &mut Lists) {
    index("beliefs", all, |cloud| cloud.points.len(), lists);
    let (mut boxes, mut means) = (Vec::new(), Vec::new());
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for sample in all {
        let points: Vec<[u16; 2]> = sample
            .item
            .points
            .iter()
            .map(|p| raster.pack(p.map(f64::from)))
            .collect();
        let bound = |i: usize| {
            let of = points.iter().map(move |p| p[i]);
            let (min, max) = (of.clone().min().unwrap_or(0), of.max().unwrap_or(0));
            (min, max - min)
        };
        let ((x, width), (y, height)) = (bound(0), bound(1));
        boxes.extend([x, y, width, height]);
        means.extend(raster.pack(sample.item.mean));
        let part = |value: u16, min: u16, extent: u16| {
            let extent = u32::from(extent).max(1);
            ((u32::from(value - min) * 255 + extent / 2) / extent) as u8
        };
        let mut parts: Vec<[u8; 2]> = points
            .iter()
            .map(|p| [part(p[0], x, width), part(p[1], y, height)])
            .collect();
        parts.sort_unstable();
        xs.extend(parts.iter().map(|p| p[0]));
        ys.extend(parts.iter().map(|p| p[1]));
    }
    lists.u16("beliefs.box", boxes, 0);
    lists.u16("beliefs.mean", means, 0);
    lists.u8("beliefs.x", xs, 1);
    lists.u8("beliefs.y", ys, 0);
}

fn put_places(name: &str, places: impl Iterator<Item = [u16; 2]>, lists: &mut Lists) {
    let (x, y) = places.map(|[x, y]| (x, y)).unzip();
    lists.u16(&format!("{name}.x"), x, 1);
    lists.u16(&format!("{name}.y"), y, 1);
}

fn plan_points(all: &[Sample<Path>], raster: Raster, lists: &mut Lists) {
    index("plans", all, |path| path.points.len(), lists);
    let aims = all.iter().map(|s| u8::from(s.item.has_aim)).collect();
    lists.u8("plans.aim", aims, 0);
    let points = all.iter().flat_map(|s| &s.item.points);
    put_places("plans", points.map(|&p| raster.pack(p)), lists);
}

/// Packs verdicts: margins in 1/100 s, [`NONE`] without a finite one.
fn judged(all: &[Sample<Verdict>], lists: &mut Lists) {
    index("verdicts", all, |_| 1, lists);
    let possible = all.iter().map(|s| u8::from(s.item.escape_possible != 0));
    lists.u8("verdicts.possible", possible.collect(), 0);
    let margin = |verdict: &Verdict| {
        let margin = verdict.margin;
        // The cast saturates below 0.
        let code = (margin * 100.0).round().min(f64::from(NONE - 1)) as u16;
        if margin.is_finite() { code } else { NONE }
    };
    let margins = all.iter().map(|s| margin(&s.item)).collect();
    lists.u16("verdicts.margin", margins, 1);
}

/// Packs the owners of dominance regions; a list is like the one before, cell by cell.
fn owners(all: &[Sample<Vec<u8>>], lists: &mut Lists) {
    index("dominance", all, Vec::len, lists);
    let owners = all.iter().flat_map(|s| &s.item).copied().collect();
    lists.u8("dominance.owner", owners, 0);
}

/// Packs times, patrols and places of visits.
fn place_visits(all: &[Sample<()>], lists: &mut Lists) {
    let times = all.iter().map(|s| pack_time(s.time_ns)).collect();
    lists.u32("visits.time", times, 1);
    let patrols = all.iter().map(|s| (s.key / PLACES) as u8).collect();
    lists.u8("visits.patrol", patrols, 0);
    let places = all.iter().map(|s| (s.key % PLACES) as u16).collect();
    lists.u16("visits.place", places, 1);
}

/// Packs both ends of the places of each patrol.
fn places(content: &PageContent, raster: Raster, lists: &mut Lists) {
    let ends = content
        .patrols
        .iter()
        .flat_map(|p| p.ends().into_iter().flatten());
    put_places("places", ends.map(|p| raster.pack(p)), lists);
}

fn edges(all: &[Sample<Vec<Edge>>], raster: Raster, lists: &mut Lists) {
    index("trees", all, Vec::len, lists);
    let each = || all.iter().flat_map(|s| &s.item);
    let end = |edge: &Edge, i: usize| raster.pack(edge.ends[i].map(f64::from));
    put_places("trees.to", each().map(|edge| end(edge, 1)), lists);
    let back = each().map(|edge| {
        let (from, to) = (end(edge, 0), end(edge, 1));
        [0, 1].map(|i| from[i].wrapping_sub(to[i]))
    });
    let (x, y) = back.map(|[x, y]| (x, y)).unzip();
    lists.u16("trees.back.x", x, 0);
    lists.u16("trees.back.y", y, 0);
    let chosen = each().map(|e| u8::from(e.on_path)).collect();
    lists.u8("trees.path", chosen, 0);
}

/// Packs ranges in millimetres.
fn beams(all: &[Sample<Beams>], lists: &mut Lists) {
    index("scans", all, |beams| beams.ranges.len(), lists);
    let angles = all.iter().flat_map(|s| [s.item.first, s.item.step]);
    lists.u16("scans.angles", angles.map(pack_angle).collect(), 0);
    let ranges = all.iter().flat_map(|s| &s.item.ranges);
    let millimetres = ranges.map(|&range| (f64::from(range) * 1e3).round() as u16);
    let millimetres = millimetres.map(|range| range.min(NONE - 1));
    lists.u16("scans.range", millimetres.collect(), 1);
}

fn predicted(all: &[Sample<Vec<MethodPrediction>>], raster: Raster, lists: &mut Lists) {
    index("predictions", all, Vec::len, lists);
    let each = || all.iter().flat_map(|s| &s.item);
    lists.u8("predictions.method", each().map(|p| p.method).collect(), 0);
    let horizons = each().map(|p| p.horizon).collect();
    lists.u8("predictions.horizon", horizons, 0);
    let places = each().map(|p| raster.pack_if_inside(p.at));
    put_places("predictions", places, lists);
}

fn waypoints(content: &PageContent, raster: Raster, lists: &mut Lists) {
    let all = &content.event_lists.waypoints;
    let times = all.iter().map(|(time_ns, _)| pack_time(*time_ns)).collect();
    lists.u32("waypoints.time", times, 1);
    let places = all.iter().map(|(_, w)| raster.pack_if_inside([w.x, w.y]));
    put_places("waypoints", places, lists);
    let robots = all.iter().map(|(_, w)| w.robot as u8).collect();
    lists.u8("waypoints.robot", robots, 0);
    let outcomes = all.iter().map(|(_, w)| w.outcome).collect();
    lists.u8("waypoints.outcome", outcomes, 0);
}

/// Packs the walls of a map that has no shapes: smallest and largest corner of rectangles.
fn rectangles(content: &PageContent, raster: Raster, lists: &mut Lists) {
    let cells = content.static_scene.cells.as_ref();
    let rectangles = cells.map(Cells::rectangles).unwrap_or_default();
    let corners = rectangles.iter().flatten().flat_map(|&p| raster.pack(p));
    lists.u16("walls", corners.collect(), 0);
}
