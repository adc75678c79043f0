//! The arm as capsules, and how near they come to each other and to what stands around it.

use nalgebra::Vector3;

use super::geometry::{Cuboid, Segment, segment_box, segment_segment};
use crate::robot::{Robot, body_placements};

/// What stands around the arm, in the axes of its base.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Surroundings {
    /// Height of a table's top, m: everything below is out of bounds.
    pub table_z: Option<f64>,
    pub keep_out: Vec<Cuboid>,
}

/// One capsule per link, around the line from its joint to the next one (the last one's to the
/// flange), one from the base to the first joint, and one for a tool.
#[derive(Debug, Clone)]
pub struct Capsules {
    /// m
    pub radius: f64,
    /// Length of the tool beyond the flange along its z axis, m.
    tool: f64,
    names: Vec<String>,
    /// Capsules that can touch: others are held apart, or together, by what lies between them.
    pairs: Vec<[usize; 2]>,
    /// Does the point where capsule `i` begins, or the last one ends, ever move?
    moves: Vec<bool>,
}

/// The shortest distance between surfaces, m; negative where they overlap.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Closest {
    pub distance_m: f64,
    pub between: [String; 2],
}

/// Radius as a share of the length of the arm where none is given: about a UR's.
const RADIUS_SHARE: f64 = 0.05;
/// Capsules with less than so many radii of arm between them are not judged: the housings of a UR wrist
/// are nearer than that in every pose.
const APART_RADII: f64 = 4.0;
/// Closer than this is the same place, m.
const SAME_M: f64 = 1e-9;

impl Capsules {
    /// `radius` and `tool` length in m.
    pub fn new(robot: &Robot, radius: Option<f64>, tool: f64) -> Self {
        let mut capsules = Self {
            radius: 0.0,
            tool,
            names: std::iter::once("base".to_string())
                .chain(robot.bodies.iter().map(|b| b.name.clone()))
                .chain((tool > 0.0).then(|| "tool".to_string()))
                .collect(),
            pairs: Vec::new(),
            moves: Vec::new(),
        };
        let [here, there] = [0.3, -0.8].map(|turn| {
            let q: Vec<f64> = (0..robot.dof()).map(|j| turn + 0.21 * j as f64).collect();
            capsules.points(robot, &q)
        });
        let lengths: Vec<f64> = here.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
        let of_arm: f64 = lengths.iter().sum::<f64>() - tool;
        capsules.radius = radius.unwrap_or(RADIUS_SHARE * of_arm);
        capsules.moves = here.iter().zip(&there).map(|(a, b)| (a - b).norm() > SAME_M).collect();
        let apart = |[a, b]: &[usize; 2]| {
            lengths[a + 1..*b].iter().sum::<f64>() > APART_RADII * capsules.radius
        };
        let n = lengths.len();
        let all = (0..n).flat_map(|a| (a + 2..n).map(move |b| [a, b]));
        capsules.pairs = all.filter(apart).collect();
        capsules
    }

    /// Points where the capsules begin and the last one ends, m: base, joints, flange, tip of the tool.
    fn points(&self, robot: &Robot, q: &[f64]) -> Vec<Vector3<f64>> {
        let placements = body_placements(robot, q);
        let mut points = vec![Vector3::zeros()];
        points.extend(placements.iter().map(|p| p.translation));
        let flange = placements.last().map_or(robot.flange, |last| last.compose(&robot.flange));
        points.push(flange.translation);
        if self.tool > 0.0 {
            points.push(flange.point(&(Vector3::z() * self.tool)));
        }
        points
    }

    /// Closest approach in one pose, rad.
    pub fn closest(&self, robot: &Robot, q: &[f64], around: &Surroundings) -> Option<Closest> {
        let (distance_m, what) = self.nearest(robot, q, around)?;
        Some(Closest { distance_m, between: self.named(what) })
    }

