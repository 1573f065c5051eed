//! Functions that the layer does not know: they can be asked for, as ash and the loader do with all there are, but not called.

use std::ffi::{CStr, c_void};
use std::sync::{Mutex, PoisonError};

use ash::vk;

use crate::state;

/// A function that takes anything and never returns.
type Trap = extern "system" fn();

/// The functions that were asked for, by the number of their trap.
static NAMES: Mutex<Vec<String>> = Mutex::new(Vec::new());

extern "system" fn trap<const NUMBER: usize>() {
    let names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    let name = &names[NUMBER];
    state::with(|state| state.unknown(name));
    eprintln!("failing_driver: {name} is called, which this layer does not know");
    std::process::abort();
}

macro_rules! sixteen {
    ($make:ident, $from:expr, $step:expr) => {
        [
            $make!($from),
            $make!($from + $step),
            $make!($from + 2 * $step),
            $make!($from + 3 * $step),
            $make!($from + 4 * $step),
            $make!($from + 5 * $step),
            $make!($from + 6 * $step),
            $make!($from + 7 * $step),
            $make!($from + 8 * $step),
            $make!($from + 9 * $step),
            $make!($from + 10 * $step),
            $make!($from + 11 * $step),
            $make!($from + 12 * $step),
            $make!($from + 13 * $step),
            $make!($from + 14 * $step),
            $make!($from + 15 * $step),
        ]
    };
}

macro_rules! one {
    ($number:expr) => {
        trap::<{ $number }> as Trap
    };
}

macro_rules! row {
    ($from:expr) => {
        sixteen!(one, $from, 1)
    };
}

/// More than there are functions in Vulkan.
static TRAPS: [[[Trap; 16]; 16]; 4] = [
    sixteen!(row, 0, 16),
    sixteen!(row, 256, 16),
    sixteen!(row, 512, 16),
    sixteen!(row, 768, 16),
];

/// A trap that knows its name.
pub fn function(name: &CStr) -> vk::PFN_vkVoidFunction {
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    let name = name.to_string_lossy();
    let known = names.iter().position(|known| *known == name);
    let number = known.unwrap_or_else(|| {
        names.push(name.into_owned());
        names.len() - 1
    });
    let trap = TRAPS[number / 256][number / 16 % 16][number % 16] as *const c_void;
    // SAFETY: a function pointer to a function pointer. Called with whatever arguments, it looks at none and does not return.
    unsafe { std::mem::transmute::<*const c_void, vk::PFN_vkVoidFunction>(trap) }
}
