//! The `<inertial>` of a link, and what is done where its tensor is not that of a rigid body.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use roxmltree::Node;

use super::elements::{Element, Link};
use super::notes::Notes;
use crate::robot::plausible::{self, Moments, ROUNDING, WIDEST_M};
use crate::robot::{Inertia, RobotError};

/// kg/m^3, aluminium: hardly a link is denser.
const DENSITY: f64 = 2700.0;

/// Inertia of `link`, in its own frame; zero without `<inertial>`. A tensor that is far from that of a
/// body is refused in a link of the `chain`, and left out in one that is only carried along.
pub(super) fn read(link: &Link, chain: bool, notes: &mut Notes) -> Result<Inertia, RobotError> {
    let element = &link.element;
    let Some(inertial) = element.only(element.node, "inertial", notes) else {
        return Ok(Inertia::zero());
    };
    let at = element.origin(inertial, notes)?;
    let mass = mass(element, inertial, notes)?;
    let written = tensor(element, inertial, notes)?;
    let about_com = match check(&written) {
        Tensor::Sound => written,
        Tensor::Slip(problem, mended) => {
            notes.of("link", link.name, problem);
            mended
        }
        Tensor::Wrong(problem) if chain => {
            let todo = "correct <inertia>, off-diagonal signs and units first";
            return Err(element.wrong(format!("its {problem}; {todo}")));
        }
        Tensor::Wrong(problem) => {
            notes.of("link", link.name, format!("{problem}; taken as a point mass"));
            Matrix3::zeros()
        }
    };
    note_wide(link.name, mass, &about_com, notes);
    Ok(Inertia { mass, com: Vector3::zeros(), about_com }.seen_from(&at))
}

/// Moments in kg.mm2 are a million times too large.
fn note_wide(link: &str, mass: f64, about_com: &Matrix3<f64>, notes: &mut Notes) {
    let radius = (about_com.trace() / 2.0 / mass).sqrt();
    if mass > 0.0 && radius > WIDEST_M {
        let text = format!(
            "with {mass} kg its inertia tensor is that of masses {radius:.0} m away; are its units \
             kg.m2? taken as written"
        );
        notes.of("link", link, text);
    }
}

fn mass<'a>(
    element: &Element<'a>,
    inertial: Node<'a, 'a>,
    notes: &mut Notes,
) -> Result<f64, RobotError> {
    let mass = element.only(inertial, "mass", notes).and_then(|m| m.attribute("value"));
    let mass = mass.ok_or_else(|| element.wrong("its <inertial> has no <mass value>; add it"))?;
    let [mass] = element.numbers("mass", "value", mass, notes)?;
    plausible::mass(mass).map_err(|e| element.wrong(format!("its {e}")))?;
    Ok(mass)
}

/// Inertia tensor as written, in the axes of the inertial origin, kg.m2.
fn tensor<'a>(
    element: &Element<'a>,
    inertial: Node<'a, 'a>,
    notes: &mut Notes,
) -> Result<Matrix3<f64>, RobotError> {
    let Some(inertia) = element.only(inertial, "inertia", notes) else {
        notes.of("link", element.name, "a mass but no <inertia>; taken as a point mass");
        return Ok(Matrix3::zeros());
    };
    let mut moment = |name: &str| match inertia.attribute(name) {
        Some(text) => element.numbers("inertia", name, text, notes).map(|[value]| value),
        None => {
            let text = format!("no {name} in <inertia>; taken as 0");
            notes.of("link", element.name, text);
            Ok(0.0)
        }
    };
    let [xx, xy, xz] = [moment("ixx")?, moment("ixy")?, moment("ixz")?];
    let [yy, yz, zz] = [moment("iyy")?, moment("iyz")?, moment("izz")?];
    Ok(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

enum Tensor {
    Sound,
    /// What is wrong and what is taken.
    Slip(String, Matrix3<f64>),
    /// What is wrong.
    Wrong(String),
}

fn check(tensor: &Matrix3<f64>) -> Tensor {
    let mut principal = tensor.symmetric_eigen();
    let sorted @ [least, middle, most] = sorted(&principal.eigenvalues);
    let eigenvalues = format!("(eigenvalues {least:.3e}, {middle:.3e}, {most:.3e} kg.m2)");
    match plausible::moments(sorted) {
        Moments::Possible => Tensor::Sound,
        Moments::Indefinite => {
            Tensor::Wrong(format!("inertia tensor is not positive definite {eigenvalues}"))
        }
        Moments::SlightlyNegative => {
            principal.eigenvalues.apply(|e| *e = e.max(0.0));
            let problem = "inertia tensor is not quite positive definite";
            let problem = format!("{problem} {eigenvalues}; what is negative is taken as 0");
            Tensor::Slip(problem, principal.recompose())
        }
        Moments::Unequal => {
            let problem = format!(
                "inertia tensor {eigenvalues} breaks the triangle inequality, no rigid body has \
                 it; taken as written"
            );
            Tensor::Slip(problem, *tensor)
        }
        Moments::Absurd(times) => Tensor::Wrong(plausible::absurd(times, &eigenvalues)),
        Moments::Huge => {
            Tensor::Wrong(format!("inertia tensor {eigenvalues} is that of no machine"))
        }
    }
}

/// Simulation needs positive principal moments of every body that moves; those that are not become
/// what a ball of the body's mass has, a lower bound of what the link can have.
pub(super) fn with_positive_moments(body: &str, inertia: Inertia, notes: &mut Notes) -> Inertia {
    let SymmetricEigen { eigenvectors, mut eigenvalues } = inertia.about_com.symmetric_eigen();
    let [least, _, most] = sorted(&eigenvalues);
    if least > ROUNDING * most && most > 0.0 {
        return inertia;
    }
    let ball = if most > 0.0 { ball(inertia.mass).min(most) } else { ball(inertia.mass) };
    eigenvalues.apply(|e| *e = if *e > ROUNDING * most { *e } else { ball });
    let which = if most > 0.0 { "has principal moments of zero" } else { "is zero" };
    let text = format!(
        "inertia tensor {which}; {ball:.3e} kg.m2 is taken, not more than an aluminium ball of \
         its mass has"
    );
    notes.of("link", body, text);
    let about_com = eigenvectors * Matrix3::from_diagonal(&eigenvalues) * eigenvectors.transpose();
    Inertia { about_com, ..inertia }
}

/// 2/5 m r^2, kg.m2, of a solid ball.
fn ball(mass: f64) -> f64 {
    let radius = (mass / (4.0 / 3.0 * std::f64::consts::PI * DENSITY)).cbrt();
    0.4 * mass * radius.powi(2)
}

fn sorted(values: &Vector3<f64>) -> [f64; 3] {
    let mut sorted: [f64; 3] = (*values).into();
    sorted.sort_by(f64::total_cmp);
    sorted
}
