//! Footprints with two peaks: a V-groove and its best single lobe.

use std::error::Error;
use std::path::Path;

use roughcast::lobe::Family;
use roughcast::metric::{Footprint, Lobe, Part, Peer, Reference, SAMPLES, oracle};

use super::picture::{Canvas, write};
use super::{head, row};

pub fn print(folder: &Path) -> Result<(), Box<dyn Error>> {
    head("V-grooves", &["alpha", "slope / alpha", "plain mips", "D, c = 1", "best single lobe"]);
    for alpha in [0.05, 0.2] {
        for ratio in [0.5, 1.0, 2.0, 4.0] {
            let errors = errors(&groove(alpha * ratio, alpha)?);
            let cells = [alpha.to_string(), ratio.to_string()];
            row(&cells.into_iter().chain(errors.map(|e| format!("{e:.3}"))).collect::<Vec<_>>());
        }
    }
    draw(folder)
}

/// Makes the two flanks of a groove, of equal size.
fn groove(slope: f64, alpha: f64) -> Result<Footprint, Box<dyn Error>> {
    let base = [alpha * alpha, 0.0, alpha * alpha];
    let parts = [-slope, slope].map(|s| Part { weight: 0.5, normal: [-s, 0.0, 1.0], base });
    Footprint::new(parts.to_vec()).ok_or_else(|| "a footprint without weight".into())
}

fn errors(footprint: &Footprint) -> [f64; 3] {
    let reference = Reference::new(Family::Ggx, footprint, SAMPLES);
    let moments = footprint.moments();
    let [plain, d] = [Peer::PlainMips, Peer::D].map(|peer| peer.lobe(Family::Ggx, &moments));
    [reference.error(&plain), reference.error(&d), oracle(&reference, &[plain, d]).1]
}

/// Draws the groove's own half-vectors, the lobe of D and the best single lobe, over slopes up to 0.8.
fn draw(folder: &Path) -> Result<(), Box<dyn Error>> {
    let footprint = groove(0.4, 0.1)?;
    let reference = Reference::new(Family::Ggx, &footprint, SAMPLES);
    let d = Peer::D.lobe(Family::Ggx, &footprint.moments());
    let best = oracle(&reference, &[d]).0;
    let truth = footprint.parts().iter().map(|p| (p.weight, Lobe::new(Family::Ggx, p.normal, p.base)));
    let mut canvas = Canvas::new(3, 200);
    let brightest = truth.clone().map(|(weight, lobe)| weight * lobe.density(lobe.normal())).fold(0.0, f64::max);
    for (panel, lobes) in [truth.collect(), vec![(1.0, d)], vec![(1.0, best)]].iter().enumerate() {
        canvas.fill(panel, |[x, y]| {
            let slope = [0.8 * (2.0 * x - 1.0), 0.8 * (1.0 - 2.0 * y)];
            let length = (slope[0] * slope[0] + slope[1] * slope[1] + 1.0).sqrt();
            let h = [-slope[0] / length, -slope[1] / length, 1.0 / length];
            let density: f64 = lobes.iter().map(|(weight, lobe)| weight * lobe.density(h)).sum();
            [(density / brightest).powf(1.0 / 2.2); 3]
        });
    }
    write(folder, "stability-grooves.png", canvas)
}
