//! What the functions of a model compute with: any scalar, or `f64` where nothing else calls them. A known number is a literal there, and rustc builds an
//! operation of numbers it knows in a little less time than a call of a trait.

use mbd_scene::Quantity;
use proc_macro2::TokenStream;
use quote::quote;

use super::context::EmitContext;
use super::literal::number_text;

/// What a function computes with.
#[derive(Clone, Copy)]
pub enum Scalar {
    /// Any scalar, `T`.
    Any,
    /// `f64`, of which `T` is another name there.
    Double,
}

impl Scalar {
    /// The generics of the function.
    pub fn generics(self) -> &'static str {
        match self {
            Scalar::Any => "<T: ::mbd_runtime::Real>",
            Scalar::Double => "",
        }
    }

    /// A known number.
    pub fn number(self, value: f64) -> String {
        let number = number_text(value);
        match self {
            Scalar::Any => format!("T::from_f64({number})"),
            Scalar::Double => number,
        }
    }
}

/// What each function of a model computes with.
pub struct Scalars {
    model: Scalar,
    programs: Vec<Scalar>,
    kernels: Vec<Scalar>,
}

impl Scalars {
    /// Those of a model over any scalar are over any; of another only those whose columns stand beside each other in a register, and the kernels they call.
    pub fn of(context: &EmitContext) -> Self {
        let model = match context.settings.generic {
            true => Scalar::Any,
            false => Scalar::Double,
        };
        let programs: Vec<Scalar> = context
            .equations
            .every_program()
            .map(|program| {
                let beside = program.by_column.is_some() || program.what == Some(Quantity::Solve);
                if beside { Scalar::Any } else { model }
            })
            .collect();
        let mut kernels = vec![model; context.kernels.kernels.len()];
        for (driver, scalar) in context.kernels.drivers.iter().zip(&programs) {
            let runs = driver.iter().flat_map(|driver| &driver.calls);
            for item in runs.flat_map(|run| &run.items) {
                if let (Scalar::Any, Some(own)) = (scalar, kernels.get_mut(item.key)) {
                    *own = Scalar::Any;
                }
            }
        }
        Scalars {
            model,
            programs,
            kernels,
        }
    }

    /// That of what the functions of several quantities call.
    pub fn of_model(&self) -> Scalar {
        self.model
    }

    /// That of the function of a program.
    pub fn of_program(&self, index: usize) -> Scalar {
        self.programs.get(index).copied().unwrap_or(Scalar::Any)
    }

    /// That of a kernel.
    pub fn of_kernel(&self, index: usize) -> Scalar {
        self.kernels.get(index).copied().unwrap_or(Scalar::Any)
    }

    /// What `T` is where a function is not over any scalar.
    pub fn alias(&self) -> Option<TokenStream> {
        match self.model {
            Scalar::Any => None,
            Scalar::Double => Some(quote! {
                use ::mbd_runtime::Real as _;
                type T = f64;
            }),
        }
    }
}
