//! Names of things, and the time.
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::time::{SystemTime, UNIX_EPOCH};

/// Milliseconds since 1970.
pub fn now() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_millis()).unwrap_or(i64::MAX)
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Bytes that nobody can guess.
///
/// # Errors
/// When the system has none.
pub fn random<const N: usize>() -> Result<[u8; N], std::io::Error> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
    Ok(bytes)
}

/// A name for something new: later ones come later in the order of the alphabet, and none can be guessed.
///
/// # Errors
/// As [`random`].
pub fn new_id() -> Result<String, std::io::Error> {
    Ok(format!("{:012x}{}", now(), hex(&random::<10>()?)))
}

/// What contents are known by: SHA-256.
pub fn digest(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Whether a text is a name that [`digest`] gives.
pub fn is_digest(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// Whether a file of a job may have this name: one name, which no shell and no file system takes for something else.
pub fn is_file_name(name: &str) -> bool {
    let is_plain = |b: u8| b.is_ascii_alphanumeric() || b"._-+ ()=,".contains(&b) || b >= 0x80;
    (1..=128).contains(&name.len())
        && name.bytes().all(is_plain)
        && !name.starts_with(['.', '-', ' '])
        && !name.ends_with([' ', '.'])
        && !name.chars().any(char::is_control)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_stay_in_their_folder() {
        for name in ["in.meshb", "wing 2 (new).step", "Flügel.step", "a-b_c+d.sol"] {
            assert!(is_file_name(name), "{name}");
        }
        for name in [
            "",
            ".",
            "..",
            "../a",
            "/etc/passwd",
            "a/b",
            "a\\b",
            ".hidden",
            "-o",
            "a\nb",
            "a\0",
            "a;b",
            "$(a)",
            "a ",
            "a|b",
            "C:a",
        ] {
            assert!(!is_file_name(name), "{name}");
        }
        assert!(!is_file_name(&"a".repeat(129)));
    }

    #[test]
    fn ids_are_in_the_order_of_time() {
        let first = new_id().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(2));
        let second = new_id().unwrap();
        assert!(first < second && first.len() == 32, "{first} {second}");
        assert!(is_digest(&digest(b"")) && !is_digest("e3") && !is_digest(&"G".repeat(64)));
    }
}
