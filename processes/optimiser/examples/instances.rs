use nalgebra::Point2;
use optimiser::{Method, Options, Problem, RobotLimits};
use sim_backend::pose::Pose2;
use sim_backend::shape::{Aabb, Convex};

fn cpu() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

fn main() {
    let method = std::env::args().nth(1).unwrap();
    let dir = std::env::args().nth(2).unwrap();
    let reference: Option<serde_json::Value> = std::env::var("REFERENCE")
        .ok()
        .map(|p| serde_json::from_str(&std::fs::read_to_string(p).unwrap()).unwrap());
    let only = std::env::var("ONLY").ok();
    for row in std::env::args().skip(3) {
        let text = std::fs::read_to_string(format!("{dir}/{row}.json")).unwrap();
        let all: serde_json::Value = serde_json::from_str(&text).unwrap();
        let options = Options {
            method: Method::by_name(&method).unwrap(),
            guess: if std::env::var_os("WAVE").is_some() {
                optimiser::options::Guess::Wavefront
            } else {
                Default::default()
            },
            ..Options::default()
        };
        let (mut times, mut gaps, mut fallback, mut failed, mut progs) =
            (vec![], vec![], 0, 0, vec![]);
        let mut worst = (0.0, String::new());
        for i in all.as_array().unwrap() {
            if only.as_deref().is_some_and(|o| i["id"].as_str() != Some(o)) {
                continue;
            }
            let k = i["cm_per_px"].as_f64().unwrap() / 100.0;
            let f = |v: &serde_json::Value| v.as_f64().unwrap() * k;
            let b = &i["bounds_px"];
            let problem = Problem {
                start: Pose2::new(
                    f(&i["start"]["x"]),
                    f(&i["start"]["y"]),
                    i["start"]["theta"].as_f64().unwrap(),
                ),
                start_speed: i["start_speed"].as_f64().map(|v| v * k),
                start_turn_rate: i["start_turn_rate"].as_f64(),
                goal: Point2::new(f(&i["goal"]["x"]), f(&i["goal"]["y"])),
                goal_heading: i["goal"]["theta"].as_f64(),
                goal_speed: i["goal_speed"].as_f64().map(|v| v * k),
                limits: RobotLimits {
                    wheels: i["wheel_speed_px_s"].as_f64().map(|v| optimiser::Wheels {
                        speed: v * k,
                        separation: f(&i["wheel_separation_px"]),
                    }),
                    acceleration: i["acceleration_px_s2"].as_f64().map(|v| v * k),
                    angular_acceleration: i["angular_acceleration_rad_s2"].as_f64(),
                    ..RobotLimits::simple(f(&i["vmax_px_s"]), i["wmax_rad_s"].as_f64().unwrap())
                },
                obstacles: i["obstacles"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|o| Convex::disc(Point2::new(f(&o["x"]), f(&o["y"])), f(&o["r"])))
                    .collect(),
                clearance: f(&i["buffer_px"]),
                bounds: Aabb {
                    min: Point2::new(f(&b[0]), f(&b[1])),
                    max: Point2::new(f(&b[2]), f(&b[3])),
                },
                start_tolerance: 5e-3,
            };
            let mut best = f64::INFINITY;
            let mut plan = None;
            for _ in 0..2 {
                let t0 = cpu();
                plan = Some(optimiser::plan(&problem, &options, None, &mut || false));
                best = best.min((cpu() - t0) * 1e3);
            }
            match plan.unwrap() {
                Ok(p) => {
                    let gap = reference
                        .as_ref()
                        .and_then(|r| r[i["id"].as_str().unwrap()]["t_s"].as_f64())
                        .or(i["reference"]["t_lb_s"].as_f64())
                        .map_or(p.gap(), |lb| p.final_time / lb - 1.0);
                    gaps.push(gap);
                    times.push(best);
                    progs.push(f64::from(p.iterations));
                    if p.status != optimiser::Status::Planned {
                        fallback += 1;
                        println!("   {} {:?}", i["id"], p.status);
                    }
                    if gap > worst.0 {
                        worst = (gap, i["id"].to_string());
                    }
                    if only.is_some() || std::env::var_os("ALL").is_some() {
                        println!(
                            "{} T {} gap {:.5}% cp {} programs {} clear {}",
                            i["id"],
                            p.final_time,
                            100.0 * gap,
                            p.control_points,
                            p.iterations,
                            p.min_clearance
                        );
                    }
                }
                Err(e) => {
                    failed += 1;
                    if i["reference"]["feasible"].as_bool() == Some(true)
                        || e != optimiser::PlanError::NoPath
                    {
                        println!("   {} {e}", i["id"]);
                    }
                }
            }
        }
        for v in [&mut times, &mut gaps, &mut progs] {
            v.sort_by(f64::total_cmp);
        }
        let q = |v: &[f64], p: f64| {
            v.get((((v.len() as f64) * p) as usize).min(v.len().saturating_sub(1)))
                .copied()
                .unwrap_or(f64::NAN)
        };
        println!(
            "{row:12} {method:8} n {} fallback {fallback} failed {failed} ms {:.2}/{:.2}/{:.2} gap% {:.4}/{:.4}/{:.4} programs {}/{} worst {}",
            gaps.len(),
            q(&times, 0.5),
            q(&times, 0.95),
            q(&times, 0.99),
            100.0 * q(&gaps, 0.5),
            100.0 * q(&gaps, 0.95),
            100.0 * q(&gaps, 1.0),
            q(&progs, 0.5),
            q(&progs, 1.0),
            worst.1
        );
    }
}
