//! Links: messages of one process come to another later or not at all.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::seed;

/// Link of a topic from one process to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Name of the topic.
    pub topic: String,
    /// Index of the sender, the source in its stamps.
    pub source: u32,
    /// Name of the sender.
    pub from: String,
    /// Name of the receiver.
    pub to: String,
    /// Number of ticks after that of its stamp at which a message arrives.
    pub delay: u64,
    /// Probability with which a message never arrives, in [0, 1).
    pub loss: f64,
}

impl Link {
    /// Returns the losses on this link in a run with this seed.
    pub fn losses(&self, run_seed: u64) -> Losses {
        let purpose = format!("link {}", self.topic);
        Losses {
            stream: seed::stream(run_seed, &self.to, &self.from, &purpose),
            loss: self.loss,
        }
    }
}

/// Losses on a link. Whether a message is lost depends on its sequence number, not on the order of questions.
#[derive(Debug, Clone, PartialEq)]
pub struct Losses {
    stream: ChaCha8Rng,
    loss: f64,
}

impl Losses {
    /// Returns `true` if the message with this sequence number is lost.
    pub fn is_lost(&self, sequence: u64) -> bool {
        if self.loss <= 0.0 {
            return false;
        }
        let mut stream = self.stream.clone();
        // A number takes two words.
        stream.set_word_pos(u128::from(sequence) * 2);
        stream.random::<f64>() < self.loss
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_follow_from_seed_names_and_number_alone() {
        let link = Link {
            topic: "robot/command".to_owned(),
            source: 1,
            from: "a".to_owned(),
            to: "b".to_owned(),
            delay: 0,
            loss: 0.3,
        };
        let losses = link.losses(7);
        let forwards: Vec<bool> = (0..4000).map(|n| losses.is_lost(n)).collect();
        let backwards: Vec<bool> = (0..4000).rev().map(|n| losses.is_lost(n)).collect();
        assert!(forwards.iter().eq(backwards.iter().rev()));
        let lost = forwards.iter().filter(|lost| **lost).count();
        assert!((1100..1300).contains(&lost), "{lost}");
        for other in [
            link.losses(8),
            Link {
                from: "c".into(),
                ..link.clone()
            }
            .losses(7),
            Link {
                to: "c".into(),
                ..link.clone()
            }
            .losses(7),
            Link {
                topic: "c".into(),
                ..link.clone()
            }
            .losses(7),
        ] {
            assert!((0..4000).any(|n| other.is_lost(n) != forwards[n as usize]));
        }
    }
}
