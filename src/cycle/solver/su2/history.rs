//! The history of convergence: a table with names in quotes, padded with spaces.
use std::collections::BTreeMap;
use std::path::Path;

/// By how many orders of magnitude the first residual, that of the density, may grow beyond that of the first iteration. From the free stream it
/// grows by one or so (NACA 0012, Spalart and Allmaras).
const GROWN: f64 = 4.0;

/// The table.
struct Table {
    /// Names of the columns.
    head: Vec<String>,
    /// The rows below them, lines of text.
    rows: Vec<String>,
}

/// The words of a line.
fn words(line: &str) -> Vec<String> {
    line.split(',').map(|word| word.trim().trim_matches('"').trim().to_owned()).collect()
}

/// A finite number.
fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| value.is_finite())
}

impl Table {
    fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        // SU2 may be at work: a line without its end is not a row yet.
        let whole = &text[..text.rfind('\n').map_or(0, |at| at + 1)];
        let mut lines = whole.lines().filter(|line| !line.trim().is_empty());
        let head = lines.next().map_or_else(Vec::new, words);
        Ok(Self { head, rows: lines.map(str::to_owned).collect() })
    }

    /// So many rows at the end, or as many as there are.
    fn end(&self, count: usize) -> Vec<Vec<String>> {
        self.rows[self.rows.len() - count.min(self.rows.len())..].iter().map(|row| words(row)).collect()
    }
}

/// Rows of the table, without its head.
pub fn rows(path: &Path) -> u64 {
    Table::read(path).map_or(0, |table| table.rows.len() as u64)
}

/// Refuses a table whose residuals end in what is no number, or have grown by [`GROWN`] orders of magnitude: SU2 itself goes on to the end then. Other
/// columns may: SU2 divides by what is 0.
///
/// # Errors
/// What is wrong, or that it is not there.
pub fn check(path: &Path) -> Result<(), String> {
    let table = Table::read(path)?;
    let head = &table.head;
    let diverged = |what: &str| Err(format!("{}: {what}: SU2 has diverged", path.display()));
    let [first, last] = [table.rows.first(), table.rows.last()].map(|row| row.map_or_else(Vec::new, |row| words(row)));
    let of = |row: &[String], at: usize| row.get(at).and_then(|word| number(word));
    let mut residuals = (0..head.len().min(last.len())).filter(|&at| head[at].starts_with("rms")).peekable();
    if let Some(&at) = residuals.peek()
        && let Some((from, to)) = of(&first, at).zip(of(&last, at))
        && to > from + GROWN
    {
        return diverged(&format!("{} has grown from {from} to {to} (logarithms)", head[at]));
    }
    match residuals.find(|&at| number(&last[at]).is_none()) {
        Some(at) => diverged(&format!("{} in the last row is no number", last[at])),
        None => Ok(()),
    }
}

/// The means of some columns over so many rows at the end, or as many as there are.
///
/// # Errors
/// When the file or a column is not there, or a value is no number.
pub fn means(path: &Path, wanted: &[String], over: usize) -> Result<BTreeMap<String, f64>, String> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let table = Table::read(path)?;
    let rows = table.end(over);
    if rows.is_empty() {
        return Err(named(&"no row: SU2 made no iteration"));
    }
    let find = |name: &String| {
        let at = table.head.iter().position(|column| column == name).ok_or_else(|| {
            named(&format!(
                "no column '{name}': mend [solver.su2] functionals or HISTORY_OUTPUT; there are {}",
                table.head.join(", ")
            ))
        })?;
        let values = rows.iter().map(|row| row.get(at).and_then(|word| number(word)));
        let sum: Option<f64> = values.sum();
        let sum = sum.ok_or_else(|| {
            let rows = if over > 1 { format!("all of the last {} rows", rows.len()) } else { "the last row".into() };
            named(&format!("{name} is no number in {rows}: did SU2 diverge? Its log tells"))
        })?;
        Ok((name.clone(), sum / rows.len() as f64))
    };
    wanted.iter().map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_at_the_end_by_the_names_of_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let text = "\"Time_Iter\",\"Inner_Iter\",     \"rms[Rho]\"    ,        \"CL\"       ,        \"CD\"       \n          0,          0,     -2.1,  0.1, 0.02\n          0,          1,     -3.1,  0.288, 1.5e-02\n";
        std::fs::write(&path, text).unwrap();
        let found = |over| means(&path, &["CL".into(), "CD".into()], over).unwrap();
        assert_eq!(found(1), BTreeMap::from([("CL".into(), 0.288), ("CD".into(), 0.015)]));
        assert_eq!(found(2), BTreeMap::from([("CL".into(), 0.194), ("CD".into(), 0.0175)]));
        assert_eq!(found(9), found(2));
        assert!(
            means(&path, &["CMz".into()], 1).unwrap_err().contains("there are Time_Iter, Inner_Iter, rms[Rho], CL, CD")
        );
        std::fs::write(&path, text.replace("0.288", "-nan")).unwrap();
        assert!(
            means(&path, &["CL".into()], 2)
                .unwrap_err()
                .contains("CL is no number in all of the last 2 rows: did SU2 diverge")
        );
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
