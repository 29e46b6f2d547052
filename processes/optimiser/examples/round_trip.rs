//! Cost of a request to the optimiser process beyond planning: time from sending a request to
//! receiving the answer, beside the library's own time for the same problem.
//!
//! `cargo run --release -p optimiser --example round_trip [METHOD] [REQUESTS]`

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::error::Error;
use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, BusOptions, RunSpace};
use ipc_types::messages::optimiser::PlanRequest;
use ipc_types::messages::world::ShapePoint;
use ipc_types::topics::{OptimiserPlan, RunSize};
use optimiser::service::{Dispatcher, DispatcherInput};
use optimiser::wire::decode_request;
use runtime::service_client::ServiceClient;
use trajectory::Method;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or_else(|| "lp".to_owned());
    let method = Method::by_name(&name).ok_or("METHOD is bspline, lp, vmc or tangent")?;
    let count: usize = words.next().map_or(Ok(200), |n| n.parse())?;
    let (header, points) = popup(method);

    let directory = std::env::temp_dir().join(format!("round_trip_{}", std::process::id()));
    let prefix = format!("round_trip_{}_", std::process::id());
    let space = RunSpace::new(&directory, prefix)?;
    space.create_root()?;
    let measured = measure(&space, &header, &points, count);
    space.wipe()?;
    let [alone, asked, solve] = measured?;

    println!("{name}, median of {count}:");
    println!("library       {:8.1} us", micros(alone));
    println!("in the answer {:8.1} us", micros(solve));
    println!(
        "asked         {:8.1} us, {:.2} times the library, {:+.1} us",
        micros(asked),
        asked.as_secs_f64() / alone.as_secs_f64(),
        micros(asked) - micros(alone)
    );
    Ok(())
}

/// Medians: of the library alone, from the request to the answer, and of the time in the answer.
fn measure(
    space: &RunSpace,
    header: &PlanRequest,
    points: &[ShapePoint],
    count: usize,
) -> Result<[Duration; 3], Box<dyn Error>> {
    let options = BusOptions {
        size: RunSize {
            robots: 1,
            processes: 2,
            events: 0,
        },
        recorder_ticks: 8,
        overflow: false,
    };
    let bus = Bus::join(space, options, "round_trip")?;
    let _held = bus.create_service::<OptimiserPlan>()?;
    let _dispatcher = Dispatcher::start(DispatcherInput {
        space: space.clone(),
        options,
        name: "optimiser".to_owned(),
        source: 1,
        workers: 2,
    })?;
    let mut client = ServiceClient::<OptimiserPlan>::open(&bus, 2, PlanRequest::MAX_POINTS)?;
    let (problem, how) = decode_request(header, points)?;
    let (mut alone, mut asked, mut solve) = (Vec::new(), Vec::new(), Vec::new());
    // Alternately, so that other load on the machine affects both; the first few rounds are a
    // warm-up.
    for round in 0..count + 10 {
        let start = Instant::now();
        trajectory::plan(&problem, &how, None, &mut || false)?;
        let by_itself = start.elapsed();
        let start = Instant::now();
        client.ask(*header, points)?;
        let answer = client.wait()?;
        let by_asking = start.elapsed();
        let (header, _) = answer.ok_or("no answer")?;
        if round >= 10 {
            alone.push(by_itself);
            asked.push(by_asking);
            solve.push(Duration::from_nanos(header.solve_ns));
        }
    }
    Ok([median(alone), median(asked), median(solve)])
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    let at = |place: usize| times.get(place).copied().unwrap_or_default();
    (at(times.len().saturating_sub(1) / 2) + at(times.len() / 2)) / 2
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// The replanning of the scenario `popup`: five discs, a third of the way behind.
fn popup(method: Method) -> (PlanRequest, Vec<ShapePoint>) {
    let discs = [
        [1.5, 0.9, 0.3],
        [2.3, 2.4, 0.35],
        [3.6, 1.9, 0.3],
        [2.75, 1.6, 0.25],
        [3.6, 2.75, 0.2],
    ];
    let points = (0u32..)
        .zip(discs)
        .map(|(shape, [x, y, radius])| ShapePoint {
            x,
            y,
            radius,
            shape,
            reserved: 0,
        });
    let header = PlanRequest {
        start_x: 1.75,
        start_y: 1.45,
        start_theta: 0.7,
        start_v: f64::NAN,
        start_omega: f64::NAN,
        goal_x: 4.35,
        goal_y: 3.15,
        goal_theta: f64::NAN,
        goal_v: f64::NAN,
        v_max: 0.15,
        omega_max: 16.0,
        acceleration_max: f64::INFINITY,
        angular_acceleration_max: f64::INFINITY,
        wheel_speed_max: f64::INFINITY,
        wheel_separation: 0.112,
        clearance: 0.11,
        start_tolerance: f64::NAN,
        bounds: [0.11, 0.11, 4.69, 3.49],
        reference_x: f64::NAN,
        reference_y: f64::NAN,
        method: method.code(),
        shapes: discs.len() as u32,
        ..PlanRequest::default()
    };
    (header, points.collect())
}
