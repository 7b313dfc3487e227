use super::*;

#[test]
fn reasons_follow_the_evidence() {
    let all = Evidence { unencoded: 0.3, unclamped: 0.3, anisotropic: None, oracle: 0.2, two_peaked: 0.0, steep: 0.0 };
    let cases = [
        (Evidence { unencoded: 0.05, ..all }, Reason::Encoding),
        (Evidence { unclamped: 0.05, ..all }, Reason::AlphaAboveOne),
        (Evidence { anisotropic: Some(0.05), oracle: 0.05, ..all }, Reason::Isotropic),
        (Evidence { oracle: 0.05, two_peaked: 1.0, ..all }, Reason::Fit),
        (Evidence { two_peaked: 0.8, ..all }, Reason::TwoPeaked),
        (Evidence { two_peaked: 0.8, steep: 0.4, ..all }, Reason::Steep),
        (all, Reason::NoSingleLobe),
    ];
    for (evidence, reason) in cases {
        assert_eq!(evidence.reason(0.1), reason, "{evidence:?}");
    }
}
