use geometry::grid::Grid;

use super::*;

/// An 8 m × 6 m room with a 2 m × 2 m block in the middle and an exit on the right.
pub(crate) fn room() -> BlurredMap {
    let frame = GridFrame {
        width: 160,
        height: 120,
        resolution: 0.05,
        origin: Point2::new(-4.0, -3.0),
    };
    let mut free = Grid::filled(frame, true);
    for row in 0..frame.height {
        for col in 0..frame.width {
            let p = frame.center(col, row);
            let block = p.x.abs() < 1.0 && p.y.abs() < 1.0;
            let exit = p.x > 0.0 && p.y.abs() < 0.75;
            let wall = p.x.abs() > 3.8 || p.y.abs() > 2.8;
            free.cells[frame.index(col, row)] = !(block || (wall && !exit));
        }
    }
    BlurredMap::new(&free, 0.15).unwrap()
}

#[test]
fn the_table_agrees_with_the_grid_everywhere() {
    let map = room();
    let space = Space::new(&map);
    let mut place = [0];
    for i in -20..200 {
        for j in -20..160 {
            let p = Point2::new(-4.0 + 0.0493 * f64::from(i), -3.0 + 0.0477 * f64::from(j));
            space.locate(&[p.x as f32], &[p.y as f32], &mut place);
            assert_eq!(space.valid_at(place[0]) == 1, !map.is_blocked(p), "{p}");
            assert_eq!(space.is_valid(p), !map.is_blocked(p), "{p}");
        }
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
        space.locate(&[bad], &[0.0], &mut place);
        assert_eq!(space.valid_at(place[0]), 0, "{bad}");
        space.locate(&[2.0], &[bad], &mut place);
        assert_eq!(space.valid_at(place[0]), 0, "{bad}");
    }
}

#[test]
fn the_exit_is_valid_space() {
    assert!(Space::new(&room()).is_valid(Point2::new(3.95, 0.3)));
}

#[test]
fn free_cells_are_listed_once_each() {
    let map = room();
    let space = Space::new(&map);
    let free = map.occupied().cells.iter().filter(|&&o| !o).count();
    assert_eq!(space.free_cells().len(), free);
    for &cell in space.free_cells() {
        assert!(space.is_valid(space.point_in(cell, 0.5, 0.5)));
    }
}
