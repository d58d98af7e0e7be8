//! The history of convergence: a table with names in quotes, padded with spaces.
use std::collections::BTreeMap;
use std::path::Path;

/// By how many orders of magnitude the first residual, that of the density, may grow beyond that of the first iteration. From the free stream it
/// grows by one or so (NACA 0012, Spalart and Allmaras).
const GROWN: f64 = 4.0;

/// The table, as far as it is looked at.
struct Table {
    /// Names of the columns.
    head: Vec<String>,
    /// The first row and the last; empty where there is none.
    first: Vec<String>,
    last: Vec<String>,
    /// Rows, without the head.
    rows: u64,
}

impl Table {
    fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let clean = |word: &str| word.trim().trim_matches('"').trim().to_owned();
        let words = |line: &str| line.split(',').map(clean).collect();
        // SU2 may be at work: a line without its end is not a row yet.
        let whole = &text[..text.rfind('\n').map_or(0, |at| at + 1)];
        let mut lines = whole.lines().filter(|line| !line.trim().is_empty());
        let head = lines.next().map_or_else(Vec::new, words);
        let first = lines.next();
        let (rows, last) = lines.fold((u64::from(first.is_some()), first), |(rows, _), line| (rows + 1, Some(line)));
        let [first, last] = [first, last].map(|row| row.map_or_else(Vec::new, words));
        Ok(Self { head, first, last, rows })
    }
}

/// Rows of the table, without its head.
pub fn rows(path: &Path) -> u64 {
    Table::read(path).map_or(0, |table| table.rows)
}

/// Refuses a table whose residuals end in what is no number, or have grown by [`GROWN`] orders of magnitude: SU2 itself goes on to the end then. Other
/// columns may: SU2 divides by what is 0.
///
/// # Errors
/// What is wrong, or that it is not there.
pub fn check(path: &Path) -> Result<(), String> {
    let Table { head, first, last, .. } = Table::read(path)?;
    let diverged = |what: &str| Err(format!("{}: {what}: SU2 has diverged", path.display()));
    let value = |word: &str| word.parse::<f64>().ok().filter(|value| value.is_finite());
    let of = |row: &[String], at: usize| row.get(at).and_then(|word| value(word));
    let mut residuals = (0..head.len().min(last.len())).filter(|&at| head[at].starts_with("rms")).peekable();
    if let Some(&at) = residuals.peek()
        && let Some((from, to)) = of(&first, at).zip(of(&last, at))
        && to > from + GROWN
    {
        return diverged(&format!("{} has grown from {from} to {to} (logarithms)", head[at]));
    }
    match residuals.find(|&at| value(&last[at]).is_none()) {
        Some(at) => diverged(&format!("{} in the last row is no number", last[at])),
        None => Ok(()),
    }
}

/// The values of some columns in the last row.
///
/// # Errors
/// When the file or a column is not there, or a value is no number.
pub fn last(path: &Path, wanted: &[String]) -> Result<BTreeMap<String, f64>, String> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let Table { head, last, rows, .. } = Table::read(path)?;
    if rows == 0 {
        return Err(named(&"no row: SU2 made no iteration"));
    }
    let find = |name: &String| {
        let at = head.iter().position(|column| column == name).ok_or_else(|| {
            named(&format!(
                "no column '{name}': mend [solver.su2] functionals or HISTORY_OUTPUT; there are {}",
                head.join(", ")
            ))
        })?;
        let value = last.get(at).and_then(|word| word.parse::<f64>().ok()).filter(|value| value.is_finite());
        let value = value
            .ok_or_else(|| named(&format!("{name} is no number in the last row: did SU2 diverge? Its log tells")))?;
        Ok((name.clone(), value))
    };
    wanted.iter().map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_by_the_names_of_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let text = "\"Time_Iter\",\"Inner_Iter\",     \"rms[Rho]\"    ,        \"CL\"       ,        \"CD\"       \n          0,          0,     -2.1,  0.1, 0.02\n          0,          1,     -3.1,  0.288, 1.5e-02\n";
        std::fs::write(&path, text).unwrap();
        let found = last(&path, &["CL".into(), "CD".into()]).unwrap();
        assert_eq!(found, BTreeMap::from([("CL".into(), 0.288), ("CD".into(), 0.015)]));
        assert!(
            last(&path, &["CMz".into()]).unwrap_err().contains("there are Time_Iter, Inner_Iter, rms[Rho], CL, CD")
        );
        std::fs::write(&path, text.replace("0.288", "-nan")).unwrap();
        assert!(last(&path, &["CL".into()]).unwrap_err().contains("diverge"));
        assert_eq!((check(&path), rows(&path)), (Ok(()), 2));
        std::fs::write(&path, text.replace("-3.1", "nan")).unwrap();
        assert!(check(&path).unwrap_err().contains("nan in the last row is no number"));
        std::fs::write(&path, text.replace("-3.1", "1.8")).unwrap();
        assert_eq!(check(&path), Ok(()));
        std::fs::write(&path, text.replace("-3.1", "2.2")).unwrap();
        assert!(check(&path).unwrap_err().contains("rms[Rho] has grown from -2.1 to 2.2"));
        // A row that SU2 has not written to its end.
        std::fs::write(&path, format!("{text}          0,          2,     -")).unwrap();
        assert_eq!((check(&path), rows(&path)), (Ok(()), 2));
    }
}
