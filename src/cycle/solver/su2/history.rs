//! The history of convergence: a table with names in quotes, padded with spaces.
use std::collections::BTreeMap;
use std::path::Path;

/// The table, as far as it is looked at.
struct Table {
    /// Names of the columns.
    head: Vec<String>,
    /// The last row; empty where there is none.
    last: Vec<String>,
    /// Rows, without the head.
    rows: u64,
}

impl Table {
    fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let clean = |word: &str| word.trim().trim_matches('"').trim().to_owned();
        let words = |line: &str| line.split(',').map(clean).collect();
        let mut lines = text.lines().filter(|line| !line.trim().is_empty());
        let head = lines.next().map_or_else(Vec::new, words);
        let (rows, last) = lines.fold((0, None), |(rows, _), line| (rows + 1, Some(line)));
        Ok(Self { head, last: last.map_or_else(Vec::new, words), rows })
    }
}

/// Rows of the table, without its head.
pub fn rows(path: &Path) -> u64 {
    Table::read(path).map_or(0, |table| table.rows)
}

/// Refuses a table whose residuals end in what is no number. Other columns may: SU2 divides by what is 0.
///
/// # Errors
/// What is wrong, or that it is not there.
pub fn is_finite(path: &Path) -> Result<(), String> {
    let Table { head, last, .. } = Table::read(path)?;
    let residuals = head.iter().zip(&last).filter(|(name, _)| name.starts_with("rms"));
    let wrong = residuals.map(|(_, word)| word).find(|word| !word.parse::<f64>().is_ok_and(f64::is_finite));
    wrong.map_or(Ok(()), |word| {
        Err(format!("{}: {word} in the last row is no number: SU2 has diverged", path.display()))
    })
}

/// The values of some columns in the last row.
///
/// # Errors
/// When the file or a column is not there, or a value is no number.
pub fn last(path: &Path, wanted: &[String]) -> Result<BTreeMap<String, f64>, String> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let Table { head, last, rows } = Table::read(path)?;
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
        assert_eq!((is_finite(&path), rows(&path)), (Ok(()), 2));
        std::fs::write(&path, text.replace("-3.1", "nan")).unwrap();
        assert!(is_finite(&path).unwrap_err().contains("nan in the last row is no number"));
    }
}
