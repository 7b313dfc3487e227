use super::*;
use crate::math::symmetric::Symmetric2;

/// Returns the angle with lambda_1 alone: lambda_1^2 cos2 / (1 - cos2 + lambda_1^2 cos2).
fn isotropic_cos2(cos2: f32, lambda_1: f32) -> f32 {
    let scaled = lambda_1 * lambda_1 * cos2;
    if scaled == 0.0 { f32::from(u8::from(cos2 == 1.0)) } else { scaled / (1.0 - cos2 + scaled) }
}

/// Returns half the integral of |p - q| over slopes, where both are normalised exp(-tan^2 / 2) of their angles and q is
/// the true normal density.
fn distance(k: Symmetric2, cos2_of: impl Fn(f32, [f32; 2]) -> f32) -> f64 {
    let n = 400;
    let reach = 6.0 * k.eigen().major.sqrt();
    let at = |i: i32| reach * (2.0 * (i as f32 + 0.5) / n as f32 - 1.0);
    let (mut p, mut q) = (Vec::new(), Vec::new());
    for i in 0..n {
        for j in 0..n {
            let s = [at(i), at(j)];
            let cos2 = 1.0 / (1.0 + s[0] * s[0] + s[1] * s[1]);
            let modified = f64::from(cos2_of(cos2, s.map(|x| x * cos2.sqrt())));
            p.push((-0.5 * (1.0 / modified - 1.0)).exp());
            let inverse = k.vv * s[0] * s[0] - 2.0 * k.uv * s[0] * s[1] + k.uu * s[1] * s[1];
            q.push((-0.5 * f64::from(inverse / k.determinant())).exp());
        }
    }
    let (sum_p, sum_q) = (p.iter().sum::<f64>(), q.iter().sum::<f64>());
    0.5 * p.iter().zip(&q).map(|(p, q)| (p / sum_p - q / sum_q).abs()).sum::<f64>()
}

/// The paper's erratum 3: the printed |d|^4/|Dd|^2 is right for isotropic lobes only. At an axis ratio of 10, the
/// printed form is hardly better than lambda_1 alone. The radius of the ellipse itself is exact.
#[test]
fn erratum_3_the_printed_angle_is_wrong_unless_isotropic() {
    // D is triangular, so the printed form depends on the direction too.
    let cases = [(1.0, 0.0..0.001), (2.0, 0.10..0.17), (5.0, 0.43..0.59), (10.0, 0.65..0.81)];
    for ((ratio, printed_range), direction) in
        cases.iter().flat_map(|c| [[1.0, 0.0], [0.8, 0.6], [0.0, 1.0]].map(|d| (c.clone(), d)))
    {
        let k = Symmetric2::from_axes(0.01 * ratio * ratio, 0.01, direction);
        let factor = Factor::of(k);
        let elliptical = distance(k, |cos2, d| elliptical_cos2(cos2, d, factor));
        let printed = distance(k, |cos2, d| printed_cos2(cos2, d, factor));
        let isotropic = distance(k, |cos2, _| isotropic_cos2(cos2, crate::lobe::factor::lambda_1(k)));
        assert!(elliptical < 1e-3, "{ratio}: {elliptical}");
        assert!(printed_range.contains(&printed), "{ratio} {direction:?}: {printed}");
        if ratio == 10.0 {
            assert!((0.75..0.85).contains(&isotropic), "{isotropic}");
        }
    }
}

#[test]
fn all_forms_agree_on_isotropic_lobes() {
    let factor = Factor { d1: 0.3, d2: 0.0, d3: 0.3 };
    let (cos2, d) = (0.84, [0.24, 0.32]);
    let expected = isotropic_cos2(cos2, 0.3);
    assert!((elliptical_cos2(cos2, d, factor) - expected).abs() < 1e-6);
    assert!((printed_cos2(cos2, d, factor) - expected).abs() < 1e-6);
}

#[test]
fn singular_factors_have_an_angle() {
    let line = Factor { d1: 0.3, d2: 0.0, d3: 0.0 };
    assert!(elliptical_cos2(0.99, [0.1, 0.0], line) > 0.0);
    assert_eq!(elliptical_cos2(0.99, [0.0, 0.1], line), 0.0);
    assert_eq!(elliptical_cos2(1.0, [0.0, 0.0], Factor::default()), 1.0);
    assert_eq!(isotropic_cos2(0.5, 0.0), 0.0);
}