    /// Smallest distance in one pose, m, and which two things it is between.
    pub(super) fn nearest(
        &self,
        robot: &Robot,
        q: &[f64],
        around: &Surroundings,
    ) -> Option<(f64, Between)> {
        let points = self.points(robot, q);
        let segments: Vec<Segment> = points.windows(2).map(|w| [w[0], w[1]]).collect();
        let each_other = self.pairs.iter().map(|&[a, b]| {
            let distance = segment_segment(&segments[a], &segments[b]) - 2.0 * self.radius;
            (distance, Between::Capsules(a, b))
        });
        let table = around.table_z.into_iter().flat_map(|z| {
            let moving = points.iter().enumerate().filter(|(i, _)| self.moves[*i]);
            moving.map(move |(i, p)| (p.z - z - self.radius, Between::Table(i - 1)))
        });
        let boxes = around.keep_out.iter().enumerate().flat_map(|(k, cuboid)| {
            segments.iter().enumerate().map(move |(i, segment)| {
                (segment_box(segment, cuboid) - self.radius, Between::Box(i, k))
            })
        });
        each_other.chain(table).chain(boxes).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    pub(super) fn named(&self, what: Between) -> [String; 2] {
        let name = |i: usize| self.names[i].clone();
        match what {
            Between::Capsules(a, b) => [name(a), name(b)],
            Between::Table(i) => [name(i), "the table".into()],
            Between::Box(i, k) => [name(i), format!("keep-out box {}", k + 1)],
        }
    }
}

/// Which two things are meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Between {
    Capsules(usize, usize),
    Table(usize),
    Box(usize, usize),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::builtin;

    const NOTHING: Surroundings = Surroundings { table_z: None, keep_out: Vec::new() };

    /// A UR5 stretched out: the flange lies 0.81725 m along -x at the height of the shoulder less
    /// d5 (the tables' d and a).
    #[test]
    fn distances_of_a_stretched_arm() {
        let robot = builtin("ur5").unwrap();
        let capsules = Capsules::new(&robot, Some(0.05), 0.0);
        let q = [0.0; 6];
        let table = Surroundings { table_z: Some(-0.05), ..NOTHING };
        let closest = capsules.closest(&robot, &q, &table).unwrap();
        let lowest = 0.089159 - 0.09465;
        assert!((closest.distance_m - (lowest + 0.05 - 0.05)).abs() < 1e-9, "{closest:?}");
        assert_eq!(closest.between[1], "the table");
        // The upper arm runs along -x at z = d1, y = 0.
        let cuboid = Cuboid { lower: [-0.3, 0.06, 0.0], upper: [-0.1, 0.4, 0.5] };
        let around = Surroundings { keep_out: vec![cuboid], ..NOTHING };
        let closest = capsules.closest(&robot, &q, &around).unwrap();
        assert!((closest.distance_m - 0.01).abs() < 1e-9, "{closest:?}");
        assert_eq!(closest.between[1], "keep-out box 1");
    }

    #[test]
    fn folded_on_itself_the_arm_touches_and_stretched_it_does_not() {
        let robot = builtin("ur5").unwrap();
        let capsules = Capsules::new(&robot, None, 0.0);
        assert!((0.05..0.07).contains(&capsules.radius), "{}", capsules.radius);
        let at = |q: [f64; 6]| capsules.closest(&robot, &q, &NOTHING).unwrap();
        assert!(at([0.0, -1.57, 0.0, 0.0, 0.0, 0.0]).distance_m > 0.02);
        let folded = at([0.0, -1.57, 3.0, 0.0, 0.0, 0.0]);
        // The wrist lies d4 = 0.109915 m beside the upper arm, which is two radii.
        assert!(
            (folded.distance_m - (0.109915 - 2.0 * capsules.radius)).abs() < 2e-3,
            "{folded:?}"
        );
    }

    #[test]
    fn a_tool_reaches_further_down() {
        let robot = builtin("ur5").unwrap();
        let table = Surroundings { table_z: Some(-2.0), ..NOTHING };
        // Flange pointing down.
        let q = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0];
        let height = |tool: f64| {
            let capsules = Capsules::new(&robot, Some(0.01), tool);
            let (distance, _) = capsules.nearest(&robot, &q, &table).unwrap();
            (distance, capsules.points(&robot, &q).last().unwrap().z)
        };
        let ((_, bare), (_, long)) = (height(0.0), height(0.15));
        assert!((bare - long - 0.15).abs() < 1e-3, "{bare} {long}");
    }
}
