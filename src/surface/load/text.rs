//! Words and numbers of text formats.

use super::Fault;
use std::borrow::Cow;

/// A text whose lines end with carriage returns alone, with line feeds instead; anything else as it is.
pub fn with_line_feeds(bytes: &[u8]) -> Cow<'_, [u8]> {
    if bytes.contains(&b'\n') || !bytes.contains(&b'\r') || bytes.contains(&0) {
        return Cow::Borrowed(bytes);
    }
    bytes.iter().map(|&byte| if byte == b'\r' { b'\n' } else { byte }).collect()
}

/// The lines of a text that say something, up to a `#`, without outer blanks, each with its number, counted from 1.
pub fn content_lines(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let lines = (1..).zip(text.split(|&byte| byte == b'\n').map(content));
    lines.filter(|(_, line)| !line.is_empty())
}

/// A line up to a `#`, without outer blanks.
pub fn content(line: &[u8]) -> &[u8] {
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    line[..end].trim_ascii()
}

/// What is between the blanks of a line.
pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number; it may be infinite or NaN.
pub fn number(word: &[u8]) -> Result<f64, Fault> {
    parsed(word).ok_or_else(|| Fault::NotANumber { word: shown(word) })
}

/// The coordinates of a vertex, of which there must be at least three.
pub fn coordinates<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<[f64; 3], Fault> {
    let mut point = [0.0; 3];
    for (count, coordinate) in point.iter_mut().enumerate() {
        let word = words.next().ok_or(Fault::TooFewCoordinates { count })?;
        *coordinate = number(word)?;
    }
    Ok(point)
}

/// A word of ASCII as whatever it can be read as.
pub fn parsed<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as an error message can show it: shortened.
pub fn shown(word: &[u8]) -> String {
    const MOST: usize = 32;
    // A character has at most four bytes.
    let mut short: String = String::from_utf8_lossy(&word[..word.len().min(4 * MOST)]).chars().take(MOST).collect();
    if short.len() < word.len() {
        short.push_str("...");
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_texts_without_line_feeds_get_them() {
        assert_eq!(with_line_feeds(b"a\rb\r\rc").as_ref(), b"a\nb\n\nc");
        for kept in [&b"a\r\nb\r"[..], b"a\nb\rc", b"a\rb\0", b"ab", b""] {
            assert!(matches!(with_line_feeds(kept), Cow::Borrowed(same) if same == kept));
        }
    }

    #[test]
    fn lines_that_say_nothing_are_left_out() {
        let lines: Vec<_> = content_lines(b"# head\n a b # c\n\n \t\r\nd").collect();
        assert_eq!(lines, [(2, &b"a b"[..]), (5, b"d")]);
    }
}
