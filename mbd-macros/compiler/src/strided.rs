//! Lists in which something repeats with places that advance evenly, written as loops.

/// Items that follow one another, several times over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StridedRun {
    /// Where it begins in the list.
    pub start: usize,
    /// How often its items follow one another.
    pub rounds: usize,
    /// The items of one round.
    pub items: Vec<RoundItem>,
}

/// What one round does once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RoundItem {
    /// What it is; equal for things that are alike.
    pub key: usize,
    /// Its places in the first round.
    pub at: Vec<usize>,
    /// How far each place advances from round to round.
    pub step: Vec<isize>,
}

/// No round has more items.
const LONGEST: usize = 12;
/// Fewer rounds are written out.
const FEWEST: usize = 3;

/// The list as loops, in order; what does not repeat is a loop of one round.
#[must_use]
pub fn strided_runs(list: &[(usize, Vec<usize>)]) -> Vec<StridedRun> {
    let mut strided_runs = Vec::new();
    let mut start = 0;
    while start < list.len() {
        let rest = &list[start..];
        // The period that covers most, the shortest of those.
        let (period, rounds) = (1..=LONGEST.min(rest.len() / FEWEST))
            .map(|period| (period, rounds(rest, period)))
            .filter(|&(_, rounds)| rounds >= FEWEST)
            .max_by_key(|&(period, rounds)| (period * rounds, std::cmp::Reverse(period)))
            .unwrap_or((1, 1));
        let items = rest.iter().take(period).enumerate();
        let items = items.map(|(i, (key, at))| RoundItem {
            key: *key,
            at: at.clone(),
            step: match rest.get(i + period) {
                Some((_, next)) if rounds > 1 => steps(at, next),
                _ => vec![0; at.len()],
            },
        });
        strided_runs.push(StridedRun {
            start,
            rounds,
            items: items.collect(),
        });
        start += period * rounds;
    }
    strided_runs
}

/// How often the first `period` things follow one another, places advancing evenly.
fn rounds(list: &[(usize, Vec<usize>)], period: usize) -> usize {
    let alike = |index: usize| {
        let (Some((key, at)), Some((before, was))) = (list.get(index), list.get(index - period))
        else {
            return false;
        };
        if key != before || at.len() != was.len() {
            return false;
        }
        let Some((_, earlier)) = index.checked_sub(2 * period).and_then(|i| list.get(i)) else {
            return true;
        };
        let mut steps = earlier.iter().zip(was).zip(at);
        at.len() == earlier.len()
            && steps.all(|((&a, &b), &c)| c.wrapping_sub(b) == b.wrapping_sub(a))
    };
    let last = (period..list.len())
        .take_while(|&index| alike(index))
        .count();
    1 + last / period
}

fn steps(from: &[usize], to: &[usize]) -> Vec<isize> {
    from.iter()
        .zip(to)
        .map(|(&from, &to)| to as isize - from as isize)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written_out(strided_runs: &[StridedRun]) -> Vec<(usize, Vec<usize>)> {
        let round = |run: &StridedRun, round: usize| -> Vec<(usize, Vec<usize>)> {
            let place = |(&at, &step): (&usize, &isize)| {
                at.wrapping_add_signed(step.wrapping_mul(round as isize))
            };
            let items = run.items.iter();
            items
                .map(|item| {
                    (
                        item.key,
                        item.at.iter().zip(&item.step).map(place).collect(),
                    )
                })
                .collect()
        };
        let all = strided_runs.iter();
        all.flat_map(|run| {
            (0..run.rounds)
                .flat_map(|r| round(run, r))
                .collect::<Vec<_>>()
        })
        .collect()
    }

    #[test]
    fn loops_stand_for_the_list_they_were_made_of() {
        let mut list = vec![(9, vec![0])];
        for i in 0..20 {
            list.push((1, vec![10 + 3 * i, 200 - 5 * i]));
            list.push((2, vec![7 * i]));
        }
        list.push((1, vec![70, 200]));
        list.extend((0..4).map(|i| (3, vec![i * i])));
        let found = strided_runs(&list);
        assert_eq!(written_out(&found), list);
        assert_eq!((found[1].rounds, found[1].items.len()), (20, 2));
        assert!(found.len() <= 7, "{found:?}");
        assert!(strided_runs(&[]).is_empty());
    }
}
