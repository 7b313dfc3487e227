//! Improving a lobe by its lobe error, in few steps.

use crate::lobe::Family;
use crate::math::symmetric::MohrCircle;
use crate::math::vector::{combine, frame, normalised};
use crate::metric::density::Lobe;
use crate::metric::reference::Reference;

/// Rounds over the four directions of search. Twice as many rounds gain less than 0.001 on real materials.
const ROUNDS: usize = 4;
/// First steps: relative for the two squared alphas; in alphas for the normal along both axes.
const STEPS: [f64; 4] = [0.25, 0.25, 0.2, 0.2];

/// Returns `start` with its two alphas and its normal moved along its axes as long as this lowers the lobe error: a
/// search along coordinates, whose steps are halved when they fail. The result is no worse than `start` for
/// `reference`.
pub fn refine(reference: &Reference, start: &Lobe) -> Lobe {
    let mut best = (*start, reference.error(start));
    let mut steps = STEPS;
    for _ in 0..ROUNDS {
        for (direction, step) in steps.iter_mut().enumerate() {
            let moved = [1.0, -1.0].into_iter().find_map(|sign| {
                let lobe = neighbour(reference.family(), &best.0, direction, sign * *step);
                let error = reference.error(&lobe);
                (error < best.1).then_some((lobe, error))
            });
            match moved {
                Some(better) => best = better,
                None => *step *= 0.5,
            }
        }
    }
    best.0
}

fn neighbour(family: Family, lobe: &Lobe, direction: usize, step: f64) -> Lobe {
    let circle = MohrCircle::from(lobe.squared_alpha());
    let ([cos_twice, _], [_, uv]) = (circle.doubled_axis(), circle.direction);
    // Half-angle formulas give the axis of the larger eigenvalue.
    let (cos, sin) = ((0.5 * (1.0 + cos_twice)).sqrt(), (0.5 * (1.0 - cos_twice)).max(0.0).sqrt().copysign(uv));
    let (axes, mut squares) = ([[cos, sin], [-sin, cos]], circle.eigenvalues());
    let mut normal = lobe.normal();
    match direction {
        0 | 1 => {
            let factor = if step > 0.0 { 1.0 + step } else { 1.0 / (1.0 - step) };
            squares[direction] = (squares[direction] * factor).min(1.0);
        }
        _ => {
            let ([x, y], length) = (axes[direction - 2], step * squares[direction - 2].max(0.0).sqrt());
            normal = normalised(combine([x * length, y * length, 1.0], frame(normal)));
        }
    }
    let [[x, y], _] = axes;
    let spread = squares[0] - squares[1];
    Lobe::new(family, normal, [squares[1] + spread * x * x, spread * x * y, squares[1] + spread * y * y])
}
