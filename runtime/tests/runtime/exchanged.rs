//! A machine that is exchanged for the same one with another tool.
//!
//! In: a lathe whose tools have two lengths. Out: the numbers of the tool that is there, and a correction that does not jump.

use abbe_runtime::{
    AxisMemory, Compensator, ErrorMotion, Exchanged, Kinematics, Memory, Supervisor, Term, TermState,
    Transition, Work,
};

use crate::common::{Lathe, at, with};

const SHORT: Lathe = Lathe { tool: [60.0, 100.0] };
const LONG: Lathe = Lathe { tool: [80.0, 150.0] };

#[test]
fn every_answer_is_that_of_the_machine_that_is_there() {
    let machine = Exchanged::new(SHORT);
    let motions = [0.01, -0.02, 1e-4, 2e-5];
    for there in [SHORT, LONG, SHORT] {
        machine.exchange(there);
        assert_eq!(machine.now().tool, there.tool);
        for (found, expected) in [(&machine as &dyn Kinematics, &there as &dyn Kinematics), (&&there, &there)]
        {
            assert_eq!(
                found.error(&[1.0, 2.0], &[3.0], &motions),
                expected.error(&[1.0, 2.0], &[3.0], &motions)
            );
            assert_eq!((found.axes(), found.travels(), found.motions()), (2, &[1_usize][..], 4));
            assert_eq!((found.resting(), found.turning()), (expected.resting(), expected.turning()));
            assert_eq!(found.fixed_directions(), expected.fixed_directions());
            assert_eq!((found.squares(), found.directions_vary()), (None, expected.directions_vary()));
            let mut directions = [[f64::NAN; 3]; 2];
            found.directions(&[1.0, 2.0], &mut directions);
            assert_eq!(directions, Lathe::DIRECTIONS);
        }
    }
}

#[test]
fn the_correction_goes_from_one_tool_to_the_other_little_by_little() {
    let ebx = [Term::Constant { value: 1e-4 }];
    let motions = [&[][..], &[], &ebx, &[]].map(|terms| ErrorMotion { terms });
    // What each tool asks for by itself.
    let alone = |machine: &Lathe| {
        let mut command = [0.0; 2];
        with(machine, &motions, |lathe| lathe.compensate(&at(&[0.0; 2]), &mut command).unwrap());
        command
    };
    let (short, long) = (alone(&SHORT), alone(&LONG));
    assert!((short[0] + 0.010).abs() < 1e-12 && (long[0] + 0.015).abs() < 1e-12);

    let machine = Exchanged::new(SHORT);
    let mut states = [TermState::default()];
    let (mut directions, mut values, mut travel) = ([[0.0; 3]; 2], [0.0; 4], [0.0]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
    let mut axes = [AxisMemory::default(); 2];
    let memory = Memory { axes: &mut axes, temperature: &mut [], silence: &mut [] };
    let mut supervisor = Supervisor::new(compensator, memory).unwrap();
    supervisor.transition = Transition { fade: 0.010, ..Transition::default() };
    let mut command = [0.0; 2];
    for _ in 0..20 {
        supervisor.cycle(&at(&[0.0; 2]), &mut command);
    }
    assert_eq!(command, short);
    machine.exchange(LONG);
    supervisor.switch();
    for cycle in 1..=12 {
        let done = supervisor.cycle(&at(&[0.0; 2]), &mut command);
        let part = f64::from(cycle.min(10)) / 10.0;
        for axis in 0..2 {
            let expected = short[axis] + part * (long[axis] - short[axis]);
            assert!((command[axis] - expected).abs() < 1e-12, "{cycle}: {command:?}");
        }
        assert_eq!(done.settling, cycle < 10);
    }
}
