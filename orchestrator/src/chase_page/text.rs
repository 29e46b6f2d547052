//! The page as a whole.

use super::claims::{Claim, Finding, Verdict, claims};
use super::evidence::{Evidence, Study};
use super::published::{self, Published};
use super::words::in_table;
use super::{critical, curves, table};
use crate::figures::Chart;

/// The first line of every page: what begins with it may be overwritten.
pub const MARK: &str =
    "<!-- Written by `protean sweep page` from results; what is edited here is lost. -->";

/// A page and its pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// The page, as Markdown.
    pub text: String,
    /// Its pictures, in the folder `images` beside it.
    pub images: Vec<Image>,
}

/// A picture of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Name of its file, without what says its kind.
    pub name: &'static str,
    /// What it shows.
    pub chart: Chart,
}

/// A part of the page: one experiment.
struct Part<'a> {
    study: &'a Option<Study>,
    published: &'a [Published],
    heading: &'static str,
    introduction: &'static str,
    title: &'static str,
    conditions: &'static str,
    image: &'static str,
    experiment: &'static str,
}

/// Writes the page.
pub fn page(evidence: &Evidence) -> Page {
    let claims = claims(evidence);
    let parts = parts(evidence);
    let mut text = format!("{MARK}\n\n{HEAD}\n{}\n{INTERVALS}\n", overview(&claims));
    let mut images = Vec::new();
    for part in &parts {
        text += &part.text();
        if let Some(study) = part.study {
            let chart = curves::chart(study, part.published, part.title, part.conditions);
            images.push(Image {
                name: part.image,
                chart,
            });
        }
    }
    text += CLAIMS_HEAD;
    for claim in &claims {
        text += &one_by_one(claim);
    }
    text += &reproduction(&parts);
    Page { text, images }
}

const HEAD: &str = "\
# The chase's results, beside the published ones

Two evaders run for the exit of a city, four Police try to catch them. I. M. Gomes Ribeiro, J. Fiala and
R. Shah (*Multi-robot Navigation in the Context of a Chasing Game*) compared ways to evade and what the
Police know; here their experiments are repeated with many more games, once with our planners and once
with the paper's parameters (`preset = \"paper\"`, see [deviations.md](deviations.md)). The paper gives no
numbers of games; its values are multiples of 0.1 and are taken as so many of ten. The error bars of its
figures are a tenth of each bar and no measure of chance.
";

const INTERVALS: &str = "\
**Chance** is the share of evaders that escape. *Wilson* is the 95 % interval as if all evaders were
independent. They are not: who hunts one lets the other go. *By game* is the interval that counts by the
spread between games (design effect, then Wilson's formula; a game counts as one outcome where all evaders
fared alike); all tests count outcomes in this way. *In our interval* says whether the published value lies
in the interval by game, *alike?* is Fisher's exact test of our chance against the published ten games.
p-values of several comparisons are corrected by Holm's method, their intervals by Bonferroni's; decisions
are at 5 %. Games of different cells share their seeds and are treated as independent, which makes
differences look less sure than they are.
";

const CLAIMS_HEAD: &str = "## The claims one by one\n\n";

