//! The division of random maps.

use coverage::decomposition::Decomposition;

use crate::random_map::{RandomMaps, free_components};

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
