//! The page as a whole.

use super::evidence::{ALPHA, COVERAGE, Evidence, SQUARE, Study};
use super::{alpha, coverage, sequences, square};
use crate::chase_page::{Image, MARK, Page};

/// What stands where there are no results.
const NOTHING: &str = "*No results of this experiment.*\n\n";

/// Writes the page.
pub fn page(evidence: &Evidence) -> Page {
    let mut text = format!("{MARK}\n\n{HEAD}\n{ALPHA_HEAD}");
    let mut images = Vec::new();
    match &evidence.alpha {
        None => text += NOTHING,
        Some(study) => {
            text += "![Speed needed by α](images/patrol-speed.svg)\n\n";
            text += "![MAE by α](images/patrol-mae.svg)\n\n";
            text += &alpha::text(study);
            images.push(Image {
                name: "patrol-speed",
                chart: alpha::speed_chart(study),
            });
            images.push(Image {
                name: "patrol-mae",
                chart: alpha::mae_chart(study),
            });
        }
    }
    text += SQUARE_HEAD;
    text += &evidence
        .square
        .as_ref()
        .map_or_else(|| NOTHING.to_owned(), square::text);
    text += SEQUENCES_HEAD;
    text += &sequences::text();
    text += COVERAGE_HEAD;
    match &evidence.coverage {
        None => text += NOTHING,
        Some(study) => {
            text += "![Covered part by way driven](images/coverage-by-way.svg)\n\n";
            text += &coverage::text(study);
            images.push(Image {
                name: "coverage-by-way",
                chart: coverage::chart(study),
            });
        }
    }
    text += &reproduction(evidence);
    Page { text, images }
}

const HEAD: &str = "\
# Patrols and coverage, beside the published results

Robots driven by real planners in the simulated world, a mission per seed; ± is half of Student's 95 % interval of
the mean. The keys come from the seeds. What the formulas give without a robot is in the tests of the crates `patrol`,
`coverage`, `generators` and `metrics`.
";

const ALPHA_HEAD: &str = "\
## Width of the zig-zag (cat-map patrol paper, Fig. 6 and 10)

An octagon of 48.3 m, to be walked in 120 s. *Speed needed* is the length of a lap through all its waypoints in that
time: for a robot that turns in no time. *MAE* is the mean distance from where a robot would be that keeps to the
octagon; *driven* takes the places where the robot was instead of the waypoints. The paper names its MAA of 0.7815 rad
a mean absolute angle; it is the mean of angles folded to acute ones, about π/4 for any path without a preferred
turn. The paper's ANDC of 0.4024 changes of direction per second is its speed in m/s, copied: a lap has 120 of them, one
per second. `paper_fit` rounds the number of waypoints and measures headings as the paper's numbers suggest; `default`
puts every waypoint ahead of the robot's nominal place, whichever way the contour runs.

";

const SQUARE_HEAD: &str = "\
## Among obstacles (cat-map patrol paper, case 2, Fig. 12)

`awg` is the zig-zag, `fto` avoids fictive obstacles on its way along the contour (a reconstruction: the method's
own paper was not available), `mixed` is the first where obstacles are small and the second along large ones, as the
paper suggests. *Turns* are corners of the driven way, smoothed by 0.1 m. The paper's values for `fto` do not fit each
other: 0.4024 turns per second of 0.3681 rad each are barely a round of the square.

";

const SEQUENCES_HEAD: &str = "\
## Mean difference of two chaotic sequences (Chebyshev coverage paper, Table 1)

For independent coordinates v(xy) depends on their distribution only, and comes to the limit with growing n. That a
smaller value means better randomness, and that it falls with n, is not so. In floating point the maps part from the
exact ones after some twenty steps, and every library has its own last digits.

";

const COVERAGE_HEAD: &str = "\
## Ways to choose sub-goals

The empty workplace of 10 m by 10 m, a robot of radius 0.1 m. *Covered* is what the robot's disc has swept of the area
that it can reach; *unevenness* is the standard deviation of a cell's visits, divided by their mean. The *best
observer* is the one of the methods of `observer` with the least mean error in that mission: the larger its error,
the harder the robot is to foretell.

";

fn reproduction(evidence: &Evidence) -> String {
    let mut text = "## How to make this page\n\n```sh\n".to_owned();
    for name in [ALPHA, SQUARE, COVERAGE] {
        text += &format!("protean sweep experiments/{name}.toml --in-process\n");
    }
    text +=
        &format!("protean sweep page results/{ALPHA} results/{SQUARE} results/{COVERAGE}\n```\n\n");
    let studies: [(&str, &Option<Study>); 3] = [
        (ALPHA, &evidence.alpha),
        (SQUARE, &evidence.square),
        (COVERAGE, &evidence.coverage),
    ];
    for (name, study) in studies {
        if let Some(study) = study {
            text += &format!(
                "- `{name}`: seeds {}, Protean {}\n",
                study.seeds, study.program
            );
        }
    }
    text
}
