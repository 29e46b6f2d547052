//! The division of random maps.

use coverage::decomposition::{Decomposition, Place};
use coverage::space::Space;
use geometry::shape::Aabb;

use crate::random_map::{RandomMaps, free_components};

fn area(rectangles: &[Aabb]) -> f64 {
    let areas = rectangles.iter().map(|r| (r.max - r.min).product());
    areas.sum()
}

fn overlap(a: &Aabb, b: &Aabb) -> f64 {
    let shared = a.max.inf(&b.max) - a.min.sup(&b.min);
    shared.x.max(0.0) * shared.y.max(0.0)
}

#[test]
fn the_parts_of_a_team_have_equal_areas_and_make_up_all_that_it_can_reach() {
    let mut maps = RandomMaps::new(8);
    let (mut teams, mut apart) = (0, 0);
    for (round, count) in [0, 2, 5, 12].repeat(40).into_iter().enumerate() {
        let workplace = maps.next_map(count);
        let Ok(whole) = Decomposition::new(&workplace) else {
            continue;
        };
        let mut place = |_| {
            let [start, here] =
                [0, 1].map(|_| workplace.inner().min.map(|low| low + 9.8 * maps.unit()));
            Place { start, here }
        };
        let team: Vec<Place> = (0..2 + round % 5).map(&mut place).collect();
        let home = |place: &Place| {
            let (nearest, _) = whole.nearest_rectangle(place.here).unwrap();
            whole.component_of(nearest).unwrap()
        };
        for component in 0..whole.components() {
            let members: Vec<usize> = (0..team.len())
                .filter(|&robot| home(&team[robot]) == component)
                .collect();
            let divided = members.iter().map(|&robot| {
                let whole = whole.clone();
                let (division, part) = whole.divided(&workplace, &team, robot).unwrap();
                let space = Space::new(&workplace, &division, team[robot].here);
                let rectangles: Vec<Aabb> = space.rectangles().copied().collect();
                (part, rectangles)
            });
            let mut parts: Vec<(usize, Vec<Aabb>)> = divided.collect();
            parts.sort_by_key(|&(part, _)| part);
            let all: Vec<Aabb> = whole
                .component(component)
                .map(|r| whole.rectangles()[r])
                .collect();
            for (number, (part, rectangles)) in parts.iter().enumerate() {
                assert_eq!(*part, number);
                let share = area(&all) / members.len() as f64;
                assert!((area(rectangles) - share).abs() < 1e-6 * share, "{share}");
                // In free space, of which the areas are those of the whole.
                let inside: f64 = rectangles
                    .iter()
                    .flat_map(|r| all.iter().map(|other| overlap(r, other)))
                    .sum();
                assert!((inside - share).abs() < 1e-6 * share);
                for (_, others) in &parts[number + 1..] {
                    let pairs = rectangles
                        .iter()
                        .flat_map(|r| others.iter().map(move |o| (r, o)));
                    let shared: f64 = pairs.map(|(r, other)| overlap(r, other)).sum();
                    assert!(shared < 1e-6, "{shared} m²");
                }
            }
            teams += usize::from(parts.len() > 1);
            apart += usize::from(parts.len() == 1 && team.len() > 1);
        }
    }
    assert!(teams > 100 && apart > 0, "{teams} teams, {apart} alone");
}

#[test]
fn the_parts_follow_the_order_of_the_starts() {
    let workplace = RandomMaps::new(1).next_map(0);
    let whole = Decomposition::new(&workplace).unwrap();
    let bounds = |starts: [f64; 3], own: usize| {
        let team = starts.map(|x| {
            let start = nalgebra::Point2::new(x, 5.0);
            Place { start, here: start }
        });
        let (division, _) = whole.clone().divided(&workplace, &team, own).unwrap();
        *Space::new(&workplace, &division, team[own].here).bounds()
    };
    for (own, strip) in [(0, 1), (1, 2), (2, 0)] {
        let part = bounds([5.0, 5.0, 0.5], own);
        let from = 0.1 + 9.8 / 3.0 * f64::from(strip);
        assert!((part.min.x - from).abs() < 1e-9, "{part:?}");
        assert!((part.max.x - from - 9.8 / 3.0).abs() < 1e-9, "{part:?}");
        assert_eq!((part.min.y, part.max.y), (0.1, 9.9));
    }
}

#[test]
fn random_maps_are_divided_exactly_and_into_the_components_of_their_free_cells() {
    let mut maps = RandomMaps::new(7);
    for count in [1, 2, 3, 5, 8, 12].repeat(40) {
        let workplace = maps.next_map(count);
        let Ok(decomposition) = Decomposition::new(&workplace) else {
            continue;
        };
        let (area, components) = free_components(&workplace);
        assert!((decomposition.area() - area).abs() < 1e-9 * area);
        assert_eq!(decomposition.components(), components);
        let rectangles = decomposition.rectangles();
        for (i, a) in rectangles.iter().enumerate() {
            for b in rectangles.iter().skip(i + 1) {
                let shared = (a.max.x.min(b.max.x) - a.min.x.max(b.min.x))
                    .min(a.max.y.min(b.max.y) - a.min.y.max(b.min.y));
                assert!(shared < 1e-9, "{a:?} overlaps {b:?}");
            }
        }
        for bridge in decomposition.bridges() {
            let r = &bridge.rectangle;
            for o in workplace.inflated() {
                let depth = (r.max.x.min(o.max.x) - r.min.x.max(o.min.x))
                    .min(r.max.y.min(o.max.y) - r.min.y.max(o.min.y));
                assert!(depth < 1e-9, "bridge {r:?} meets {o:?}");
            }
        }
    }
}
