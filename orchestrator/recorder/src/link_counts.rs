//! Messages on the links of a run, and those lost.

use std::collections::BTreeMap;

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::topics::TopicId;
use runtime::link::{Link, Losses};

use super::summary::{LinkOutcome, OutcomePart, Summary};

/// Counts the messages of all links. Which of them are lost follows from the run, so that no receiver has to report it.
#[derive(Debug)]
pub(super) struct LinkCounts {
    topics: Vec<TopicId>,
    /// The outcome and the losses of each link, by topic and sender.
    links: BTreeMap<(TopicId, u32), Vec<(LinkOutcome, Losses)>>,
}

impl LinkCounts {
    pub(super) fn new(links: &[Link], seed: u64) -> Self {
        let mut of_senders: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for link in links {
            let Some(topic) = TopicId::all().find(|topic| topic.name() == link.topic) else {
                continue;
            };
            let outcome = LinkOutcome {
                topic: link.topic.clone(),
                from: link.from.clone(),
                to: link.to.clone(),
                messages: 0,
                lost: 0,
            };
            let of_sender = of_senders.entry((topic, link.source)).or_default();
            of_sender.push((outcome, link.losses(seed)));
        }
        let mut topics: Vec<TopicId> = of_senders.keys().map(|(topic, _)| *topic).collect();
        topics.dedup();
        Self {
            topics,
            links: of_senders,
        }
    }
}

impl Consumer for LinkCounts {
    fn topics(&self) -> &[TopicId] {
        &self.topics
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        let stamp = &message.stamp;
        let links = self.links.get_mut(&(message.topic, stamp.source));
        for (outcome, losses) in links.into_iter().flatten() {
            outcome.messages += 1;
            outcome.lost += u64::from(losses.is_lost(stamp.sequence));
        }
    }
}

impl OutcomePart for LinkCounts {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        let links = self.links.into_values().flatten();
        summary.links = links.map(|(outcome, _)| outcome).collect();
    }
}
