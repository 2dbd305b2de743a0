//! A traversal played.

use super::stepper_of;
use crate::inspect::{StepKind, Stepper};

#[test]
fn steps_are_played_forwards_and_back_within_their_ends() {
    let (mut stepper, cost) = stepper_of("cornell-box", [300, 240], 0);
    let count = stepper.len();
    assert!(count > 5);
    stepper.back();
    assert_eq!(stepper.at(), 0);
    stepper.forward();
    stepper.forward();
    assert_eq!(stepper.at(), 2);
    stepper.back();
    assert_eq!(stepper.at(), 1);
    stepper.go(usize::MAX);
    assert_eq!(stepper.at(), count - 1);
    // What was counted on the way is what the ray cost.
    let [entered, missed, pruned, triangles] = stepper.counts();
    assert_eq!(entered as u64, cost.nodes);
    assert_eq!((entered + missed + pruned) as u64, cost.boxes);
    assert_eq!(triangles as u64, cost.triangles);
}

#[test]
fn playing_takes_its_time_stops_at_the_end_and_begins_anew_from_there() {
    let (mut stepper, _) = stepper_of("cornell-box", [300, 240], 0);
    stepper.speed = 2.0;
    stepper.toggle();
    stepper.pass(0.4);
    assert_eq!(stepper.at(), 0);
    stepper.pass(0.2);
    assert_eq!(stepper.at(), 1, "1.2 steps have passed");
    stepper.pass(1e6);
    assert_eq!(stepper.at(), stepper.len() - 1);
    assert!(!stepper.playing);
    stepper.toggle();
    assert_eq!((stepper.at(), stepper.playing), (0, true));
}

#[test]
fn a_stack_entry_tells_where_it_is_entered_and_is_pruned_only_once_a_nearer_hit_is_known() {
    let mut pruned = 0;
    for pixel in [[300, 240], [260, 200], [340, 260], [300, 300]] {
        let (mut stepper, _) = stepper_of("knot", pixel, 0);
        for at in 0..stepper.len() {
            stepper.go(at);
            for (node, mark) in stepper.stack() {
                let rest = &stepper.steps()[at + 1..];
                let turn = rest
                    .iter()
                    .position(|s| s.triangle.is_none() && (s.instance, s.node) == node);
                let Some(turn) = turn else { continue };
                assert_eq!(mark.t, rest[turn].t, "step {at}");
                let hit_first = rest[..turn].iter().any(|s| s.kind == StepKind::Hit);
                let is = rest[turn].kind == StepKind::Pruned && !hit_first;
                assert_eq!(mark.is_pruned, is, "step {at}, {node:?}");
                pruned += usize::from(is);
            }
        }
    }
    assert!(pruned > 0, "nothing was ever pruned");
}

#[test]
fn nothing_to_play_is_no_fault() {
    let mut stepper = Stepper::default();
    stepper.toggle();
    stepper.forward();
    stepper.back();
    stepper.pass(1.0);
    assert_eq!((stepper.at(), stepper.len()), (0, 0));
    assert!(stepper.step().is_none());
    assert_eq!(stepper.stack().count(), 0);
}
