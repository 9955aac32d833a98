//! Names of regions as identifiers.

use rustc_hash::FxHashSet;

/// The name of a region without one.
const UNNAMED: &str = "surface";

/// A name, or the one of a region without a name.
pub(super) fn or_unnamed(name: &str) -> &str {
    if name.is_empty() { UNNAMED } else { name }
}

/// The names as identifiers of at most `longest` characters: a letter, then letters, digits, `-` and `_`. Other characters become
/// `_`, a nameless region is `surface`, and equal names (whatever their case) get numbers.
pub(super) fn identifiers<'a>(names: impl Iterator<Item = &'a str>, longest: usize) -> Vec<String> {
    let mut taken = FxHashSet::default();
    names
        .map(|name| {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
            let plain: String = or_unnamed(name).chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
            let starts_well = plain.starts_with(|c: char| c.is_ascii_alphabetic());
            let plain = if starts_well { plain } else { format!("r{plain}") };
            let numbered = |number: usize| match number {
                1 => plain.chars().take(longest).collect(),
                _ => {
                    let suffix = format!("_{number}");
                    plain.chars().take(longest - suffix.len()).chain(suffix.chars()).collect::<String>()
                }
            };
            let free = (1..).map(numbered).find(|name| taken.insert(name.to_ascii_uppercase()));
            free.expect("there are more numbers than names")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_differ() {
        let names = ["wing tip", "wing_tip", "", "WING_TIP", "2nd", "flügel", "surface"];
        let expected = ["wing_tip", "wing_tip_2", "surface", "WING_TIP_3", "r2nd", "fl_gel", "surface_2"];
        assert_eq!(identifiers(names.into_iter(), 80), expected);
        assert_eq!(identifiers(["abcdef", "abcdxyz"].into_iter(), 4), ["abcd", "ab_2"]);
    }
}
