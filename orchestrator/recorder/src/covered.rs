//! Coverage of a run.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::world::CoverageState;
use ipc_types::topics::{Coverage, TopicId};

use super::summary::{CoverageByWay, CoverageOutcome, OutcomePart, Summary};

/// Path lengths at which coverage is recorded (m).
const PATH_LENGTHS: [f64; 4] = [250.0, 500.0, 1000.0, 2000.0];

/// Last reported coverage.
#[derive(Debug, Default)]
pub(super) struct LatestCoverage(Option<CoverageOutcome>);

impl Consumer for LatestCoverage {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Coverage]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((_, reports)) = message.view::<Coverage>() {
            reports.for_each(|report| self.add(&report));
        }
    }
}

impl OutcomePart for LatestCoverage {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        summary.coverage = self.0;
    }
}

impl LatestCoverage {
    fn add(&mut self, report: &CoverageState) {
        let before = self.0.take();
        let (mut by_way, from) = match before {
            Some(before) => (before.by_way, (before.way_m, before.coverable_fraction)),
            None => (Vec::new(), (0.0, 0.0)),
        };
        for way_m in PATH_LENGTHS {
            if from.0 < way_m && way_m <= report.way {
                let part = (way_m - from.0) / (report.way - from.0);
                let coverable_fraction = from.1 + part * (report.coverable_fraction - from.1);
                by_way.push(CoverageByWay {
                    way_m,
                    coverable_fraction,
                });
            }
        }
        self.0 = Some(CoverageOutcome {
            fraction: report.fraction,
            coverable_fraction: report.coverable_fraction,
            free_m2: f64::from(report.free) * report.cell_area,
            visited_m2: f64::from(report.visited) * report.cell_area,
            mean_idleness_s: report.mean_idleness,
            worst_idleness_s: report.worst_idleness,
            unevenness: report.unevenness,
            way_m: report.way,
            by_way,
        });
    }
}
