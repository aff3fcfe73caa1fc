//! The kinds by their names, what each gives, and a drive for them.

use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid_capi as c;
use trendid_capi::{
    trendid_coulomb2_init, trendid_coulomb3_init, trendid_instrumented2_init,
    trendid_instrumented3_init, trendid_servo2_init, trendid_servo3_init,
    trendid_valve_coulomb2_init, trendid_valve_coulomb3_init, trendid_valve2_init,
    trendid_valve3_init,
};

use crate::words::no_detail;

/// Settings for about 20 rad/s at 1 kHz, commands of 1 and strokes of 50.
pub(crate) fn settings() -> c::Settings {
    let mut made = MaybeUninit::uninit();
    // SAFETY: a pointer to a value of this function, which the call fills.
    unsafe {
        let done = c::trendid_settings_init(made.as_mut_ptr(), 0.001, 20.0, 1.0, 50.0);
        assert_eq!(done, c::Error::Ok);
        made.assume_init()
    }
}

/// A kind of identifier; `init` gets memory that is large enough for every kind.
pub(crate) struct Kind {
    pub name: &'static str,
    pub inputs: usize,
    pub parameters: usize,
    pub order: usize,
    init: unsafe fn(*mut Memory, &c::Settings, *mut c::Detail) -> c::Error,
}

/// Memory for any of them.
#[repr(C)]
pub(crate) struct Memory {
    words: [u64; 1024],
}

/// `y'' + a1 y' = b0 u + b0 v + constant`, with an initial state.
unsafe fn two_inputs(
    memory: *mut c::Any,
    settings: *const c::Settings,
    handle: *mut *mut c::Identifier,
    detail: *mut c::Detail,
) -> c::Error {
    let structure = c::Structure {
        order: 2,
        inputs: 2,
        output_terms: 0b10,
        input_terms: [1, 1],
        constant: 1,
        initial_state: 1,
    };
    // SAFETY: by the contract of the header.
    unsafe { c::trendid_any_init(memory, settings, &structure, handle, detail) }
}

/// `y' + a0 y = b0 u`.
unsafe fn no_constant(
    memory: *mut c::Any,
    settings: *const c::Settings,
    handle: *mut *mut c::Identifier,
    detail: *mut c::Detail,
) -> c::Error {
    let structure = c::Structure {
        order: 1,
        inputs: 1,
        output_terms: 1,
        input_terms: [1, 0],
        constant: 0,
        initial_state: 0,
    };
    // SAFETY: by the contract of the header.
    unsafe { c::trendid_any_init(memory, settings, &structure, handle, detail) }
}

macro_rules! kinds {
    ($($name:literal $memory:ident $init:ident $order:literal $inputs:literal $parameters:literal;)+) => {
        [$(Kind {
            name: $name,
            inputs: $inputs,
            parameters: $parameters,
            order: $order,
            init: |memory, settings, detail| {
                const { assert!(size_of::<c::$memory>() <= size_of::<Memory>()) }
                // SAFETY: by the contract of the header, large enough by the line above.
                unsafe { $init(memory.cast(), settings, null_mut(), detail) }
            },
        }),+]
    };
}

/// Of each kind order, inputs and parameters; orders 2 and 3 side by side.
pub(crate) const KINDS: [Kind; 12] = kinds! {
    "servo2" Servo2 trendid_servo2_init 2 1 4;
    "servo3" Servo3 trendid_servo3_init 3 1 5;
    "coulomb2" Coulomb2 trendid_coulomb2_init 2 2 5;
    "coulomb3" Coulomb3 trendid_coulomb3_init 3 2 6;
    "valve2" Valve2 trendid_valve2_init 2 1 5;
    "valve3" Valve3 trendid_valve3_init 3 1 6;
    "valve_coulomb2" ValveCoulomb2 trendid_valve_coulomb2_init 2 2 6;
    "valve_coulomb3" ValveCoulomb3 trendid_valve_coulomb3_init 3 2 7;
    "instrumented2" Instrumented2 trendid_instrumented2_init 2 1 4;
    "instrumented3" Instrumented3 trendid_instrumented3_init 3 1 5;
    "any of two inputs" Any two_inputs 2 2 5;
    "any without constant" Any no_constant 1 1 2;
};

