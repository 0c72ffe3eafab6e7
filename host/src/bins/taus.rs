//! Averaging times, in data periods.

use std::str::FromStr;

/// Which averaging times to evaluate, as in `--taus`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Taus {
    /// Four an octave: 1, 2, 3, then 4, 5, 6, 7 times powers of two.
    #[default]
    Quarter,
    /// Powers of two.
    Octave,
    /// 1, 2 and 4 times powers of ten.
    Decade,
    /// Every number up to a thousand, then steps of a thousandth.
    All,
    /// The ones named.
    List(Vec<u64>),
}

impl Taus {
    /// The averaging times up to `longest`, ascending.
    pub fn factors(&self, longest: u64) -> Vec<u64> {
        let mut factors: Vec<u64> = match self {
            Self::Quarter => (1..4).chain(doubled(&[4, 5, 6, 7], longest)).collect(),
            Self::Octave => doubled(&[1], longest).collect(),
            Self::Decade => powers(10, longest)
                .flat_map(|power| [1, 2, 4].map(|k| k * power))
                .collect(),
            Self::All => {
                let next = |&m: &u64| Some(m + m / 1000 + u64::from(m < 1000));
                std::iter::successors(Some(1), next)
                    .take_while(|&m| m <= longest)
                    .collect()
            }
            Self::List(list) => list.clone(),
        };
        factors.retain(|&m| m <= longest);
        factors.sort_unstable();
        factors.dedup();
        factors
    }
}

fn powers(base: u64, longest: u64) -> impl Iterator<Item = u64> {
    std::iter::successors(Some(1), move |power: &u64| power.checked_mul(base))
        .take_while(move |&power| power <= longest)
}

fn doubled(within_octave: &'static [u64], longest: u64) -> impl Iterator<Item = u64> {
    powers(2, longest).flat_map(move |power| {
        within_octave
            .iter()
            .filter_map(move |k| power.checked_mul(*k))
    })
}

impl FromStr for Taus {
    type Err = TausError;

    fn from_str(text: &str) -> Result<Self, TausError> {
        match text {
            "quarter" => Ok(Self::Quarter),
            "octave" => Ok(Self::Octave),
            "decade" => Ok(Self::Decade),
            "all" => Ok(Self::All),
            list => list
                .split(',')
                .map(|m| {
                    m.trim()
                        .parse()
                        .ok()
                        .filter(|&m| m > 0)
                        .ok_or_else(|| TausError(m.into()))
                })
                .collect::<Result<_, _>>()
                .map(Self::List),
        }
    }
}

/// Something that is no averaging time.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no averaging time; quarter, octave, decade, all, or whole numbers of samples \
         such as 1,10,100"
)]
pub struct TausError(String);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists() {
        assert_eq!(
            Taus::Quarter.factors(20),
            [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20]
        );
        assert_eq!(Taus::Octave.factors(20), [1, 2, 4, 8, 16]);
        assert_eq!(Taus::Decade.factors(50), [1, 2, 4, 10, 20, 40]);
        assert_eq!(Taus::All.factors(3), [1, 2, 3]);
        assert_eq!(
            Taus::All.factors(2002)[998..1003],
            [999, 1000, 1001, 1002, 1003]
        );
        assert_eq!(
            "3, 1,99".parse::<Taus>().expect("a list").factors(20),
            [1, 3]
        );
        assert!("1,0".parse::<Taus>().is_err() && "often".parse::<Taus>().is_err());
        assert_eq!(Taus::Quarter.factors(u64::MAX).last(), Some(&(7 << 61)));
    }
}
