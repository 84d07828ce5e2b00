//! Position loops: how an axis follows what it is told.
//!
//! In: a command that is straight between rows, or a parabola there. Out: position and velocity at the rows, by the exact solution of the
//! loop's equation, so that neither rows nor loop have to be slow. What pushes inside a loop, such as friction on the drive, is
//! answered as a command of that size would be: q'' = w^2 (q_cmd + e - q) - (w^2/K) q'.

/// The loop of an axis: `q' = K (q_cmd - q)`, or of second order with the natural frequency w.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct PositionLoop {
    /// 1/K, s: what the axis stays behind by, over its velocity. 0: no loop. Below zero the drive leads, because its feed-forward
    /// is too large: such a loop has no stable solution, and stands for its steady state `q = q_cmd - v/K`.
    pub(crate) time_constant: f64,
    /// 1/w^2, s^2. 0: of first order.
    pub(crate) inertia: f64,
}

/// Where an axis stands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stand {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

/// Where a loop begins.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum Start {
    /// At rest on its command.
    #[default]
    AtRest,
    /// In the steady motion behind a command with this velocity and acceleration, which has gone on for long.
    Underway { velocity: f64, acceleration: f64 },
    /// Here.
    At(Stand),
}

/// A command between two instants: a parabola, which is straight without acceleration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// How long it takes, s.
    pub(crate) time: f64,
    pub(crate) acceleration: f64,
}

/// What a loop remembers from row to row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Follower {
    start: Start,
    /// Time and command of the row before, and where it stood.
    before: Option<(f64, f64, Stand)>,
}

impl Follower {
    /// A loop that begins anywhere.
    pub(crate) fn from(start: Start) -> Self {
        Self { start, before: None }
    }
}

impl PositionLoop {
    /// Whether there is one that follows.
    pub(crate) fn acts(self) -> bool {
        self.time_constant > 0.0
    }

    /// Whether the drive leads.
    pub(crate) fn leads(self) -> bool {
        self.time_constant < 0.0
    }

    /// Behind this time, s, less than 1 % is left of any distance from the steady motion.
    pub(crate) fn settling(self) -> f64 {
        if self.acts() {
            SETTLED * self.time_constant.max(2.0 * self.inertia / self.time_constant)
        } else {
            0.0
        }
    }

    /// Where the axis stands in the next row, to which its command has gone with this acceleration. In a row without a command nothing is
    /// known, and the loop goes on from the row before.
    pub(crate) fn follow(self, follower: &mut Follower, time: f64, command: f64, acceleration: f64) -> Stand {
        if !command.is_finite() {
            return Stand { position: f64::NAN, velocity: f64::NAN };
        }
        let stand = match follower.before {
            None => self.begin(follower.start, command),
            Some((before, from, stand)) => {
                self.step(stand, Piece { from, to: command, time: time - before, acceleration })
            }
        };
        follower.before = Some((time, command, stand));
        stand
    }

    /// Where it stands in the first row.
    fn begin(self, start: Start, command: f64) -> Stand {
        match start {
            Start::AtRest => Stand { position: command, velocity: 0.0 },
            Start::Underway { velocity, acceleration } => self.steady(command, velocity, acceleration),
            Start::At(stand) => stand,
        }
    }

    /// Where it stands at the end of a piece of its command.
    pub(crate) fn step(self, stand: Stand, Piece { from, to, time, acceleration }: Piece) -> Stand {
        if !self.acts() || time <= 0.0 {
            return if self.acts() { stand } else { Stand { position: to, velocity: 0.0 } };
        }
        let (slope, bend) = ((to - from) / time, 0.5 * acceleration * time);
        let first = self.steady(from, slope - bend, acceleration);
        let last = self.steady(to, slope + bend, acceleration);
        // The distance from the steady motion fades by itself.
        let (distance, speed) = (stand.position - first.position, stand.velocity - first.velocity);
        let (distance, speed) = self.fade(distance, speed, time);
        Stand { position: last.position + distance, velocity: last.velocity + speed }
    }

    /// The solution that does not fade where the command is a parabola: `q = c - time_constant c' + (time_constant^2 - inertia) c''`.
    fn steady(self, command: f64, velocity: f64, acceleration: f64) -> Stand {
        let behind = self.time_constant * velocity;
        let bent = (self.time_constant * self.time_constant - self.inertia) * acceleration;
        Stand { position: command - behind + bent, velocity: velocity - self.time_constant * acceleration }
    }

    /// The solution of `inertia y'' + time_constant y' + y = 0` after a time.
    fn fade(self, y: f64, speed: f64, time: f64) -> (f64, f64) {
        if self.inertia <= 0.0 {
            let y = y * (-time / self.time_constant).exp();
            return (y, -y / self.time_constant);
        }
        let fading = 0.5 * self.time_constant / self.inertia;
        let stiffness = 1.0 / self.inertia;
        let (even, odd) = modes(time, fading, stiffness - fading * fading);
        (y * even + (speed + fading * y) * odd, speed * even - (fading * speed + stiffness * y) * odd)
    }
}

/// After this many time constants less than 1 % of a distance is left.
const SETTLED: f64 = 5.0;

/// `e^(-fading t)` times cos(r t) and sin(r t)/r, or cosh and sinh where the square of r is negative.
fn modes(time: f64, fading: f64, square: f64) -> (f64, f64) {
    let root = square.abs().sqrt();
    if root * time < 1e-6 {
        let decay = (-fading * time).exp();
        (decay, decay * time)
    } else if square > 0.0 {
        let (sine, cosine) = (root * time).sin_cos();
        let decay = (-fading * time).exp();
        (decay * cosine, decay * sine / root)
    } else {
        // The slow mode by what the fast one leaves of it: their rates may differ by many powers of ten.
        let slow = (-(fading * fading + square) / (fading + root) * time).exp();
        let fast = (-(fading + root) * time).exp();
        (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
    }
}

#[cfg(test)]
mod tests;