fn parts(evidence: &Evidence) -> [Part<'_>; 4] {
    [
        Part {
            study: &evidence.speed,
            published: &published::SPEED,
            heading: "Escape against speed (Fig. 2), our planners",
            introduction: "Police that know where everybody is, evaders that steer in different ways.",
            title: "Chance of escape against speed",
            conditions: "Police 0.3 m/s with exact knowledge, our planners.",
            image: "chase-escape-vs-speed",
            experiment: "escape_vs_speed",
        },
        Part {
            study: &evidence.speed_paper,
            published: &published::SPEED,
            heading: "Escape against speed (Fig. 2), the paper's parameters",
            introduction: "The same with the preset `paper` for everybody.",
            title: "Chance of escape against speed, the paper's parameters",
            conditions: "Police 0.3 m/s with exact knowledge, presets of the paper.",
            image: "chase-escape-vs-speed-paper",
            experiment: "escape_vs_speed_paper",
        },
        Part {
            study: &evidence.knowledge,
            published: &published::KNOWLEDGE,
            heading: "What the Police know (Fig. 3), our planners",
            introduction: "RRT* evaders against Police that know everything, or only what they see and a \
                           particle filter makes of it.",
            title: "Chance of escape and what the Police know",
            conditions: "RRT* evaders, Police 0.3 m/s, our planners.",
            image: "chase-knowledge",
            experiment: "knowledge",
        },
        Part {
            study: &evidence.knowledge_paper,
            published: &published::KNOWLEDGE,
            heading: "What the Police know (Fig. 3), the paper's parameters",
            introduction: "The same with the preset `paper` for everybody.",
            title: "Chance of escape and what the Police know, the paper's parameters",
            conditions: "RRT* evaders, Police 0.3 m/s, presets of the paper.",
            image: "chase-knowledge-paper",
            experiment: "knowledge_paper",
        },
    ]
}

impl Part<'_> {
    fn text(&self) -> String {
        let mut text = format!("## {}\n\n{}\n\n", self.heading, self.introduction);
        let Some(study) = self.study else {
            return text + "*No results of this experiment.*\n\n";
        };
        text += &format!(
            "![{}](images/{}.svg)\n\n{}\n{}\n",
            self.title,
            self.image,
            table::cells(study, self.published),
            critical::table(study)
        );
        let unmatched = published::known(study, self.published).count() == 0;
        if unmatched {
            text += "None of these cases has a published counterpart.\n\n";
        }
        text
    }
}

/// A line for every claim.
fn overview(claims: &[Claim]) -> String {
    let mut text =
        "| | claim | our planners | the paper's parameters |\n|---|---|---|---|\n".to_owned();
    for claim in claims {
        text += &format!(
            "| [{}](#{}) | {} | {} | {} |\n",
            claim.letter,
            anchor(claim),
            in_table(claim.claim),
            bold(claim.ours.verdict),
            bold(claim.paper.verdict)
        );
    }
    text
}

fn bold(verdict: Verdict) -> String {
    match verdict {
        Verdict::Confirmed | Verdict::Refuted => format!("**{}**", verdict.word()),
        Verdict::Undecided | Verdict::NoData => verdict.word().to_owned(),
    }
}

/// Where the heading of a claim is found.
fn anchor(claim: &Claim) -> String {
    format!("claim-{}", claim.letter)
}

fn one_by_one(claim: &Claim) -> String {
    let side = |name: &str, finding: &Finding| {
        let mut text = format!("{name}: {}\n\n", bold(finding.verdict));
        for line in &finding.numbers {
            text += &format!("- {line}\n");
        }
        text
    };
    format!(
        "### Claim {}\n\n{}\n\n*Rule.* {}\n\n{}\n{}\n",
        claim.letter,
        claim.claim,
        claim.rule,
        side("With our planners", &claim.ours),
        side("With the paper's parameters", &claim.paper)
    )
}

fn reproduction(parts: &[Part<'_>]) -> String {
    let mut text = "## How to make this page\n\n```sh\n".to_owned();
    for part in parts {
        let name = part.experiment;
        text += &format!("protean sweep experiments/{name}.toml --in-process\n");
    }
    text += "protean sweep plans --out results/plans.csv\n";
    let folders = parts.iter().map(|p| format!("results/{}", p.experiment));
    let folders: Vec<String> = folders.collect();
    text += &format!(
        "protean sweep page {} \\\n    --plans results/plans.csv --out docs/chase-results.md\n```\n\n",
        folders.join(" ")
    );
    for part in parts {
        if let Some(study) = part.study {
            text += &format!(
                "- `{}`: seeds {}, Protean {}\n",
                part.experiment, study.seeds, study.program
            );
        }
    }
    text
}
