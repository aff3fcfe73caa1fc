//! An identifier of any structure gives what the core gives, for structures drawn at random; what
//! is no structure is refused.

#![cfg(feature = "any")]

use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid::estimation::Terms;
use trendid::trends::{FilteredTrends, Scheme};
use trendid_capi as c;
use trendid_identify::dynamic::{Filter, Setup, settings};

/// Linear congruential generator of Numerical Recipes.
struct Draw(u32);

impl Draw {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0 >> 8
    }

    fn below(&mut self, end: u32) -> u8 {
        (self.next() % end) as u8
    }

    fn number(&mut self) -> f32 {
        self.next() as f32 / 8_388_608.0 - 1.0
    }

    fn structure(&mut self) -> c::Structure {
        let order = 1 + self.below(4);
        let terms = |draw: &mut Self| draw.below(1 << order);
        c::Structure {
            order,
            inputs: 1 + self.below(2),
            output_terms: terms(self),
            input_terms: [terms(self), terms(self)],
            constant: self.below(2),
            initial_state: self.below(2),
        }
    }
}

fn terms(bits: u8) -> Terms {
    let powers: Vec<usize> = (0..8).filter(|power| bits & (1 << power) != 0).collect();
    Terms::of(&powers)
}

fn polynomial(order: u8) -> Vec<f32> {
    fn of<const M: usize>() -> Vec<f32> {
        let trends = FilteredTrends::<M>::for_bandwidth(Scheme::Tustin, 0.001, 20.0);
        trends.unwrap().filter().to_vec()
    }
    [of::<1>, of::<2>, of::<3>, of::<4>][usize::from(order) - 1]()
}

fn made(structure: &c::Structure, detail: &mut c::Detail) -> (c::Error, Box<MaybeUninit<c::Any>>) {
    let mut options = MaybeUninit::uninit();
    let mut memory = Box::new(MaybeUninit::<c::Any>::zeroed());
    // SAFETY: every pointer is to a value of this function.
    let error = unsafe {
        assert_eq!(
            c::trendid_settings_init(options.as_mut_ptr(), 0.001, 20.0, 1.0, 50.0),
            c::Error::Ok
        );
        let options: c::Settings = options.assume_init();
        c::trendid_any_init(memory.as_mut_ptr(), &options, structure, null_mut(), detail)
    };
    (error, memory)
}

fn no_detail() -> c::Detail {
    // SAFETY: zeros are a detail: numbers, and the error 0.
    unsafe { MaybeUninit::zeroed().assume_init() }
}

#[test]
fn structures_drawn_at_random_are_those_of_the_core() {
    let mut draw = Draw(200_001);
    let mut compared = 0;
    for number in 0..300 {
        let structure = draw.structure();
        let inputs: Vec<Terms> = structure.input_terms[..usize::from(structure.inputs)]
            .iter()
            .map(|bits| terms(*bits))
            .collect();
        let setup = Setup {
            order: usize::from(structure.order),
            output: terms(structure.output_terms),
            constant: structure.constant != 0,
            initial_state: structure.initial_state != 0,
            sample_time: 0.001,
            scheme: Scheme::Tustin,
            filter: Filter::Polynomial(polynomial(structure.order)),
            settings: settings(20.0, &vec![1.0; inputs.len()], 50.0),
            inputs,
        };
        let n = setup.parameters();
        let mut detail = no_detail();
        let (error, mut memory) = made(&structure, &mut detail);
        let native = setup.build();
        if n > c::ANY_PARAMETERS_MAX {
            assert_eq!(error, c::Error::ParameterCount, "{number}: {structure:?}");
            assert_eq!((detail.value, detail.high), (n as f32, 6.0));
            continue;
        }
        let Ok(mut native) = native else {
            assert_ne!(error, c::Error::Ok, "{number}: {structure:?}");
            continue;
        };
        assert_eq!(error, c::Error::Ok, "{number}: {structure:?}");
        let handle = memory.as_mut_ptr().cast::<c::Identifier>();
        let mut theta = [0.0_f32; c::ANY_PARAMETERS_MAX];
        let mut y = 0.0;
        for k in 0..200 {
            let u = [if k / 40 % 2 == 0 { 1.0 } else { -1.0 }, draw.number()];
            let u = &u[..usize::from(structure.inputs)];
            y += 0.1 * u[0] + 0.01 * draw.number();
            let _ = native.update(u, y);
            // SAFETY: every pointer is to a value of this function.
            let done = unsafe {
                c::trendid_identifier_update_inputs(handle, u.as_ptr(), u.len(), y, null_mut())
            };
            assert_eq!(done, c::Error::Ok);
        }
        // SAFETY: every pointer is to a value of this function.
        let done = unsafe { c::trendid_identifier_theta(handle, theta.as_mut_ptr(), n) };
        assert_eq!(done, c::Error::Ok);
        let found: Vec<f64> = theta[..n].iter().map(|value| f64::from(*value)).collect();
        assert_eq!(found, native.estimate().theta, "{number}: {structure:?}");
        compared += 1;
    }
    assert!(compared > 100, "only {compared} structures have a place");
}

