//! The page as a whole.

use super::evidence::{Evidence, SENSITIVITY, VERSUS};
use super::{sensitivity, versus};
use crate::chase_page::{Image, MARK, Page};

/// Writes the page.
pub fn page(evidence: &Evidence) -> Page {
    let mut text = format!("{MARK}\n\n{HEAD}\n{CONDITIONS}\n## Table 2: sensitivity\n\n");
    let mut images = Vec::new();
    match &evidence.sensitivity {
        None => text += "*No results of this experiment.*\n\n",
        Some(study) => {
            text += "![Failed plans by setting](images/vmc-lp-sensitivity.svg)\n\n";
            text += RULES;
            text += &sensitivity::text(study);
            images.push(Image {
                name: "vmc-lp-sensitivity",
                chart: sensitivity::chart(study),
            });
        }
    }
    text += "## Tables 3 and 4: local pursuit against motion camouflage\n\n";
    match &evidence.versus {
        None => text += "*No results of this experiment.*\n\n",
        Some(study) => {
            text += "![CPU time of VMC by that of LP](images/vmc-lp-cpu.svg)\n\n";
            text += VERSUS_RULES;
            text += &versus::text(study);
            images.push(Image {
                name: "vmc-lp-cpu",
                chart: versus::chart(study),
            });
        }
    }
    text += &reproduction(evidence);
    Page { text, images }
}

const HEAD: &str = "\
# Motion camouflage and local pursuit, beside the published results

Y. Xu's report plans minimum-time trajectories of a small robot among obstacles with two
methods: virtual motion camouflage (VMC) and local pursuit (LP). Here its Tables 2 to 4 are repeated with as many
and more random problems. Every plan is checked: within a millimetre of every obstacle's clearance, of the board,
of start and goal, and within a thousandth of the speed and the turning rate, everywhere along the path.
";

const CONDITIONS: &str = "\
The report leaves open what these comparisons need: what it counts as failed, how far the robot keeps from
obstacles (10 px here), how many obstacles there are and of which size where that is not varied (10 … 20 of
5 … 15 px here), how many centimetres a pixel is (0.75 here), and what the parameters are that are not varied (8
control points, degree 4, 15 nodes, reference point −(1800, 1800) px and 40 … 45° here: the better setting of each of
its rows). Its solver was `fmincon` in MATLAB, ours is a sequence of convex programs that starts from the exact
shortest path. So a contradiction below is one of the numbers, under these conditions; it does not show that the
report's own runs were otherwise than it says.
";

const RULES: &str = "\
*Failed* means here: the problem has a solution, and the method with exactly the stated parametrisation, without
anything to fall back on, finds no plan that passes the check. Problems without any path count apart. *Seen at the
nodes* is the report's way: obstacles constrain the curve at the N + 1 Legendre–Gauss–Lobatto nodes only, and what
lies between two of them goes unseen by the method, but not by the check. Intervals are Wilson's, 95 %. A count
*contradicts* if Fisher's exact test of ours against the published one, corrected by Holm's method over the rows of
the table, has p < 0.05. A change of a parameter *hardly matters* if the 95 % interval (Newcombe's) of the
difference lies within ±2 points; it is *confirmed* to matter if p < 0.05, corrected. All settings share their
seeds, and are treated as independent, which makes differences look less sure than they are.

";

const VERSUS_RULES: &str = "\
Both methods plan the same problems. Durations count as different if they differ by more than 0.01 %. Intervals are
Wilson's, 95 %. *Confirmed* and *contradicted* say that the interval of the share, over all three plannings, lies
above or below one half. CPU times are of the machine that made these results, and change from run to run; the
published ones are MATLAB's at 2 GHz. The report says that the largest difference of the times in Table 3 is 7 %; by its
own numbers it is 7.9 % (test 1), and 9.8 % in Table 4.

";

fn reproduction(evidence: &Evidence) -> String {
    let mut text = "## How to make this page\n\n```sh\n".to_owned();
    for name in [SENSITIVITY, VERSUS] {
        text += &format!("protean sweep experiments/{name}.toml\n");
    }
    text += &format!(
        "protean sweep page results/{SENSITIVITY} results/{VERSUS} --out docs/vmc-lp-results.md\n```\n\n"
    );
    let studies = [
        (SENSITIVITY, &evidence.sensitivity),
        (VERSUS, &evidence.versus),
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
