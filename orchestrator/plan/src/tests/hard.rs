//! Hard instances.

use serde_json::Value as Json;

use crate::file::parse;

/// Instances that were planned by 0.6 to 75 % too slow, or at ten times the usual cost.
#[test]
fn hard_instances_are_planned_as_fast_as_known_and_at_a_limited_cost() {
    let read = |name: &str| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmarks/instances");
        std::fs::read_to_string(format!("{folder}/{name}")).unwrap()
    };
    let best: Vec<Json> = serde_json::from_str(&read("hard.reference.json")).unwrap();
    let instances = parse(read("hard.json").as_bytes()).unwrap();
    assert!(instances.len() > best.len());
    for element in instances {
        let instance = element.instance.unwrap();
        let known = best.iter().find(|entry| entry["id"] == *element.id);
        let (problem, options) = (instance.problem(), trajectory::Options::default());
        let plan = trajectory::plan(&problem, &options, None, &mut || false).unwrap();
        let report = trajectory_check::check(&instance.contract(), &plan.samples);
        assert!(report.is_valid(), "{}: {report}", element.id);
        assert!(plan.work < 1_350_000, "{}: {}", element.id, plan.work);
        if let Some(known) = known {
            let most = 1.003 * known["t_s"].as_f64().unwrap();
            assert!(
                plan.final_time < most,
                "{}: {}",
                element.id,
                plan.final_time
            );
            assert_ne!(plan.basis.name(), "curve", "{}", element.id);
        }
    }
}
