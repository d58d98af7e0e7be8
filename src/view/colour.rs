//! Colours: maps from numbers, and a palette for references. sRGB, each part from 0 to 1.

/// A colour.
pub type Rgb = [f32; 3];

/// From the worst shape to the best: red, yellow, blue. People who cannot tell red from green see the bad ones too.
pub const QUALITY: [Rgb; 6] = [
    [0.545, 0.035, 0.137],
    [0.867, 0.278, 0.200],
    [0.976, 0.627, 0.357],
    [0.980, 0.894, 0.627],
    [0.573, 0.765, 0.851],
    [0.216, 0.420, 0.678],
];

/// From the least value to the greatest, ever lighter.
pub const FIELD: [Rgb; 6] = [
    [0.176, 0.071, 0.341],
    [0.212, 0.290, 0.600],
    [0.133, 0.514, 0.608],
    [0.200, 0.702, 0.482],
    [0.620, 0.835, 0.290],
    [0.988, 0.914, 0.310],
];

/// Where there is no value.
pub const NOTHING: Rgb = [0.74, 0.75, 0.77];

/// The colour of t in [0, 1] between evenly spaced stops.
pub fn between(stops: &[Rgb], t: f32) -> Rgb {
    let place = t.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let low = (place as usize).min(stops.len() - 2);
    let share = place - low as f32;
    std::array::from_fn(|i| stops[low][i] + share * (stops[low + 1][i] - stops[low][i]))
}

/// The colour of a surface, by its place in the order of references: neighbours in the order are far apart in hue.
pub fn of_surface(index: usize) -> Rgb {
    let lightness = [0.76, 0.68, 0.83][index % 3];
    oklch(lightness, 0.105, 4.2 + 2.399_963 * index as f32)
}

/// The colour of a region.
pub fn of_region(index: usize) -> Rgb {
    oklch([0.80, 0.72, 0.87][index % 3], 0.075, 1.45 + 2.399_963 * index as f32)
}

/// Of lightness, chroma and hue (radians) by Ottosson's OKLab (bottosson.github.io/posts/oklab), kept within sRGB.
fn oklch(lightness: f32, chroma: f32, hue: f32) -> Rgb {
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    let linear = [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ];
    linear.map(|x| if x <= 0.003_130_8 { 12.92 * x.max(0.0) } else { (1.055 * x.powf(1.0 / 2.4) - 0.055).min(1.0) })
}

/// Reads #rrggbb.
pub fn parse(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let part = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok().map(|x| f32::from(x) / 255.0);
    Some([part(0)?, part(2)?, part(4)?])
}

/// Writes #rrggbb.
pub fn hexadecimal(colour: Rgb) -> String {
    let [r, g, b] = bytes(colour);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// As bytes.
pub fn bytes(colour: Rgb) -> [u8; 3] {
    colour.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_meet_their_stops() {
        assert_eq!(between(&FIELD, 0.0), FIELD[0]);
        assert_eq!(between(&FIELD, 2.0), FIELD[5]);
        let half = between(&[[0.0; 3], [1.0, 0.5, 0.0]], 0.5);
        assert_eq!(half, [0.5, 0.25, 0.0]);
    }

    #[test]
    fn a_colour_is_read_as_it_is_written() {
        assert_eq!(hexadecimal(parse("#01a0ff").unwrap()), "#01a0ff");
        for wrong in ["01a0ff", "#01a0f", "#01a0fg", "#äöü"] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn twelve_references_can_be_told_apart() {
        let far = |a: Rgb, b: Rgb| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt();
        for i in 0..12 {
            for j in 0..i {
                assert!(far(of_surface(i), of_surface(j)) > 0.04, "{i} {j}");
            }
        }
    }
}
