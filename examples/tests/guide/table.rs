//! Tables of the guide.

/// The guide.
pub(crate) const GUIDE: &str = include_str!("../../../docs/porting-guide.md");

/// Cells of a row.
pub(crate) type Row = Vec<String>;

/// The rows of the first table under a heading, without its head.
pub(crate) fn rows(heading: &str) -> Vec<Row> {
    let mut lines =
        GUIDE.lines().skip_while(|line| line.trim_start_matches('#').trim() != heading || !line.starts_with('#'));
    lines.next().unwrap_or_else(|| panic!("no heading `{heading}`"));
    let table = lines.skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    table.skip(2).map(cells).collect()
}

/// What stands in backticks in a cell.
pub(crate) fn words(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}
