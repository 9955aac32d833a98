//! What a request for a mesh says.

use quadmosaic::field::{GuideFileError, parse_guides};
use quadmosaic::options::{NAMES, OptionError};
use quadmosaic::pipeline::{Contradiction, Options};
use quadmosaic::sizes::{SizeFileError, parse_sizes};
use serde::Deserialize;
use std::collections::BTreeMap;
use thiserror::Error;

/// The names of what was drawn in errors: those of the files that the page saves.
const GUIDES: &str = "guides.json";
const SIZES: &str = "sizes.csv";

/// Why a request for a mesh is refused.
#[derive(Debug, Error)]
pub enum OrderError {
    #[error("the request is no JSON of options, guides and sizes: {0}")]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error(transparent)]
    Guides(#[from] GuideFileError),
    #[error(transparent)]
    Sizes(#[from] SizeFileError),
    #[error(transparent)]
    Contradiction(#[from] Contradiction),
    #[error("the limits of memory and time are those that the server was started with; a request cannot change them")]
    Limits,
}

/// The body of a request for a mesh.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Order {
    /// Options by name, with values as the command line has them.
    options: BTreeMap<String, String>,
    /// The text of a file of guides.
    guides: Option<String>,
    /// The text of a file of sizes.
    sizes: Option<String>,
}

/// The options of a request: those that the server was started with, and what the request changes in them. Its guides come after
/// theirs, and its sizes take the place of theirs.
///
/// # Errors
/// Where the request is none, or an option, a guide or a size of it is refused.
pub fn options(body: &[u8], base: &Options) -> Result<Options, OrderError> {
    let order: Order = serde_json::from_slice(body)?;
    let mut options = base.clone();
    // The library's order: what a preset or a layout sets, single options override.
    let rank = |name: &str| NAMES.iter().position(|known| *known == name);
    let mut given: Vec<(&String, &String)> = order.options.iter().collect();
    given.sort_by_key(|(name, _)| rank(name));
    for (name, value) in given {
        options.set(name, value)?;
    }
    if options.limits != base.limits {
        return Err(OrderError::Limits);
    }
    if let Some(guides) = &order.guides {
        options.field.guides.extend(parse_guides(guides, GUIDES)?);
    }
    if let Some(sizes) = &order.sizes {
        options.sizes.samples = parse_sizes(sizes.as_bytes(), SIZES)?;
    }
    Contradiction::expect_none(&options)?;
    Ok(options)
}

#[cfg(test)]
mod tests {
    use super::*;
    use quadmosaic::pipeline::{Fineness, Layout};

    fn asked(body: &str) -> Result<Options, OrderError> {
        options(body.as_bytes(), &Options::new(Fineness::Points(100)))
    }

    #[test]
    fn a_layout_is_set_before_what_overrides_it() {
        let set = asked(r#"{"options": {"fit": "0.5", "layout": "even", "points": "200"}}"#);
        let set = set.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((set.layout, set.fit), (Layout::Even, 0.5));
        assert!(matches!(set.fineness, Fineness::Points(200)));
    }

    #[test]
    fn guides_are_added_and_sizes_replaced() {
        let body = r#"{"guides": "0,0,0,1,0,0", "sizes": "0,0,0,2\n1,0,0,1"}"#;
        let base = asked(body).unwrap_or_else(|error| panic!("{error}"));
        let again = options(body.as_bytes(), &base).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((again.field.guides.len(), again.sizes.samples.len()), (2, 2));
    }

    #[test]
    fn what_is_wrong_is_told() {
        for (body, part) in [
            ("{\"options\": ", "no JSON of options, guides and sizes: EOF while parsing"),
            (r#"{"option": {}}"#, "unknown field `option`"),
            (r#"{"options": {"point": "5"}}"#, "there is no option point"),
            (r#"{"options": {"points": "3"}}"#, "ask for 4 to 50000000 vertices"),
            (r#"{"options": {"max_memory": "9G"}}"#, "the limits of memory and time are those that the server"),
            (r#"{"guides": "{\"strokes\": ["}"#, "guides.json: EOF while parsing"),
            (r#"{"guides": "0,0,0"}"#, "guides.json, line 1: a guide has 6 to 8 numbers"),
            (r#"{"sizes": "0,0,0,-1"}"#, "sizes.csv, line 1: the size -1 is not above 0"),
            (r#"{"options": {"layout": "quads", "quads": "paper"}}"#, "the layout quads has no triangles"),
        ] {
            let told = asked(body).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(told.contains(part), "{body}: {told}");
        }
    }
}
