//! Perception.

use ipc_types::messages::perception::Particle;
use ipc_types::topics::{Belief, Sightings};

use super::{ROOM, VIEWPOINTS, send_map};
use crate::support::rig::{Rig, World};

#[test]
fn perception_tells_what_is_seen_and_believed_at_every_tick() {
    let mut rig = Rig::new(ROOM, "eyes");
    let mut world = World::open(&rig);
    let (sightings, beliefs) = (rig.subscriber::<Sightings>(), rig.subscriber::<Belief>());
    rig.take_off();
    world.begin(&mut rig, send_map);
    for tick in 0..60_u64 {
        // Seen across the room, then behind the wall, then out of the game.
        let (x, y) = if tick < 20 { (0.8, 0.6) } else { (3.0, 0.3) };
        (world.robots[1].x, world.robots[1].y) = (x, y);
        world.robots[1].status = u8::from(tick >= 40);
        world.tick(&rig, tick);
        let message = sightings.receive().unwrap().expect("sightings");
        assert!(sightings.receive().unwrap().is_none());
        let stamp = message.header().stamp;
        assert_eq!(
            (stamp.tick, stamp.source, stamp.sequence),
            (tick, VIEWPOINTS, tick)
        );
        if tick >= 40 {
            assert_eq!(message.elements().len(), 0);
            assert!(
                beliefs.receive().unwrap().is_none(),
                "no belief without opponents"
            );
            continue;
        }
        let [seen] = message.elements() else {
            panic!("{message:?}")
        };
        assert_eq!(
            (seen.robot, seen.seen != 0),
            (1, tick < 20),
            "tick {tick}: {seen:?}"
        );
        if tick < 20 {
            assert_eq!(seen.observer, 0);
            assert!(
                (seen.x - x).abs() < 0.2 && (seen.y - y).abs() < 0.2,
                "{seen:?}"
            );
            assert_eq!(
                (seen.theta, seen.heading_known),
                (0.0, 0),
                "no leaked heading"
            );
        } else {
            assert_eq!(
                (seen.x, seen.y, seen.theta),
                (0.0, 0.0, 0.0),
                "no leaked place"
            );
        }
        let belief = beliefs.receive().unwrap().expect("a belief");
        assert!(beliefs.receive().unwrap().is_none());
        let header = belief.header();
        assert_eq!((header.stamp.tick, header.robot), (tick, 1));
        let finite = |p: &Particle| {
            [p.x, p.y, p.theta, p.weight].iter().all(|v| v.is_finite()) && p.weight >= 0.0
        };
        assert!(!belief.elements().is_empty() && belief.elements().iter().all(finite));
        let weight: f32 = belief.elements().iter().map(|p| p.weight).sum();
        assert!((weight - 1.0).abs() < 1e-3, "{weight}");
        assert!(
            header.mean_x.is_finite() && header.covariance_xx >= 0.0,
            "{header:?}"
        );
    }
    rig.rejected(0);
}
