use super::*;

const ALL: [Method; 3] = [Method::LatinHypercube, Method::Sobol, Method::Random];
const FREE: [Levels; 5] = [Levels::Continuous; 5];

#[test]
fn a_grid_has_every_combination_with_the_last_factor_fastest() {
    let grid = points(Method::Grid, &[Levels::Count(2), Levels::Count(3)], 0, 0).unwrap();
    let levels: Vec<Vec<usize>> = grid
        .iter()
        .map(|point| {
            let counts = [Levels::Count(2), Levels::Count(3)];
            point.iter().zip(counts).map(|(&u, levels)| levels.level(u).unwrap()).collect()
        })
        .collect();
    assert_eq!(levels, [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]);
    assert_eq!(grid[1], [0.25, 0.5]);
}

#[test]
fn a_level_is_found_from_its_middle_whatever_their_number() {
    for count in 1..2000 {
        let levels = Levels::Count(count);
        let all = points(Method::Grid, &[levels], 0, 0).unwrap();
        assert!(all.iter().enumerate().all(|(level, point)| levels.level(point[0]) == Some(level)), "{count}");
    }
    assert_eq!(Levels::Continuous.level(0.5), None);
}

#[test]
fn a_larger_study_keeps_the_points_of_the_smaller() {
    for method in [Method::Sobol, Method::Random] {
        let (small, large) = (points(method, &FREE, 37, 5).unwrap(), points(method, &FREE, 200, 5).unwrap());
        assert_eq!(small, large[..37], "{method:?}");
    }
}

#[test]
fn the_seed_decides_the_points() {
    for method in ALL {
        assert_eq!(points(method, &FREE, 16, 3), points(method, &FREE, 16, 3));
        assert_ne!(points(method, &FREE, 16, 3), points(method, &FREE, 16, 4), "{method:?}");
    }
}

/// Bits that a study of today must still have in a year.
#[test]
fn a_seed_gives_the_same_points_in_every_version() {
    let bits = |method| points(method, &FREE, 3, 42).unwrap()[2][4].to_bits();
    assert_eq!(ALL.map(bits), FIRST);
}

const FIRST: [u64; 3] = [4_578_542_716_193_335_488, 4_598_575_190_982_179_910, 4_604_739_652_729_742_563];

#[test]
fn every_stratum_of_a_latin_hypercube_holds_one_point() {
    for samples in [1, 2, 10, 49, 1000] {
        let points = points(Method::LatinHypercube, &FREE, samples, 9).unwrap();
        for factor in 0..FREE.len() {
            let mut strata: Vec<usize> = points.iter().map(|point| (point[factor] * samples as f64) as usize).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..samples), "{samples} samples, factor {factor}");
        }
    }
}

#[test]
fn no_coordinate_is_zero_or_one() {
    for method in ALL {
        let points = points(method, &FREE, 20_000, 1).unwrap();
        assert!(points.iter().flatten().all(|&u| u > 0.0 && u < 1.0), "{method:?}");
    }
}

#[test]
fn impossible_designs_are_refused() {
    let refused = |method, factors: &[Levels], samples| points(method, factors, samples, 0).unwrap_err();
    assert_eq!(refused(Method::Sobol, &[], 4), DesignError::NoFactors);
    assert_eq!(refused(Method::Random, &FREE, 0), DesignError::NoSamples);
    assert_eq!(
        refused(Method::Grid, &[Levels::Count(2), Levels::Continuous], 4),
        DesignError::ContinuousInGrid { factor: 1 }
    );
    assert_eq!(refused(Method::Random, &[Levels::Count(0)], 4), DesignError::NoLevels { factor: 0 });
    assert_eq!(refused(Method::Grid, &[Levels::Count(1000); 9], 4), DesignError::TooManyPoints);
    assert_eq!(refused(Method::Sobol, &[Levels::Continuous; 257], 4), DesignError::TooManyFactors { factors: 257 });
}
