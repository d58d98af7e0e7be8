//! Amounts of memory on the command line.

/// An amount of memory, in bytes.
///
/// # Errors
/// What is wrong with it.
pub fn bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let number: f64 = digits.trim().parse().map_err(|_| "not an amount like 4GiB or 500MB".to_owned())?;
    let factor = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        "tib" => 1024.0 * 1024.0 * 1024.0 * 1024.0,
        unit => return Err(format!("{unit} is no unit of memory: KiB, MiB, GiB, TiB, KB, MB, GB or TB")),
    };
    let bytes = number * factor;
    if bytes >= 1e6 && bytes.is_finite() { Ok(bytes as u64) } else { Err("at least a megabyte, as in 4GiB".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_a_thousand_and_of_1024() {
        let amounts = ["4GiB", "500MB", "1.5 gb", "2000000", "1024kib"].map(|text| bytes(text).unwrap());
        assert_eq!(amounts, [4 << 30, 500_000_000, 1_500_000_000, 2_000_000, 1 << 20]);
        for wrong in ["", "GiB", "4 stones", "-1GB", "nan", "10KB", "1e999TB"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
