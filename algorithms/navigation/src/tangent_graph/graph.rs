//! The graph: tracks around the sites, and the tangents between them.
//!
//! A *track* is a site travelled in one of its two turns; positions on it are angles from its
//! start. A *vertex* is the position on a track where a tangent departs. From there a path has at
//! most two continuations. It takes the tangent, lands on another track and follows it to the next
//! departure, or it stays on its own track to the next departure.

use core::f64::consts::TAU;

use nalgebra::Point2;

use super::sites::Site;
use super::tangent::{self, Turn};
use super::{GraphError, MAX_TANGENTS};
use planner_view::free_space::FreeSpace;

/// Angles (rad) closer than this are one position; it only covers rounding. Of two tangents that
/// depart from one position, the shorter lies on the longer: the longer is left out.
const SAME_PLACE: f64 = 1e-11;
/// Angle (rad) that a path may go back on a track: a tangent that only touches a site lands and
/// departs at the same position except for rounding.
const BACK: f64 = 1e-9;

/// No vertex.
pub const NONE: u32 = u32::MAX;

/// A tangent with the position where it departs.
#[derive(Debug, Clone, Copy)]
pub struct Vertex {
    /// Track on which it departs.
    pub track: u32,
    /// Position of departure on the track (rad).
    pub at: f64,
    /// Length of the tangent (m).
    pub length: f64,
    /// Track on which it lands.
    pub to_track: u32,
    /// Position of landing on the track (rad).
    pub to_at: f64,
    /// Ends of the tangent (m).
    pub ends: [Point2<f64>; 2],
    /// The next departure after landing; [`NONE`] if there is none.
    pub next: u32,
    /// Cost (m) of the tangent and the arc to `next`.
    pub next_cost: f64,
    /// The next departure on the same track; [`NONE`] if there is none.
    pub stay: u32,
    /// Cost (m) of the arc to `stay`.
    pub stay_cost: f64,
}

/// Tracks and tangents; see the module.
#[derive(Debug)]
pub struct Graph {
    pub sites: Vec<Site>,
    /// Vertices, sorted by track and position.
    pub vertices: Vec<Vertex>,
    /// Index of the first vertex of each track; one more entry than tracks.
    first: Vec<u32>,
    /// Vertices grouped by their `next`.
    landing: Vec<u32>,
    /// Index in `landing` of the first vertex of each group.
    landing_first: Vec<u32>,
}

/// The track of a site and a turn.
pub fn track(site: u32, turn: Turn) -> u32 {
    2 * site + u32::from(turn < 0.0)
}

/// The turn of a track.
pub fn turn(track: u32) -> Turn {
    if track.is_multiple_of(2) { 1.0 } else { -1.0 }
}

