//! Letters as strokes, so that text is as fine as the picture: our own drawing on a grid, 4 wide and 6 high.

/// Height of a capital letter in units of the grid.
const CAPITAL: f64 = 6.0;

/// The line that letters stand on, counted from the lowest one.
const BASE: f64 = 2.0;

/// Space between letters.
const GAP: f64 = 1.7;

/// Strokes of a letter, parted by |: points, each two digits, x from the left and y up (2 is the base, 8 the height of a capital).
/// A stroke of one point is a dot.
fn strokes(letter: char) -> &'static str {
    match letter {
        'A' => "02 28 42|14 34",
        'B' => "02 08 38 47 46 35 44 43 32 02|05 35",
        'C' => "47 38 18 07 03 12 32 43",
        'D' => "02 08 28 46 44 22 02",
        'E' => "42 02 08 48|05 35",
        'F' => "02 08 48|05 35",
        'G' => "47 38 18 07 03 12 32 43 45 25",
        'H' => "02 08|42 48|05 45",
        'I' => "02 08",
        'J' => "38 33 22 12 03",
        'K' => "02 08|48 05 42",
        'L' => "08 02 42",
        'M' => "02 08 25 48 42",
        'N' => "02 08 42 48",
        'O' => "12 03 07 18 38 47 43 32 12",
        'P' => "02 08 38 47 46 35 05",
        'Q' => "12 03 07 18 38 47 43 32 12|24 42",
        'R' => "02 08 38 47 46 35 05|25 42",
        'S' => "47 38 18 07 06 15 35 44 43 32 12 03",
        'T' => "08 48|28 22",
        'U' => "08 03 12 32 43 48",
        'V' => "08 22 48",
        'W' => "08 12 26 32 48",
        'X' => "02 48|08 42",
        'Y' => "08 25 48|25 22",
        'Z' => "08 48 02 42",
        'a' => "05 16 26 35 32|34 14 03 12 22 33",
        'b' => "08 02|05 16 26 35 33 22 12 03",
        'c' => "35 26 16 05 03 12 22 33",
        'd' => "38 32|35 26 16 05 03 12 22 33",
        'e' => "04 34 35 26 16 05 03 12 22 33",
        'f' => "28 17 12|06 26",
        'g' => "36 31 20 10 01|35 26 16 05 03 12 22 33",
        'h' => "08 02|05 16 26 35 32",
        'i' => "02 06|08",
        'j' => "16 11 00|18",
        'k' => "08 02|36 04 32",
        'l' => "08 02",
        'm' => "02 06|05 16 25 22|25 36 45 42",
        'n' => "02 06|05 16 26 35 32",
        'o' => "12 03 05 16 26 35 33 22 12",
        'p' => "00 06|05 16 26 35 33 22 12 03",
        'q' => "30 36|35 26 16 05 03 12 22 33",
        'r' => "02 06|05 16 26",
        's' => "35 26 16 05 14 24 33 22 12 03",
        't' => "18 13 22|06 26",
        'u' => "06 03 12 22 33|36 32",
        'v' => "06 22 46",
        'w' => "06 12 25 32 46",
        'x' => "02 36|06 32",
        'y' => "06 22|46 10 00",
        'z' => "06 36 02 32",
        '0' => "12 03 07 18 28 37 33 22 12",
        '1' => "07 18 12",
        '2' => "07 18 28 37 36 02 32",
        '3' => "07 18 28 37 36 25 34 33 22 12 03|15 25",
        '4' => "22 28 04 34",
        '5' => "38 08 05 25 34 33 22 12 03",
        '6' => "37 28 18 07 03 12 22 33 34 25 15 04",
        '7' => "08 38 12",
        '8' => "15 06 07 18 28 37 36 25 15 04 03 12 22 33 34 25",
        '9' => "03 12 22 33 37 28 18 07 06 15 25 36",
        '.' => "02",
        ',' => "12 01",
        ':' => "02|05",
        ';' => "12 01|15",
        '-' | '–' => "05 25",
        '−' => "05 35",
        '+' => "05 45|23 27",
        '=' => "04 34|06 36",
        '/' => "01 38",
        '\\' => "08 31",
        '_' => "01 41",
        '(' => "19 07 03 11",
        ')' => "09 17 13 01",
        '[' => "19 09 01 11",
        ']' => "09 19 11 01",
        '{' => "29 18 16 05 14 12 21",
        '}' => "09 18 16 25 14 12 01",
        '%' => "02 48|08|42",
        '<' => "37 05 33",
        '>' => "07 35 03",
        '|' => "09 01",
        '*' => "17 13|06 24|04 26",
        '#' => "12 18|32 38|04 44|06 46",
        '\'' => "08 06",
        '"' => "08 06|28 26",
        '!' => "08 04|02",
        '?' => "07 18 28 37 36 25 24|22",
        '~' => "05 16 25 36",
        '^' => "06 18 26",
        '°' => "07 18 27 16 07",
        '×' => "03 36|06 33",
        '≤' => "37 05 33|02 32",
        '≥' => "07 35 03|02 32",
        '√' => "04 12 38 48",
        '·' => "05",
        '&' => "42 07 18 27 04 03 12 22 44",
        '@' => "33 35 25 24 33 44 46 38 18 07 03 12 32",
        // A box for all others.
        _ => "02 08 38 32 02",
    }
}

/// A line between two points, of text or of a picture, pixels from the left and the top.
pub type Segment = [[f64; 2]; 2];

/// The segments of a text whose letters stand on y and begin at x, capitals of a height in pixels; and where the next letter would begin.
pub fn lay_out(text: &str, [x, y]: [f64; 2], height: f64) -> (Vec<Segment>, f64) {
    let unit = height / CAPITAL;
    let (mut at, mut segments) = (x, Vec::new());
    for letter in text.chars() {
        if letter.is_whitespace() {
            at += 3.2 * unit;
            continue;
        }
        let mut right: f64 = 0.0;
        for stroke in strokes(letter).split('|') {
            let points: Vec<[f64; 2]> = stroke
                .split(' ')
                .map(|point| {
                    let [column, row] = [0, 1].map(|i| f64::from(point.as_bytes()[i] - b'0'));
                    right = right.max(column);
                    [at + column * unit, y - (row - BASE) * unit]
                })
                .collect();
            segments.extend(points.windows(2).map(|ends| [ends[0], ends[1]]));
            if let [dot] = points[..] {
                segments.push([dot, dot]);
            }
        }
        at += (right + GAP) * unit;
    }
    (segments, at)
}

/// How wide a text is, pixels.
pub fn width(text: &str, height: f64) -> f64 {
    lay_out(text, [0.0; 2], height).1 - GAP * height / CAPITAL
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_has_its_own_strokes() {
        let letters: Vec<char> = ('!'..='~').filter(|c| !"$`".contains(*c)).chain("°×≤≥√·".chars()).collect();
        for (i, &letter) in letters.iter().enumerate() {
            assert_ne!(strokes(letter), strokes('\u{1}'), "{letter}");
            assert!(letters[..i].iter().all(|&other| strokes(other) != strokes(letter)), "{letter}");
            let (segments, end) = lay_out(&letter.to_string(), [0.0, 0.0], 6.0);
            assert!(!segments.is_empty() && end <= 6.0, "{letter}");
            assert!(segments.iter().flatten().all(|p| (-7.0..=2.0).contains(&p[1])), "{letter}");
        }
    }

    #[test]
    fn text_goes_to_the_right() {
        assert!((width("II", 6.0) - 1.7).abs() < 1e-12);
        assert!(width("a b", 12.0) > width("ab", 12.0));
    }
}
