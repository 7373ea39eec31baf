use super::*;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

fn moving(interpolation: Interpolation, times: &[f64], xs: &[f64]) -> Track {
    let values = xs.iter().flat_map(|x| [*x, 0.0, 0.0]).collect();
    Track {
        times: times.to_vec(),
        keys: Keys::Numbers { width: 3, values },
        interpolation,
    }
}

fn x(track: &Track, seconds: f64) -> f64 {
    track.at(seconds).number()
}

fn turned(track: &Track, seconds: f64) -> DQuat {
    match track.at(seconds) {
        Value::Rotation(value) => value,
        _ => DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
    }
}

#[test]
fn outside_its_keys_a_track_stays_at_the_ends() {
    for interpolation in [Interpolation::Step, Interpolation::Linear] {
        let track = moving(interpolation, &[1.0, 2.0], &[5.0, 7.0]);
        assert_eq!(x(&track, 0.0), 5.0);
        assert_eq!(x(&track, f64::NAN), 5.0);
        assert_eq!(x(&track, 2.0), 7.0);
        assert_eq!(x(&track, 9.0), 7.0);
    }
}

#[test]
fn steps_jump_at_the_key_and_lines_pass_through_the_middle() {
    assert_eq!(
        x(
            &moving(Interpolation::Step, &[1.0, 2.0], &[5.0, 7.0]),
            1.999
        ),
        5.0
    );
    assert_eq!(
        x(
            &moving(Interpolation::Linear, &[1.0, 2.0, 4.0], &[5.0, 7.0, 1.0]),
            3.0
        ),
        4.0
    );
}

#[test]
fn a_single_key_holds_for_every_interpolation() {
    assert_eq!(x(&moving(Interpolation::Linear, &[3.0], &[5.0]), 1.0), 5.0);
    assert_eq!(
        x(
            &moving(Interpolation::CubicSpline, &[3.0], &[1.0, 5.0, 1.0]),
            4.0
        ),
        5.0
    );
}

#[test]
fn a_cubic_spline_weighs_tangents_by_the_step() {
    // At the middle: ½·0 + ½·10 + (4/8)·leaving − (4/8)·arriving, with a step of 4 s.
    let track = moving(
        Interpolation::CubicSpline,
        &[0.0, 4.0],
        &[0.0, 0.0, 3.0, -2.0, 10.0, 0.0],
    );
    assert_eq!(x(&track, 2.0), 5.0 + 4.0 / 8.0 * 3.0 + 4.0 / 8.0 * 2.0);
    assert_eq!(x(&track, 0.0), 0.0);
    assert_eq!(x(&track, 4.0), 10.0);
}

#[test]
fn half_a_quarter_turn_is_an_eighth_by_the_shortest_path() {
    let quarter = DQuat::from_rotation_y(FRAC_PI_2);
    for end in [quarter, -quarter] {
        let keys = Keys::Rotations(vec![DQuat::IDENTITY, end]);
        let track = Track {
            times: vec![0.0, 1.0],
            keys,
            interpolation: Interpolation::Linear,
        };
        assert!(turned(&track, 0.5).angle_between(DQuat::from_rotation_y(PI / 4.0)) < 1e-7);
        assert!(
            (turned(&track, 1.0 / 3.0) * DVec3::X).distance(DVec3::new(
                (PI / 6.0).cos(),
                0.0,
                -0.5
            )) < 1e-12
        );
        assert!((turned(&track, 0.3).length() - 1.0).abs() < 1e-15);
    }
}

#[test]
fn nearly_equal_rotations_meet_the_arc() {
    let small = 1e-3_f64;
    let keys = Keys::Rotations(vec![DQuat::IDENTITY, DQuat::from_rotation_x(small)]);
    let track = Track {
        times: vec![0.0, 1.0],
        keys,
        interpolation: Interpolation::Linear,
    };
    let expected = DQuat::from_rotation_x(small * 0.25);
    assert!((turned(&track, 0.25).x - expected.x).abs() < 1e-10);
}

#[test]
fn cubic_rotations_are_unit_between_the_keys() {
    let still = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let quarter = DQuat::from_xyzw(0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
    let keys = Keys::Rotations(vec![still, DQuat::IDENTITY, still, still, quarter, still]);
    let track = Track {
        times: vec![0.0, 1.0],
        keys,
        interpolation: Interpolation::CubicSpline,
    };
    // Without tangents the middle is the mean of both, which made unit is half the turn.
    assert!(
        (turned(&track, 0.5) * DVec3::X).distance(DVec3::new(FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2))
            < 1e-15
    );
}

#[test]
fn equal_keys_give_equal_bits() {
    let odd = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.4).normalize();
    let keys = Keys::Rotations(vec![odd; 3]);
    let track = Track {
        times: vec![0.0, 0.7, 1.1],
        keys,
        interpolation: Interpolation::Linear,
    };
    assert!(track.is_constant());
    for frame in 0..40 {
        assert_eq!(turned(&track, f64::from(frame) / 24.0), odd);
    }
    let track = moving(
        Interpolation::CubicSpline,
        &[0.0, 1.0],
        &[0.0, 0.1, 0.0, 0.0, 0.1, 0.0],
    );
    assert!(track.is_constant());
    assert_eq!(x(&track, 0.37), 0.1);
    assert!(
        !moving(
            Interpolation::CubicSpline,
            &[0.0, 1.0],
            &[0.0, 0.1, 2.0, 0.0, 0.1, 0.0]
        )
        .is_constant()
    );
}

#[test]
fn numbers_go_their_ways_one_by_one() {
    // Two weights at the middle of 2 s: ½·(0 + 4) + (2/8)·8 − (2/8)·4 = 3, and ½·(1 + 1) without tangents = 1.
    let track = Track {
        times: vec![0.0, 2.0],
        keys: Keys::Numbers {
            width: 2,
            values: [
                [0.0, 0.0],
                [0.0, 1.0],
                [8.0, 0.0],
                [4.0, 0.0],
                [4.0, 1.0],
                [0.0; 2],
            ]
            .concat(),
        },
        interpolation: Interpolation::CubicSpline,
    };
    assert_eq!(track.at(1.0), Value::Numbers(vec![3.0, 1.0]));
    assert_eq!(track.at(5.0), Value::Numbers(vec![4.0, 1.0]));
    assert!(!track.is_constant());
}
