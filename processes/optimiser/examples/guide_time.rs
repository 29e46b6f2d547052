use guidance::free_space::FreeSpace;
use nalgebra::Point2;
use sim_backend::shape::{Aabb, Convex};
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let cells: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    let all: serde_json::Value = serde_json::from_str(&text).unwrap();
    let (mut ta, mut tb, mut tc) = (vec![], vec![], vec![]);
    let mut worst = 0f64;
    for _ in 0..2 {
        for i in all.as_array().unwrap() {
            let k = i["cm_per_px"].as_f64().unwrap() / 100.0;
            let f = |v: &serde_json::Value| v.as_f64().unwrap() * k;
            let parts: Vec<Convex> = i["obstacles"]
                .as_array()
                .unwrap()
                .iter()
                .map(|o| Convex::disc(Point2::new(f(&o["x"]), f(&o["y"])), f(&o["r"])))
                .collect();
            let c = f(&i["buffer_px"]);
            let b = &i["bounds_px"];
            let bounds = Aabb {
                min: Point2::new(f(&b[0]) - c, f(&b[1]) - c),
                max: Point2::new(f(&b[2]) + c, f(&b[3]) + c),
            };
            let t0 = std::time::Instant::now();
            let space =
                FreeSpace::new(parts, bounds, (bounds.max.x - bounds.min.x) / cells).unwrap();
            let t1 = std::time::Instant::now();
            let p = guidance::tangent_graph::shortest_once(
                &space,
                c,
                Point2::new(f(&i["start"]["x"]), f(&i["start"]["y"])),
                Point2::new(f(&i["goal"]["x"]), f(&i["goal"]["y"])),
            )
            .unwrap();
            let t2 = std::time::Instant::now();

            let t3 = std::time::Instant::now();
            ta.push((t1 - t0).as_secs_f64() * 1e3);
            tb.push((t2 - t1).as_secs_f64() * 1e3);
            tc.push((t3 - t2).as_secs_f64() * 1e3);
            let want = i["reference"]["shortest_px"].as_f64();
            match (p, want) {
                (Some(p), Some(w)) => {
                    let e = (p.length / k / w - 1.0).abs();
                    if e > 1e-7 {
                        println!("{} {} {}", i["id"], p.length / k, w);
                    }
                    worst = worst.max(e)
                }
                (None, None) => {}
                (p, w) => println!("{} {:?} {:?}", i["id"], p.map(|p| p.length / k), w),
            }
        }
    }
    for t in [&mut ta, &mut tb, &mut tc] {
        t.sort_by(f64::total_cmp);
        print!(
            "med {:.3} p99 {:.3}  ",
            t[t.len() / 2],
            t[t.len() * 99 / 100]
        );
    }
    println!("worst rel {worst:e}");
}
