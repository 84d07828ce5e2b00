//! A machine whose constants change while it runs: another tool, with other lever arms.
//!
//! In: a machine, and later another one with the same equations. Out: the equations of the one that is there now. It exists because a
//! compensator borrows its machine for as long as it runs, and the tool changes in between.

use core::cell::Cell;

use super::real::Real;
use super::{Kinematics, Share, Sines, Turning};

/// Passes the methods of [`Kinematics`] that give numbers on to another machine.
macro_rules! numbers_of {
    ($machine:ident => $of:expr) => {
        fn error(&self, position: &[Real], travel: &[Real], motions: &[Real]) -> [Real; 3] {
            let $machine = self;
            $of.error(position, travel, motions)
        }
        fn turn(&self, position: &[Real], sines: &mut Sines) {
            let $machine = self;
            $of.turn(position, sines);
        }
        fn error_with(
            &self,
            sines: &Sines,
            position: &[Real],
            travel: &[Real],
            motions: &[Real],
        ) -> [Real; 3] {
            let $machine = self;
            $of.error_with(sines, position, travel, motions)
        }
        fn nominal(&self, position: &[Real]) -> [Real; 3] {
            let $machine = self;
            $of.nominal(position)
        }
        fn direction(&self, position: &[Real]) -> [Real; 3] {
            let $machine = self;
            $of.direction(position)
        }
        fn direction_error(&self, position: &[Real], travel: &[Real], motions: &[Real]) -> [Real; 3] {
            let $machine = self;
            $of.direction_error(position, travel, motions)
        }
        fn aims(&self, position: &[Real], aims: &mut [[Real; 3]; 3]) {
            let $machine = self;
            $of.aims(position, aims);
        }
        fn directions(&self, position: &[Real], directions: &mut [[Real; 3]]) {
            let $machine = self;
            $of.directions(position, directions);
        }
        fn directions_with(&self, sines: &Sines, position: &[Real], directions: &mut [[Real; 3]]) {
            let $machine = self;
            $of.directions_with(sines, position, directions);
        }
    };
}

/// Passes the methods of [`Kinematics`] that are the same for all constants on to another machine.
macro_rules! topology_of {
    ($machine:ident => $of:expr) => {
        fn axes(&self) -> usize {
            let $machine = self;
            $of.axes()
        }
        fn travels(&self) -> &[usize] {
            let $machine = self;
            $of.travels()
        }
        fn motions(&self) -> usize {
            let $machine = self;
            $of.motions()
        }
        fn turning(&self) -> &[Turning] {
            let $machine = self;
            $of.turning()
        }
        fn following(&self) -> &[Share] {
            let $machine = self;
            $of.following()
        }
        fn squaring(&self) -> &[Share] {
            let $machine = self;
            $of.squaring()
        }
        fn aiming(&self) -> &[usize] {
            let $machine = self;
            $of.aiming()
        }
        fn directions_vary(&self) -> bool {
            let $machine = self;
            $of.directions_vary()
        }
        fn resting(&self) -> &[bool] {
            let $machine = self;
            $of.resting()
        }
        fn squares(&self) -> Option<[Real; 3]> {
            let $machine = self;
            $of.squares()
        }
        fn fixed_directions(&self) -> Option<&'static [[Real; 3]]> {
            let $machine = self;
            $of.fixed_directions()
        }
    };
}

impl<K: Kinematics + ?Sized> Kinematics for &K {
    topology_of!(machine => (**machine));
    numbers_of!(machine => (**machine));
}

/// A machine that may be exchanged, between two cycles, for the same machine with other constants.
///
/// ```
/// use abbe_runtime::{Exchanged, Kinematics};
/// # #[derive(Clone, Copy)]
/// # struct Lathe { zt: f64 }
/// # impl Kinematics for Lathe {
/// #     fn axes(&self) -> usize { 1 }
/// #     fn travels(&self) -> &[usize] { &[] }
/// #     fn motions(&self) -> usize { 1 }
/// #     fn error(&self, _: &[f64], _: &[f64], motions: &[f64]) -> [f64; 3] { [self.zt * motions[0], 0.0, 0.0] }
/// #     fn directions(&self, _: &[f64], directions: &mut [[f64; 3]]) { directions.fill([1.0, 0.0, 0.0]); }
/// # }
/// // A tool of 100 mm leans by 20 urad, and then one of 150 mm.
/// let machine = Exchanged::new(Lathe { zt: 100.0 });
/// assert_eq!(machine.error(&[0.0], &[], &[20e-6]), [0.002, 0.0, 0.0]);
/// machine.exchange(Lathe { zt: 150.0 });
/// assert_eq!(machine.error(&[0.0], &[], &[20e-6]), [0.003, 0.0, 0.0]);
/// ```
///
/// A compensator or a supervisor runs over it as over any machine. Whoever exchanges it calls
/// [`Supervisor::switch`](super::Supervisor::switch) too, so that the correction does not jump.
#[derive(Debug)]
pub struct Exchanged<K: Copy> {
    /// What is the same whichever is there: its slices are borrowed while another may come.
    first: K,
    now: Cell<K>,
}

impl<K: Kinematics + Copy> Exchanged<K> {
    /// The machine as it is first.
    pub const fn new(machine: K) -> Self {
        Self { first: machine, now: Cell::new(machine) }
    }

    /// Puts the machine with other constants in its place.
    pub fn exchange(&self, machine: K) {
        self.now.set(machine);
    }

    /// The machine that is there.
    pub const fn now(&self) -> K {
        self.now.get()
    }
}

impl<K: Kinematics + Copy> Kinematics for Exchanged<K> {
    topology_of!(machine => machine.first);
    numbers_of!(machine => machine.now.get());
}
