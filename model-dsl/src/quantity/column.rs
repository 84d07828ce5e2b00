//! Names of columns with their unit behind them, as many programs write them: `x [mm]`, `Deviation (um)`.

/// The name without the brackets, and what stands in them. Nothing where there are none, or nothing stands before them.
pub fn unit_in_name(name: &str) -> Option<(&str, &str)> {
    let (bare, unit) = match name.strip_suffix(']') {
        Some(rest) => rest.rsplit_once('[')?,
        None => name.strip_suffix(')')?.rsplit_once('(')?,
    };
    (!bare.trim().is_empty()).then(|| (bare.trim(), unit.trim()))
}
