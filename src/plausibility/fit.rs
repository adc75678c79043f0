//! How far one joint's weight and friction explain a column of torque.

/// rad/s: slower is no sliding.
const SLIDING: f64 = 0.02;
/// Fewer sliding instants are no motion: all of them are taken.
const FEWEST_SLIDING: usize = 100;
/// Columns: direction of motion, velocity, acceleration (rotors that the twin does not know), what the
/// rigid body needs, angle (a spring that carries the arm); then the torque.
const DIRECTION: usize = 0;
const SPEED: usize = 1;
const ROTOR: usize = 2;
const RIGID: usize = 3;
const SPRING: usize = 4;
const TORQUE: usize = 5;
const COLUMNS: usize = 6;
/// Share of a column that others must leave of it to count beside them.
const INDEPENDENT: f64 = 1e-9;

/// torque = slope rigid + rotor acceleration + friction(velocity) + constant, by least squares; with a spring beside them
/// where the joint would carry no arm without one (counterbalances outweigh what they carry).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// Torque over what the rigid body needs.
    pub slope: f64,
    /// Share of what friction leaves that the rigid body explains.
    pub by_weight: f64,
    /// Mean power that friction takes, W; negative where it would give.
    pub power: f64,
    /// Share that all explain.
    pub total: f64,
    /// Share that all explain with friction that takes power, and an arm that is carried and does not carry.
    pub physical: f64,
}

/// Motion (rad, rad/s, rad/s2) and torque (N.m) of one joint at the same instants.
pub struct Joint<'a> {
    pub q: &'a [f64],
    pub qd: &'a [f64],
    pub qdd: &'a [f64],
    /// What the rigid body needs, N.m.
    pub rigid: &'a [f64],
    pub torque: &'a [f64],
    /// Whether the rigid body's part is so sure that its slope cannot be negative.
    pub heavy: bool,
    /// No rotor has more inertia at the joint, kg.m2.
    pub most_inertia: f64,
}

impl Joint<'_> {
    pub fn fit(&self) -> Fit {
        let Self { q, qd, qdd, rigid, torque, heavy, most_inertia } = self;
        let slides = |k: &usize| qd[*k].abs() > SLIDING;
        let sliding: Vec<usize> = (0..qd.len()).filter(slides).collect();
        let rows = if sliding.len() < FEWEST_SLIDING { (0..qd.len()).collect() } else { sliding };
        let direction = |k: usize| if slides(&k) { qd[k].signum() } else { 0.0 };
        let column = |of: &dyn Fn(usize) -> f64| rows.iter().map(|k| of(*k)).collect::<Vec<f64>>();
        let sums = Sums::new(&[
            column(&direction),
            column(&|k| qd[k]),
            column(&|k| qdd[k]),
            column(&|k| rigid[k]),
            column(&|k| q[k]),
            column(&|k| torque[k]),
        ]);
        // In a swing, acceleration goes as position does, and would take the weight's part.
        let inertia = sums.swept(&[DIRECTION, SPEED, ROTOR, RIGID]).of(ROTOR);
        let rotor = (0.0..=*most_inertia).contains(&inertia);
        let swept = |which: &[usize]| match rotor {
            true => sums.swept(&[&[ROTOR], which].concat()),
            false => sums.swept(which),
        };
        let whole = [DIRECTION, SPEED, RIGID];
        let (alone, sprung) = (swept(&whole), swept(&[&whole[..], &[SPRING]].concat()));
        let outweighed = alone.of(RIGID) < 0.0 && sprung.of(RIGID) > 0.0 && sprung.of(SPRING) > 0.0;
        let spring: &[usize] = if *heavy && outweighed { &[SPRING] } else { &[] };
        let with = |which: &[usize]| swept(&[which, spring].concat());
        let found = with(&whole);
        let (friction, weight) = (with(&[DIRECTION, SPEED]).left(), with(&[RIGID]).left());
        let mean =
            |f: &dyn Fn(usize) -> f64| rows.iter().map(|k| f(*k)).sum::<f64>() / rows.len() as f64;
        let power = found.of(DIRECTION) * mean(&|k| direction(k) * qd[k])
            + found.of(SPEED) * mean(&|k| qd[k] * qd[k]);
        let all = sums.0[TORQUE][TORQUE].max(f64::MIN_POSITIVE);
        let share = |left: f64, of: f64| 1.0 - left / of.max(f64::MIN_POSITIVE);
        let physical = match (*heavy && found.of(RIGID) < 0.0, power < 0.0) {
            (false, false) => found.left(),
            (true, false) => friction,
            (false, true) => weight,
            (true, true) => all,
        };
        Fit {
            slope: found.of(RIGID),
            by_weight: share(found.left(), friction),
            power,
            total: share(found.left(), all),
            physical: share(physical, all),
        }
    }
}

/// Sums of products of centred columns.
#[derive(Clone)]
struct Sums([[f64; COLUMNS]; COLUMNS]);

impl Sums {
    fn new(columns: &[Vec<f64>; COLUMNS]) -> Self {
        let n = columns[0].len().max(1) as f64;
        let means = columns.each_ref().map(|c| c.iter().sum::<f64>() / n);
        let product = |a: usize, b: usize| {
            let pairs = columns[a].iter().zip(&columns[b]);
            pairs.map(|(x, y)| (x - means[a]) * (y - means[b])).sum()
        };
        Self(std::array::from_fn(|a| std::array::from_fn(|b| product(a, b))))
    }

    /// Least squares on the columns `which`, one swept after the other (Goodnight, "A tutorial on the SWEEP
    /// operator", The American Statistician 33(3), 1979); what others explain already counts as nothing.
    fn swept(&self, which: &[usize]) -> Swept {
        let mut a = self.0;
        let mut taken = [false; COLUMNS];
        for &c in which {
            let pivot = a[c][c];
            if pivot <= INDEPENDENT * self.0[c][c] || pivot <= 0.0 {
                continue;
            }
            taken[c] = true;
            let row = a[c].map(|x| x / pivot);
            for i in (0..COLUMNS).filter(|i| *i != c) {
                let b = a[i][c];
                for k in 0..COLUMNS {
                    a[i][k] -= b * row[k];
                }
                a[i][c] = -b / pivot;
            }
            a[c] = row;
            a[c][c] = 1.0 / pivot;
        }
        Swept { a, taken }
    }
}

/// Coefficients and remainder after a sweep.
struct Swept {
    a: [[f64; COLUMNS]; COLUMNS],
    taken: [bool; COLUMNS],
}

impl Swept {
    fn of(&self, column: usize) -> f64 {
        if self.taken[column] { self.a[column][TORQUE] } else { 0.0 }
    }

    /// Sum of squares of the torque that is not explained.
    fn left(&self) -> f64 {
        self.a[TORQUE][TORQUE].max(0.0)
    }
}