impl Graph {
    /// Finds the free tangents between all sites and sorts them.
    pub fn new(space: &FreeSpace, radius: f64, sites: Vec<Site>) -> Result<Self, GraphError> {
        let mut vertices = Vec::new();
        for (i, a) in sites.iter().enumerate() {
            for (j, b) in sites.iter().enumerate().skip(i + 1) {
                let offset = b.center - a.center;
                // A tangent is as far from the other centre as its circle is large.
                let reach = b.radius + 1e-9;
                let (high, low) = a.span_along(offset);
                if high < a.radius - reach || low > a.radius + reach {
                    continue;
                }
                for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                    let sites = [(i as u32, a, s), (j as u32, b, t)];
                    connect(space, radius, sites, &mut vertices);
                }
            }
            if vertices.len() > MAX_TANGENTS {
                return Err(GraphError::TooManyTangents);
            }
        }
        let mut graph = Self {
            sites,
            vertices,
            first: Vec::new(),
            landing: Vec::new(),
            landing_first: Vec::new(),
        };
        graph.order();
        graph.link();
        Ok(graph)
    }

    /// Sorts the vertices and drops those that lead over shorter ones.
    fn order(&mut self) {
        self.vertices.sort_by(|a, b| {
            a.track
                .cmp(&b.track)
                .then(a.at.total_cmp(&b.at))
                .then(a.length.total_cmp(&b.length))
        });
        let mut kept: Vec<Vertex> = Vec::with_capacity(self.vertices.len());
        for vertex in self.vertices.drain(..) {
            match kept.last_mut() {
                Some(last) if last.track == vertex.track && vertex.at - last.at < SAME_PLACE => {
                    if vertex.length < last.length {
                        *last = vertex;
                    }
                }
                _ => kept.push(vertex),
            }
        }
        self.vertices = kept;
        let tracks = 2 * self.sites.len() as u32;
        self.first = (0..=tracks)
            .map(|track| self.vertices.partition_point(|v| v.track < track) as u32)
            .collect();
    }

    /// Finds the successors of every vertex.
    fn link(&mut self) {
        let onward: Vec<[(u32, f64); 2]> = (0..self.vertices.len())
            .map(|i| {
                let v = &self.vertices[i];
                let stay = self.after(i as u32);
                let (next, arc) = self.departure(v.to_track, v.to_at);
                [(next, v.length + arc), stay]
            })
            .collect();
        let mut counts = vec![0u32; self.vertices.len() + 1];
        for (vertex, [(next, next_cost), (stay, stay_cost)]) in self.vertices.iter_mut().zip(onward)
        {
            (vertex.next, vertex.next_cost) = (next, next_cost);
            (vertex.stay, vertex.stay_cost) = (stay, stay_cost);
            if let Some(count) = counts.get_mut(next as usize + 1) {
                *count += 1;
            }
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut place = counts.clone();
        self.landing = vec![0; counts.last().map_or(0, |&n| n as usize)];
        for (i, vertex) in self.vertices.iter().enumerate() {
            if let Some(at) = place.get_mut(vertex.next as usize)
                && vertex.next != NONE
            {
                self.landing[*at as usize] = i as u32;
                *at += 1;
            }
        }
        self.landing_first = counts;
    }

    /// Number of tracks.
    pub fn tracks(&self) -> usize {
        2 * self.sites.len()
    }

    /// The site of a track.
    #[inline]
    pub fn site(&self, track: u32) -> &Site {
        &self.sites[(track / 2) as usize]
    }

    /// The position on a track of a counter-clockwise angle from the site's start.
    #[inline]
    pub fn place(&self, track: u32, angle: f64) -> f64 {
        place(self.site(track), turn(track), angle)
    }

    /// The same position on the site's other track.
    #[inline]
    pub fn opposite(&self, track: u32, at: f64) -> f64 {
        place(self.site(track), -1.0, at)
    }

    /// The first departure of a track at or after a position, and the arc to it (m).
    #[inline]
    pub fn departure(&self, track: u32, at: f64) -> (u32, f64) {
        let (begin, end) = (self.first[track as usize], self.first[track as usize + 1]);
        let vertices = &self.vertices[begin as usize..end as usize];
        let next = vertices.partition_point(|v| v.at < at - BACK);
        let site = self.site(track);
        if let Some(last) = vertices.last()
            && site.full
            && last.at > TAU + at - BACK
        {
            // The same position, on the other side of the zero of angles.
            return (end - 1, 0.0);
        }
        match (vertices.get(next), vertices.first()) {
            (Some(v), _) => (begin + next as u32, site.radius * (v.at - at).max(0.0)),
            // Once around.
            (None, Some(v)) if site.full => (begin, site.radius * (v.at + TAU - at)),
            _ => (NONE, 0.0),
        }
    }

    /// The departure after a vertex on its track, and the arc to it (m).
    fn after(&self, vertex: u32) -> (u32, f64) {
        let v = &self.vertices[vertex as usize];
        let (begin, end) = (
            self.first[v.track as usize],
            self.first[v.track as usize + 1],
        );
        let site = self.site(v.track);
        if vertex + 1 < end {
            let next = &self.vertices[vertex as usize + 1];
            (vertex + 1, site.radius * (next.at - v.at))
        } else if site.full && begin != vertex {
            let next = &self.vertices[begin as usize];
            (begin, site.radius * (next.at + TAU - v.at))
        } else {
            (NONE, 0.0)
        }
    }

    /// Angle (rad) of the arc on a track from one position to another; `None` if the other lies
    /// behind.
    #[inline]
    pub fn arc(&self, track: u32, from: f64, to: f64) -> Option<f64> {
        let full = self.site(track).full;
        if full && to - from > TAU - BACK {
            Some(0.0)
        } else if to >= from - BACK {
            Some((to - from).max(0.0))
        } else {
            full.then_some(to + TAU - from)
        }
    }

    /// The vertices from which one step leads to a vertex, with its cost (m).
    pub fn before(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> {
        let i = vertex as usize;
        let range = self.landing_first[i] as usize..self.landing_first[i + 1] as usize;
        let landing = self.landing[range].iter();
        let v = &self.vertices[i];
        let (begin, end) = (
            self.first[v.track as usize],
            self.first[v.track as usize + 1],
        );
        let previous = if vertex > begin { vertex - 1 } else { end - 1 };
        let staying = &self.vertices[previous as usize];
        let staying = (staying.stay == vertex).then_some((previous, staying.stay_cost));
        landing
            .map(move |&l| (l, self.vertices[l as usize].next_cost))
            .chain(staying)
    }
}

fn place(site: &Site, turn: Turn, angle: f64) -> f64 {
    if turn > 0.0 {
        angle
    } else if site.full && angle == 0.0 {
        0.0
    } else {
        // Its own inverse, so that it also leads from one track to the other.
        site.width - angle
    }
}

/// Adds the tangent from one site to another in the given turns, and its reverse, if it is free.
fn connect(
    space: &FreeSpace,
    radius: f64,
    [(i, a, s), (j, b, t)]: [(u32, &Site, Turn); 2],
    vertices: &mut Vec<Vertex>,
) {
    let offset = b.center - a.center;
    let Some(tangent) = tangent::between(offset, (a.radius, s), (b.radius, t)) else {
        return;
    };
    let (Some(from), Some(to)) = (a.angle_of(tangent.from), b.angle_of(tangent.to)) else {
        return;
    };
    let p = a.center + tangent.from * a.radius;
    let q = b.center + tangent.to * b.radius;
    if !space.segment_is_free(p, q, radius) {
        return;
    }
    let mut add = |one: (u32, &Site, Turn, f64), other: (u32, &Site, Turn, f64), ends| {
        vertices.push(Vertex {
            track: track(one.0, one.2),
            at: place(one.1, one.2, one.3),
            length: tangent.length,
            to_track: track(other.0, other.2),
            to_at: place(other.1, other.2, other.3),
            ends,
            next: NONE,
            next_cost: 0.0,
            stay: NONE,
            stay_cost: 0.0,
        });
    };
    add((i, a, s, from), (j, b, t, to), [p, q]);
    add((j, b, -t, to), (i, a, -s, from), [q, p]);
}