/// y'' + a1 y' = b0 u.
const GOOD: c::Structure = c::Structure {
    order: 2,
    inputs: 1,
    output_terms: 0b10,
    input_terms: [1, 0],
    constant: 0,
    initial_state: 0,
};

#[test]
fn what_is_no_structure_is_refused_by_name() {
    let refused = |structure: &c::Structure| {
        let mut detail = no_detail();
        let (error, memory) = made(structure, &mut detail);
        assert_eq!(error, detail.error);
        let bytes = memory.as_ptr().cast::<u8>();
        // SAFETY: the memory was zeroed, so every byte of it is initialised.
        let bytes = unsafe { core::slice::from_raw_parts(bytes, size_of::<c::Any>()) };
        assert!(
            bytes.iter().all(|byte| *byte == 0),
            "written in spite of {error:?}"
        );
        let name: Vec<u8> = detail.setting.iter().map(|letter| *letter as u8).collect();
        let end = name.iter().position(|letter| *letter == 0).unwrap();
        (error, String::from_utf8(name[..end].to_vec()).unwrap())
    };
    for order in [0, 5, 255] {
        let found = refused(&c::Structure { order, ..GOOD });
        assert_eq!(found, (c::Error::OutOfRange, "order".into()));
    }
    for inputs in [0, 3] {
        let found = refused(&c::Structure { inputs, ..GOOD });
        assert_eq!(found, (c::Error::OutOfRange, "inputs".into()));
    }
    let found = refused(&c::Structure {
        output_terms: 0b100,
        ..GOOD
    });
    assert_eq!(found.0, c::Error::Term);
    let found = refused(&c::Structure {
        input_terms: [0, 1],
        ..GOOD
    });
    assert_eq!(found.0, c::Error::NoInput);
    assert_eq!(made(&GOOD, &mut no_detail()).0, c::Error::Ok);
}

#[test]
fn memory_that_is_refused_anew_holds_no_object() {
    for bad in [
        c::Structure { order: 9, ..GOOD },
        c::Structure { inputs: 0, ..GOOD },
        c::Structure {
            order: 4,
            output_terms: 0b1111,
            input_terms: [0b1111, 0],
            ..GOOD
        },
        c::Structure {
            output_terms: 0b100,
            ..GOOD
        },
    ] {
        let (error, mut memory) = made(&GOOD, &mut no_detail());
        assert_eq!(error, c::Error::Ok);
        let mut settings = MaybeUninit::uninit();
        let handle = memory.as_mut_ptr().cast::<c::Identifier>();
        // SAFETY: every pointer is to a value of this function.
        let found = unsafe {
            assert_eq!(
                c::trendid_settings_init(settings.as_mut_ptr(), 0.001, 20.0, 1.0, 50.0),
                c::Error::Ok
            );
            let again = c::trendid_any_init(
                memory.as_mut_ptr(),
                settings.as_ptr(),
                &bad,
                null_mut(),
                null_mut(),
            );
            assert_ne!(again, c::Error::Ok);
            c::trendid_identifier_update(handle, 0.0, 0.0, null_mut())
        };
        assert_eq!(found, c::Error::NotInitialised, "{bad:?}");
    }
}
