//! Valve and drive, each way.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::*;

const SERVO: Model = Model {
    dead_zone: 0.03,
    offset: 0.01,
    ..Model::linear(400.0, 20.0, 1.0e6)
};

#[test]
fn the_command_undoes_the_flow() {
    for u in [-0.9_f32, -0.3, -0.05, 0.05, 0.4, 1.0] {
        let back = SERVO.command(SERVO.flow(u), 0.002);
        assert!((back - u).abs() < 1e-6, "{u} came back as {back}");
    }
    // Continuous across zero: the ends of the blend meet the exact inverse.
    for edge in [0.002_f32, -0.002] {
        let inside = SERVO.command(edge * 0.9999 + SERVO.offset, 0.002);
        let outside = SERVO.command(edge * 1.0001 + SERVO.offset, 0.002);
        assert!((inside - outside).abs() < 1e-4);
    }
}

#[test]
fn a_held_flow_ends_at_the_velocity_gain() {
    let mut motion = Motion::default();
    for _ in 0..2000 {
        SERVO.advance(&mut motion, 0.1, 1e-3);
    }
    assert!((motion.velocity - 250.0).abs() < 0.05);
    assert!(motion.acceleration.abs() < 0.5);
    // The position lags the ramp by 2 xi / w0.
    assert!((motion.position - 250.0 * (2.0 - 0.05)).abs() < 0.1);
}

#[test]
fn what_a_valve_gives_is_what_was_wanted() {
    let models = [
        SERVO,
        Model {
            offset: -0.02,
            ..SERVO
        },
    ];
    for model in models {
        let (d, o) = (model.dead_zone, model.offset);
        for k in -200..=200 {
            let flow = 0.005 * k as f32;
            // Within the blend too, command and flow are each other's inverse.
            for blend in [0.002, 0.05] {
                let command = model.valve_command(flow, blend);
                let back = model.valve_flow_of(command, blend);
                assert!((back - flow).abs() < 1e-6, "{flow} came back as {back}");
                let given = model.valve_flow(command);
                let exact = flow.abs() > blend || flow == 0.0;
                assert!(
                    !exact || (given - flow).abs() < 1e-6,
                    "{flow} gives {given}"
                );
                assert!(given.abs() <= flow.abs() + 1e-6, "{flow} gives {given}");
            }
        }
        // Closed from edge to edge, as far from the offset as the dead zone is wide.
        for (command, flow) in [
            (d - o, 0.0),
            (-d - o, 0.0),
            (d - o + 0.1, 0.1),
            (-d - o - 0.2, -0.2),
        ] {
            assert!((model.valve_flow(command) - flow).abs() < 1e-6);
        }
        for (command, flow) in [(d, o), (-d, o), (d + 0.1, o + 0.1), (-d - 0.2, o - 0.2)] {
            assert!((model.flow(command) - flow).abs() < 1e-6);
        }
    }
}

#[test]
fn a_model_is_its_parameters() {
    let model = Model {
        friction: 300.0,
        ..SERVO
    };
    let back = Model::from_parameters(&model.parameters());
    for (found, expected) in back.fields().into_iter().zip(model.fields()) {
        assert!((found - expected).abs() <= 1e-6 * expected.abs());
    }
    // The parameters are those of the equation: what acts at a command, a velocity, a constant.
    let [a1, a2, b0, null, coulomb, constant] = model.parameters();
    let (u, v, a) = (0.4, 50.0, 7.0);
    let jerk = model.b0 * model.flow(u) - model.a1 * v - model.a2 * a;
    let linear = b0 * u + null - a1 * v - a2 * a + constant;
    assert!((jerk - linear).abs() < 1e-5 * jerk.abs() && coulomb == -300.0);
    // A dead zone or a friction of the wrong sign is none.
    let odd = Model::from_parameters(&[400.0, 20.0, 1e6, 1e4, 5.0, 0.0]);
    assert_eq!((odd.dead_zone, odd.friction), (0.0, 0.0));
}

#[test]
fn a_motion_is_the_solution_of_the_equation() {
    let mut state = 1_u32;
    let mut draw = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    for _ in 0..200 {
        let model = Model::linear(500.0 + 300.0 * draw(), 20.0 + 15.0 * draw(), 1e6);
        let start = Motion {
            position: draw(),
            velocity: 300.0 * draw(),
            acceleration: 5000.0 * draw(),
        };
        let flow = draw();
        let mut motion = start;
        // A fortieth of 1/w: what the series leaves out is 1e-6 of what moves.
        let time = 1e-3;
        model.advance(&mut motion, flow, time);
        let [a1, a2, b0] = [model.a1, model.a2, model.b0].map(f64::from);
        let mut exact = [start.position, start.velocity, start.acceleration].map(f64::from);
        let steps = 2000;
        let h = f64::from(time) / f64::from(steps);
        for _ in 0..steps {
            let [x, v, a] = exact;
            // The middle of a step, twice.
            let jerk = b0 * f64::from(flow) - a1 * v - a2 * a;
            let (vm, am) = (v + 0.5 * h * a, a + 0.5 * h * jerk);
            let middle = b0 * f64::from(flow) - a1 * vm - a2 * am;
            exact = [x + h * vm, v + h * am, a + h * middle];
        }
        let sizes = [1.0, 500.0, 1e6 * 1e-3];
        let found = [motion.position, motion.velocity, motion.acceleration];
        for ((found, exact), size) in found.into_iter().zip(exact).zip(sizes) {
            let error = (f64::from(found) - exact).abs();
            assert!(error < 2e-6 * size, "{model:?} {start:?}: {found} {exact}");
        }
    }
}

#[test]
fn every_number_of_a_model_is_finite_or_it_is_none() {
    assert!(SERVO.is_finite());
    for k in 0..6 {
        for wrong in [f32::NAN, f32::INFINITY] {
            let mut fields = SERVO.fields();
            fields[k] = wrong;
            assert!(!Model::from_fields(fields).is_finite(), "{k}");
        }
    }
}
