//! Columns of a matrix, of derivatives or of solutions by a factor: four beside each other in a register where the scalar is one number.

use mbd_scene::Quantity;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::context::EmitContext;
use super::literal::whole;
use crate::lists::{NumberList, ProgramArguments};
use crate::program::Program;
use crate::titles::values_of;

/// The solution by the factor, for as many right-hand sides as there are: four beside each other where the scalar is one number.
pub fn solutions(
    context: &EmitContext,
    (index, reads): (usize, ProgramArguments),
    call: &TokenStream,
) -> TokenStream {
    let layout = &context.equations.layout;
    let (factor, unknowns) = (
        whole(layout.len(Quantity::Factor)),
        whole(layout.len(Quantity::Solve)),
    );
    let t = context.scalar();
    let names = [NumberList::Factored, NumberList::Right].map(|list| {
        let name = format_ident!("{}", list.name());
        match reads.reads(list) {
            true => name,
            false => format_ident!("_{name}"),
        }
    });
    let each = |t: &TokenStream, room: Option<TokenStream>| {
        let [factored, right] = &names;
        quote!(|#factored: &[#t; #factor], #right: &[#t; #unknowns], out: &mut [#t; #unknowns]| { #room #call })
    };
    let alone = each(&quote!(#t), None);
    let lists = [NumberList::Factored, NumberList::Right];
    let alone_reads = reads.0.iter().all(|list| lists.contains(list));
    let solve = match alone_reads && !context.settings.generic {
        true => {
            let room = (!context.is_whole(index)).then(|| quote!(let work = &mut *beside;));
            let beside = each(&quote!(::mbd_runtime::Lanes4), room);
            quote!(solve_beside(at.rows, out, #alone, #beside))
        }
        false => quote!(solve_columns(at.rows, out, #alone)),
    };
    quote!(::mbd_runtime::Quantity::Solve => ::mbd_runtime::__private::#solve,)
}

/// A matrix column by column: four beside each other where the scalar is one number. `values`: which of [`SceneEquations::values`] it is, and the lists
/// that this reads.
///
/// [`SceneEquations::values`]: crate::equations::SceneEquations::values
pub fn by_column(
    context: &EmitContext,
    (index, program): (usize, &Program),
    (values, passed): (usize, &[TokenStream]),
    name: &str,
) -> TokenStream {
    let equations = context.equations;
    let Some(matrix) = &program.by_column else {
        return TokenStream::new();
    };
    let (count, known) = (whole(matrix.columns.len()), whole(matrix.values));
    let columns = matrix.columns.iter().map(|&column| whole(column));
    let columns = quote!(&[#(#columns),*]);
    let width = whole(matrix.width);
    let rows = whole(program.len);
    let work = Some(quote!(work));
    let function = format_ident!("{}", values_of(name));
    let before = context.call(
        equations.first_of_values() + values,
        &function,
        passed,
        work,
        &quote!(values),
    );
    let function = format_ident!("{name}");
    let column = if context.is_whole(index) {
        let reads = ProgramArguments::of(program, &equations.layout);
        let lists = reads.0.iter().map(|list| format_ident!("{}", list.name()));
        quote! {
            if let (::core::option::Option::Some(direction), ::core::option::Option::Some(values)) = (
                ::mbd_runtime::__private::window(work, 0),
                ::mbd_runtime::__private::window(work, #count),
            ) {
                let (direction, values): (&[_; #count], &[_; #known]) = (direction, values);
                #function(#(#lists,)* out);
            }
        }
    } else {
        quote!(let _ = #function(work, out);)
    };
    let t = context.scalar();
    let each = |t: &TokenStream| quote!(|work: &mut [#t], out: &mut [#t; #rows]| { #column });
    let alone = each(&t);
    let before = quote!(|values: &mut [#t; #known], work: &mut [#t]| { #before });
    match context.settings.generic {
        true => {
            quote!(::mbd_runtime::__private::columns::<_, #count, #known, #rows>(work, (#columns, #width), out, #before, #alone);)
        }
        false => {
            let beside = each(&quote!(::mbd_runtime::Lanes4));
            quote!(::mbd_runtime::__private::columns_beside::<#count, #known, #rows>((work, beside), (#columns, #width), out, #before, #beside);)
        }
    }
}