impl Kind {
    /// The kind of this name.
    pub(crate) fn of(name: &str) -> &'static Self {
        let found = KINDS.iter().find(|kind| kind.name == name);
        found.expect("a name of the table")
    }

    /// An object in memory of its own, or why there is none.
    pub(crate) fn begin(&self, settings: &c::Settings) -> Result<Object, c::Detail> {
        let mut object = Object {
            memory: Box::new(Memory { words: [0; 1024] }),
            parameters: self.parameters,
            order: self.order,
            inputs: self.inputs,
        };
        let mut detail = no_detail();
        // SAFETY: memory for the object, and a detail of this function.
        match unsafe { (self.init)(&raw mut *object.memory, settings, &mut detail) } {
            c::Error::Ok => Ok(object),
            error => {
                assert_eq!(error, detail.error, "{}", self.name);
                Err(detail)
            }
        }
    }
}

/// An identifier of any kind.
pub(crate) struct Object {
    memory: Box<Memory>,
    parameters: usize,
    order: usize,
    inputs: usize,
}

/// What an identifier gives.
pub(crate) struct Found {
    pub estimate: c::Estimate,
    pub status: c::Status,
    pub poles: Option<Vec<c::Pole>>,
    pub covariance: Vec<f32>,
}

impl Object {
    pub(crate) fn handle(&mut self) -> *mut c::Identifier {
        (&raw mut *self.memory).cast()
    }

    /// One sample; the second input is the sign of the velocity.
    pub(crate) fn update(&mut self, u: f32, sign: f32, y: f32) -> c::Outcome {
        let (u, count) = ([u, sign], self.inputs);
        let mut outcome = MaybeUninit::uninit();
        // SAFETY: every pointer is to a value of this function.
        unsafe {
            let done = c::trendid_identifier_update_inputs(
                self.handle(),
                u.as_ptr(),
                count,
                y,
                outcome.as_mut_ptr(),
            );
            assert_eq!(done, c::Error::Ok);
            outcome.assume_init()
        }
    }

    pub(crate) fn read(&mut self) -> Found {
        let (n, m, handle) = (self.parameters, self.order, self.handle());
        let (mut estimate, mut status) = (MaybeUninit::uninit(), MaybeUninit::uninit());
        let mut covariance = vec![0.0; n * n];
        let mut poles = vec![c::Pole { re: 0.0, im: 0.0 }; m];
        // SAFETY: every pointer is to a value of this function.
        unsafe {
            for done in [
                c::trendid_identifier_estimate(handle, estimate.as_mut_ptr()),
                c::trendid_identifier_status(handle, status.as_mut_ptr()),
                c::trendid_identifier_covariance(handle, covariance.as_mut_ptr(), n * n),
            ] {
                assert_eq!(done, c::Error::Ok);
            }
            let found = c::trendid_identifier_poles(handle, poles.as_mut_ptr(), m);
            Found {
                estimate: estimate.assume_init(),
                status: status.assume_init(),
                poles: match found {
                    c::Error::Ok => Some(poles),
                    other => {
                        assert_eq!(other, c::Error::NotYet);
                        None
                    }
                },
                covariance,
            }
        }
    }
}

/// y''' = b0 u(k - late) - a1 y' - a2 y'', by ten steps of a sample of 1 ms.
#[derive(Default)]
pub(crate) struct Drive {
    state: [f64; 3],
}

impl Drive {
    pub(crate) fn position(&self) -> f32 {
        self.state[0] as f32
    }

    pub(crate) fn velocity(&self) -> f32 {
        self.state[1] as f32
    }

    pub(crate) fn run(&mut self, u: f32) {
        for _ in 0..10 {
            let [y, v, a] = &mut self.state;
            *y += 1e-4 * *v;
            *v += 1e-4 * *a;
            *a += 1e-4 * (1e6 * f64::from(u) - 400.0 * *v - 20.0 * *a);
        }
    }
}

/// A command of several levels.
pub(crate) fn command(k: usize) -> f32 {
    [0.4, -0.2, 0.1, -0.35][k / 150 % 4]
}
