//! The text of a page: its template, filled.

use super::Data;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// The parts of the script, each after those that it uses.
const SCRIPT: [&str; 12] = [
    include_str!("decode.js"),
    include_str!("camera.js"),
    include_str!("shaders.js"),
    include_str!("layers.js"),
    include_str!("pick.js"),
    include_str!("nearest.js"),
    include_str!("draw.js"),
    include_str!("scene.js"),
    include_str!("panel.js"),
    include_str!("page.js"),
    include_str!("input.js"),
    include_str!("start.js"),
];

/// What a page has that asks its server for meshes.
const FORM: &str = include_str!("serve.html");
const FORM_SCRIPT: &str = include_str!("serve.js");

/// The JSON of a page's data, which may stand in an element.
pub(super) fn json(data: &Data) -> String {
    // A `<` could end the element; JSON has it in strings alone.
    serde_json::to_string(data).expect("numbers and text are JSON").replace('<', "\\u003c")
}

/// A page that holds its data, its style and its script; one that is served also asks its server for meshes.
pub(super) fn html(title: &str, json: &str, is_served: bool) -> String {
    let served = |text: &'static str| if is_served { text } else { "" };
    filled(TEMPLATE, |name| match name {
        "title" => escaped(title),
        "connect" => served("; connect-src 'self'").to_owned(),
        "style" => STYLE.to_owned(),
        "serve" => served(FORM).to_owned(),
        "data" => json.to_owned(),
        "script" => SCRIPT.concat() + served(FORM_SCRIPT),
        _ => String::new(),
    })
}

/// A template with a text in the place of each name in double braces.
fn filled(template: &str, text: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or((part, ""));
        whole.push_str(&text(name));
        whole.push_str(rest);
    }
    whole
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let text = |name: &str| if name == "a" { "{{b}}".to_owned() } else { format!("<{name}>") };
        assert_eq!(filled("x {{a}} y {{b}}z", text), "x {{b}} y <b>z");
    }

    #[test]
    fn the_template_has_each_place_once() {
        let names = ["title", "connect", "style", "serve", "data", "script"];
        for name in names {
            assert_eq!(TEMPLATE.matches(&format!("{{{{{name}}}}}")).count(), 1, "{name}");
        }
        assert_eq!(TEMPLATE.matches("{{").count(), names.len());
    }
}
