//! Amounts of memory on the command line.

/// An amount of memory, in bytes.
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
    use super::bytes;

    #[test]
    fn amounts_have_units() {
        assert_eq!(bytes("4GiB"), Ok(4 << 30));
        assert_eq!(bytes("1.5 GB"), Ok(1_500_000_000));
        assert_eq!(bytes("2000000"), Ok(2_000_000));
        assert_eq!(bytes("500mb"), Ok(500_000_000));
        for wrong in ["", "GiB", "4 GiBs", "-1GB", "nan GB", "12", "1e400GB"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
