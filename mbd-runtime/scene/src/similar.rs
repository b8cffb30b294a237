//! "Did you mean": the nearest of a closed set of words.

/// The letters of a word, as far as words are compared.
fn letters(word: &str) -> Vec<char> {
    word.chars().take(64).collect()
}

/// The number of edits between two words: insert, delete, replace, or swap two neighbours.
#[must_use]
pub fn distance(a: &str, b: &str) -> usize {
    edits(&letters(a), &letters(b))
}

/// The number of edits between two lists of letters.
fn edits(a: &[char], b: &[char]) -> usize {
    // Between the first i letters of the one and the first j of the other, at i · width + j.
    let width = b.len() + 1;
    let mut least = vec![0; (a.len() + 1) * width];
    for (i, row) in least.chunks_exact_mut(width).enumerate() {
        row[0] = i;
    }
    for (j, cell) in least[..width].iter_mut().enumerate() {
        *cell = j;
    }
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let at = i * width + j;
            let replace = usize::from(a[i - 1] != b[j - 1]);
            let mut best = (least[at - width] + 1)
                .min(least[at - 1] + 1)
                .min(least[at - width - 1] + replace);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(least[at - 2 * width - 2] + 1);
            }
            least[at] = best;
        }
    }
    least[a.len() * width + b.len()]
}

/// The words of a set that may have been meant: the nearest, at most a third of the letters away; several where they are equally near.
#[must_use]
pub fn all_nearest<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let limit = (word.chars().count() / 3).max(1);
    let typed = letters(&word.to_lowercase());
    let near = set.into_iter().filter_map(|candidate| {
        let meant = letters(&candidate.to_lowercase());
        // Each edit changes the length by one at most.
        if typed.len().abs_diff(meant.len()) > limit {
            return None;
        }
        let bare = edits(&typed, &meant);
        let far = bare > limit || bare >= candidate.chars().count();
        (!far).then(|| ((bare, distance(word, candidate)), candidate))
    });
    let near: Vec<_> = near.collect();
    let least = near.iter().map(|(edits, _)| *edits).min();
    let mut found: Vec<&str> = Vec::new();
    for (edits, candidate) in near {
        if Some(edits) == least && !found.contains(&candidate) {
            found.push(candidate);
        }
    }
    found
}

/// The word of the set that was probably meant: the nearest, at most a third of the letters away; none where several are equally near.
#[must_use]
pub fn nearest<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    match all_nearest(word, set)[..] {
        [only] => Some(only),
        _ => None,
    }
}

/// The words of a set of which a word is a slip of typing, whatever it means: other capitals, two neighbours swapped, in words of four letters a
/// letter too many or too few, in words of five one instead of another.
#[must_use]
pub fn slips<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let typed = word.to_lowercase();
    let is_slip = |candidate: &&str| {
        let meant = candidate.to_lowercase();
        let [short, long] = {
            let mut lengths = [&typed, &meant].map(|word| word.chars().count());
            lengths.sort_unstable();
            lengths
        };
        match distance(&typed, &meant) {
            0 => true,
            1 if short < long => long >= 4,
            1 => short >= 5 || sorted(&typed) == sorted(&meant),
            _ => false,
        }
    };
    let mut found = all_nearest(word, set.into_iter().filter(is_slip));
    found.sort_unstable();
    found
}

/// The letters of a word in their order in the alphabet.
fn sorted(word: &str) -> Vec<char> {
    let mut letters: Vec<char> = word.chars().collect();
    letters.sort_unstable();
    letters
}

/// `; did you mean `x`?`, `; did you mean `x` or `y`?` where these are equally near, or nothing: also where there are more, of which any would be a guess.
#[must_use]
pub fn did_you_mean<'a>(word: &str, set: impl IntoIterator<Item = &'a str>) -> String {
    let [others @ .., last] = &all_nearest(word, set)[..] else {
        return String::new();
    };
    match others {
        [] => format!("; did you mean `{last}`?"),
        [_] | [_, _] => format!("; did you mean `{}` or `{last}`?", others.join("`, `")),
        _ => String::new(),
    }
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
    fn of_words_that_are_equally_near_none_is_chosen() {
        // One of them is the arc, the other none: what is meant is not known.
        let functions = ["abs", "acos", "sin", "sinh", "tan", "atan"];
        assert_eq!(nearest("acs", functions), None);
        let said = |word| did_you_mean(word, functions);
        assert_eq!(said("acs"), "; did you mean `abs` or `acos`?");
        assert_eq!(said("sih"), "; did you mean `sin` or `sinh`?");
        assert_eq!(said("acoss"), "; did you mean `acos`?");
        let angles = ["angle1", "angle2", "angle1_rate"];
        let angle = did_you_mean("angle3", angles);
        assert_eq!(angle, "; did you mean `angle1` or `angle2`?");
        let legs = ["leg[0]", "leg[1]", "leg[2]", "leg[3]"];
        assert_eq!(did_you_mean("leg[7]", legs), "");
        assert_eq!(nearest("Bob", ["bob", "Bobb", "bob"]), Some("bob"));
    }

    #[test]
    fn a_word_of_a_few_letters_with_another_letter_in_it_is_another_word() {
        let functions = [
            "dot",
            "sin",
            "sinh",
            "cosh",
            "cos",
            "ln",
            "norm",
            "log10",
            "smoothstep",
        ];
        for word in ["det", "rot", "sn", "coth", "tang"] {
            assert_eq!(slips(word, functions), [""; 0], "{word}");
        }
        let near = ["sni", "nrm", "coss", "SIN", "smothstep", "smoothstap"];
        let near = near.map(|word| slips(word, functions).concat());
        assert_eq!(
            near,
            ["sin", "norm", "cos", "sin", "smoothstep", "smoothstep"]
        );
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
