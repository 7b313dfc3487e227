//! Costs as people read them.

use super::Axis;

/// Writes a cost with its unit: `1.4 MB`, `0.31 s`, `1,730`.
pub fn amount(axis: Axis, value: f64) -> String {
    match axis {
        Axis::GpuBytes | Axis::FileBytes => bytes(value),
        Axis::BakeSeconds => seconds(value),
        Axis::Fetches | Axis::Operations => grouped(value),
    }
}

/// Writes bytes in decimal units, with two significant digits.
fn bytes(n: f64) -> String {
    let (value, unit) = match n {
        _ if n >= 999.5e6 => (n / 1e9, "GB"),
        _ if n >= 999.5e3 => (n / 1e6, "MB"),
        _ if n >= 999.5 => (n / 1e3, "kB"),
        _ => return format!("{n:.0} B"),
    };
    if value < 9.95 && value.fract() != 0.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

fn seconds(n: f64) -> String {
    match n {
        _ if n < 0.0995 => format!("{:.0} ms", 1e3 * n),
        _ if n < 9.95 => format!("{n:.1} s"),
        _ => format!("{n:.0} s"),
    }
}

/// Writes an integer with commas between thousands.
fn grouped(n: f64) -> String {
    let digits = format!("{n:.0}");
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_have_the_units_that_people_read() {
        let texts = [0.0, 999.0, 999.6, 65_536.0, 1_400_000.0, 12_345_678.0, 999_999_999.0, 2e9];
        let wanted = ["0 B", "999 B", "1.0 kB", "66 kB", "1.4 MB", "12 MB", "1.0 GB", "2 GB"];
        assert_eq!(texts.map(|n| amount(Axis::GpuBytes, n)), wanted);
        assert_eq!([0.004, 0.31, 12.34].map(|n| amount(Axis::BakeSeconds, n)), ["4 ms", "0.3 s", "12 s"]);
        assert_eq!([3.0, 950.0, 1730.0, 1e6].map(|n| amount(Axis::Operations, n)), ["3", "950", "1,730", "1,000,000"]);
    }
}
