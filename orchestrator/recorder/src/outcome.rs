//! Parts of the summary of a run.

use ipc_types::consumer::Consumers;

use super::attacked::Attacked;
use super::covered::LatestCoverage;
use super::event_list::EventList;
use super::link_counts::LinkCounts;
use super::outages::Outages;
use super::patrolled::{PatrolMeasurement, Patrolled};
use super::predicted::PredictionSeries;
use super::robots::Robots;
use super::run_info::RunInfo;
use super::summary::OutcomePart;
use super::verdicts::VerdictTotals;
use super::visits::AllVisits;

/// Creates the parts of the summary of a run.
pub(super) fn parts(run: &RunInfo) -> Consumers<dyn OutcomePart> {
    let RunInfo {
        processes,
        robots,
        tick_period_ns,
        ..
    } = run;
    Consumers::new(vec![
        // First, because the other parts complete the entries that it creates.
        Box::new(Robots::new(robots, *tick_period_ns)),
        Box::new(EventList::new(run)),
        Box::new(LatestCoverage::default()),
        Box::new(VerdictTotals::new(robots.len())),
        Box::new(AllVisits::new(robots)),
        Box::new(Patrolled(PatrolMeasurement::of_all(&run.patrols, robots))),
        Box::new(Attacked::new(run)),
        Box::new(PredictionSeries::default()),
        Box::new(LinkCounts::new(&run.links, run.seed)),
        Box::new(Outages::new(processes, *tick_period_ns)),
    ])
}
