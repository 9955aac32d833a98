//! Numbers in files: decimals in text, bytes in binary.

use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::ops::Range;

/// The number of lines that are in memory at the same time.
const LINES_AT_ONCE: usize = 1 << 16;
/// The number of lines that one thread makes.
const LINES_A_PIECE: usize = 1 << 12;
/// The number of bytes that are collected.
const BYTES_AT_ONCE: usize = 1 << 16;

/// Writes the texts of some items in their order; threads share the work, as digits take most of the time.
pub(super) fn write_lines(
    writer: &mut dyn Write,
    items: Range<usize>,
    line: impl Fn(&mut String, usize) + Sync,
) -> io::Result<()> {
    for start in items.clone().step_by(LINES_AT_ONCE) {
        let end = items.end.min(start + LINES_AT_ONCE);
        let piece = |first: usize| {
            let mut text = String::new();
            (first..end.min(first + LINES_A_PIECE)).for_each(|item| line(&mut text, item));
            text
        };
        let firsts: Vec<usize> = (start..end).step_by(LINES_A_PIECE).collect();
        let pieces: Vec<String> = firsts.into_par_iter().map(piece).collect();
        pieces.iter().try_for_each(|text| writer.write_all(text.as_bytes()))?;
    }
    Ok(())
}

/// Writes numbers that are given as their bytes.
pub(super) fn write_bytes<const N: usize>(
    writer: &mut dyn Write,
    numbers: impl IntoIterator<Item = [u8; N]>,
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(BYTES_AT_ONCE + N);
    for number in numbers {
        bytes.extend_from_slice(&number);
        if bytes.len() >= BYTES_AT_ONCE {
            writer.write_all(&bytes)?;
            bytes.clear();
        }
    }
    writer.write_all(&bytes)
}

/// Appends numbers, each after a separator, in the shortest decimals that read back as the same f64.
pub(super) fn push_point(text: &mut String, separator: &str, point: &[f64]) {
    for x in point {
        push(text, format_args!("{separator}{x:?}"));
    }
}

/// Appends vertex numbers, each after a separator, counted from `first`.
pub(super) fn push_face(text: &mut String, separator: &str, face: &[u32], first: u32) {
    for vertex in face {
        push(text, format_args!("{separator}{}", vertex + first));
    }
}

/// Appends formatted text.
pub(super) fn push(text: &mut String, arguments: std::fmt::Arguments) {
    text.write_fmt(arguments).expect("a string takes all");
}

/// The nearest decimal number of at most `width` characters, at least 10, with a decimal point.
pub(super) fn within(width: usize, x: f64) -> String {
    let shortest = format!("{x:?}");
    let shortest = match shortest.split_once('e') {
        Some((digits, exponent)) if digits.contains('.') => format!("{digits}E{exponent}"),
        Some((digits, exponent)) => format!("{digits}.0E{exponent}"),
        None => shortest,
    };
    if shortest.len() <= width {
        return shortest;
    }
    // The digits behind the point that there is room for, in either notation, and the power of ten of the last one.
    let whole = format!("{:.0}", x.trunc()).len();
    let power = x.abs().log10().floor() as i32;
    let fixed = width.checked_sub(whole + 1).filter(|&digits| digits > 0).map(|digits| (-(digits as i32), digits));
    let besides = usize::from(x < 0.0) + "0.".len() + format!("E{power}").len();
    let scientific = width - besides;
    match fixed {
        Some((last, digits)) if last <= power - scientific as i32 => format!("{x:.digits$}"),
        _ => {
            // Rounding up may lengthen the exponent.
            let text = format!("{x:.scientific$E}");
            if text.len() <= width { text } else { format!("{x:.*E}", scientific - 1) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_and_lose_no_more_than_they_must() {
        for (x, expected) in [
            (0.0, "0.0"),
            (1e-7, "1.0E-7"),
            (0.1, "0.1"),
            (1.0 / 3.0, "0.33333333333333"),
            (-1.0 / 3.0, "-0.3333333333333"),
            (-1e-9 / 3.0, "-3.333333333E-10"),
            (1e22 / 3.0, "3.3333333333E+21"),
            (-123_456.789_012_345_67, "-123456.78901235"),
            (2e300, "2.0E300"),
        ] {
            let text = within(16, x);
            let close = (text.parse::<f64>().expect("a number") - x).abs() <= 1e-9 * x.abs();
            assert!(text.len() <= 16 && text.contains('.') && close, "{text}");
            if !expected.contains("E+") {
                assert_eq!(text, expected);
            }
        }
        for k in 0..2000_i32 {
            let x = (f64::from(k) * 0.7).sin() * 10f64.powi(k % 40 - 20);
            let found: f64 = within(20, x).parse().expect("a number");
            assert!((found - x).abs() <= 1e-13 * x.abs(), "{x} {found}");
        }
    }

    #[test]
    fn lines_are_in_order() {
        let mut bytes = Vec::new();
        write_lines(&mut bytes, 3..200_000, |text, item| push(text, format_args!("{item}\n"))).expect("a vector");
        let text = String::from_utf8(bytes).expect("text");
        assert!(text.lines().map(|line| line.parse::<usize>().expect("a number")).eq(3..200_000));
    }
}
