//! "Did you mean": the nearest of a closed set of words.

/// The number of edits between two words: insert, delete, replace, or swap two neighbours.
#[must_use]
pub fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().take(64).collect();
    let b: Vec<char> = b.chars().take(64).collect();
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = i;
    }
    for (j, cell) in rows[0].iter_mut().enumerate() {
        *cell = j;
    }
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let replace = usize::from(a[i - 1] != b[j - 1]);
            let mut best = (rows[i - 1][j] + 1)
                .min(rows[i][j - 1] + 1)
                .min(rows[i - 1][j - 1] + replace);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

/// The word of the set that was probably meant: the nearest, at most a third of the letters away; the first of equals.
#[must_use]
pub fn nearest<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (word.chars().count() / 3).max(1);
    set.into_iter()
        .map(|candidate| {
            (
                distance(&word.to_lowercase(), &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|(d, candidate)| *d <= limit && *d < candidate.chars().count())
        .min_by_key(|(d, _)| *d)
        .map(|(_, candidate)| candidate)
}

/// `; did you mean `x`?`, or nothing.
#[must_use]
pub fn did_you_mean<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, set).map_or_else(String::new, |found| format!("; did you mean `{found}`?"))
}

/// The same and all that there are: `; did you mean `x`? There are: x, y`, `; there are: x, y`, or `; there are none`.
#[must_use]
pub fn near_and_all<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> String {
    let all: Vec<&str> = set.into_iter().filter(|word| !word.is_empty()).collect();
    if all.is_empty() {
        return "; there are none".to_owned();
    }
    let near = did_you_mean(word, all.iter().copied());
    let there_are = if near.is_empty() { "; there" } else { " There" };
    format!("{near}{there_are} are: {}", all.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transposition_counts_as_one_edit() {
        assert_eq!(distance("tpi", "tip"), 1);
        assert_eq!(nearest("tpi", ["top", "tip", "com"]), Some("tip"));
    }

    #[test]
    fn words_too_far_away_are_not_proposed() {
        assert_eq!(nearest("x", ["y"]), None);
        assert_eq!(nearest("kgs", ["kg", "g", "m"]), Some("kg"));
        assert_eq!(nearest("uper", ["lower", "upper"]), Some("upper"));
    }
    #[test]
    fn all_that_there_is_stands_behind_what_is_near_in_a_sentence_of_its_own() {
        assert_eq!(
            near_and_all("peek", ["peak", "sink"]),
            "; did you mean `peak`? There are: peak, sink"
        );
        assert_eq!(near_and_all("tip", ["peak"]), "; there are: peak");
        assert_eq!(near_and_all("tip", []), "; there are none");
    }
}
