//! Numbers in texts.

/// A token as an error shows it.
pub fn shown(token: &[u8]) -> String {
    let text = String::from_utf8_lossy(&token[..token.len().min(40)]);
    format!("'{}'", text.escape_debug())
}

/// A whole number.
///
/// # Errors
/// When the token is none, or does not fit.
pub fn parse_int(token: &[u8]) -> Result<i64, String> {
    let (negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, token),
    };
    let mut value = Some(0_i64).filter(|_| !digits.is_empty());
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        value = value.filter(|_| digit < 10).and_then(|v| v.checked_mul(10)?.checked_add(digit.into()));
    }
    match value {
        Some(value) => Ok(if negative { -value } else { value }),
        None => Err(format!("a whole number is expected, not {}", shown(token))),
    }
}

/// A finite number; Fortran's 1.0D+00 too.
///
/// # Errors
/// When the token is none.
pub fn parse_real(token: &[u8]) -> Result<f64, String> {
    let parse = |text: &str| text.parse::<f64>().ok();
    let text = std::str::from_utf8(token).unwrap_or("");
    // Fortran writes 1.0D+00
    match parse(text).or_else(|| parse(&text.replace(['d', 'D'], "e"))) {
        Some(value) if value.is_finite() => Ok(value),
        _ => Err(format!("a finite number is expected, not {}", shown(token))),
    }
}
