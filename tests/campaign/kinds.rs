//! The kinds of surfaces. Each is oriented, closed ones outward, and cuts itself nowhere.

mod balls;
mod cells;
mod plates;
mod round;
mod sheets;

use super::builder::Builder;
use super::random::Random;

/// A kind of surface and its generator.
pub struct Kind {
    pub name: &'static str,
    pub generate: fn(&mut Random) -> Builder,
    /// Whether more than two triangles may meet at an edge.
    pub joined: bool,
}

const fn plain(name: &'static str, generate: fn(&mut Random) -> Builder) -> Kind {
    Kind { name, generate, joined: false }
}

pub const KINDS: [Kind; 34] = [
    plain("open tube", round::open_tube),
    plain("thick tube", round::thick_tube),
    plain("gear", plates::gear),
    plain("flat plate with holes", plates::flat),
    plain("bent plate with holes", plates::bent),
    plain("thick plate with holes", plates::thick),
    plain("profile", plates::profile),
    plain("bosses and pockets", plates::bosses),
    plain("slits", plates::slits),
    plain("long box", plates::long_box),
    plain("blocks", cells::blocks),
    plain("rounded blocks", cells::rounded_blocks),
    Kind { joined: true, ..plain("floor and walls", cells::floor_and_walls) },
    Kind { joined: true, ..plain("book", sheets::book) },
    Kind { joined: true, ..plain("tube with walls", sheets::tube_with_walls) },
    plain("thin shell", sheets::thin_shell),
    plain("height field", sheets::height_field),
    plain("terraces", sheets::terraces),
    plain("ruled strip", sheets::ruled_strip),
    plain("wing", sheets::wing),
    plain("bowl", round::bowl),
    plain("noisy sphere", balls::noisy_sphere),
    plain("spiked ball", balls::spiked_ball),
    plain("needles", round::needles),
    plain("torus", round::torus),
    plain("torus knot", round::torus_knot),
    plain("spring", round::spring),
    plain("cone", round::cone),
    plain("rod", round::rod),
    plain("vase", round::vase),
    plain("rounded box", cells::rounded_box),
    plain("crystal", balls::crystal),
    plain("nested spheres", balls::nested_spheres),
    plain("several parts", several_parts),
];

/// Two to five surfaces of other kinds in a row.
fn several_parts(random: &mut Random) -> Builder {
    let mut all = Builder::default();
    let mut end = 0.0;
    for _ in 0..random.whole(2, 5) {
        let kind = &KINDS[random.whole(0, KINDS.len() - 2)];
        if kind.joined {
            continue;
        }
        let part = (kind.generate)(random);
        let [low, high] = part.bounds();
        let gap = random.scale(0.02, 0.5) * (high - low).length();
        all.add(&part, glam::DVec3::new(end + gap - low.x, -low.y, -low.z));
        end += gap + high.x - low.x;
    }
    if all.triangles.is_empty() { round::torus(random) } else { all }
}
