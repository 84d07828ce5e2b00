//! Which tables of a calibration lie side by side.
//!
//! In: the terms of all error motions. Out: for each axis and each way its nodes lie, the tables there as one constant, and what
//! reads them. It exists because tables with the same nodes are read together for little more than what one of them costs.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::calibration::WrittenMotion;
use crate::calibration::{CalibratedTerm, CurveNodes};
use crate::equations::Equations;

/// Even nodes of a table as they are told apart: bits of start and step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct EvenNodes {
    axis: usize,
    start: u64,
    step: u64,
    count: usize,
    repeats: bool,
}

impl EvenNodes {
    /// Those of a term; none where it is no such table.
    pub(super) fn of(term: &CalibratedTerm) -> Option<Self> {
        let CalibratedTerm::Table { axis, curve } = term else { return None };
        let CurveNodes::Uniform { start, step } = curve.nodes else { return None };
        let count = curve.values.forward().len();
        let (start, step) = (start.to_bits(), step.to_bits());
        Some(Self { axis: *axis, start, step, count, repeats: curve.repeats })
    }
}

/// Tables over the same even nodes of one axis.
struct Bundle<'m> {
    name: Ident,
    nodes: EvenNodes,
    /// Each with its error motion, and its place there.
    tables: Vec<(&'m WrittenMotion, usize)>,
}

/// All tables with even nodes.
pub(super) struct Bundles<'m>(Vec<Bundle<'m>>);

impl<'m> Bundles<'m> {
    pub(super) fn new(equations: &Equations, motions: &'m [WrittenMotion]) -> Self {
        let mut bundles: Vec<Bundle<'m>> = Vec::new();
        for motion in motions {
            for (place, nodes) in motion.even_tables() {
                match bundles.iter_mut().find(|bundle| bundle.nodes == nodes) {
                    Some(bundle) => bundle.tables.push((motion, place)),
                    None => {
                        let name = name(equations, nodes.axis, &bundles);
                        bundles.push(Bundle { name, nodes, tables: vec![(motion, place)] });
                    }
                }
            }
        }
        Self(bundles)
    }

    /// A constant for each.
    pub(super) fn items(&self) -> TokenStream {
        self.0.iter().map(Bundle::item).collect()
    }

    /// What names the values of the tables of some motions, all that lie beside one of them being read.
    pub(super) fn unpacked(&self, read: impl Fn(&WrittenMotion) -> bool) -> TokenStream {
        let needed = self.0.iter().filter(|bundle| bundle.tables.iter().any(|(motion, _)| read(motion)));
        needed.map(|bundle| bundle.unpacked(&read)).collect()
    }
}

impl Bundle<'_> {
    fn item(&self) -> TokenStream {
        let Self { name, nodes, tables } = self;
        let names: Vec<_> = tables.iter().map(|(motion, _)| motion.name.to_string()).collect();
        let about = format!(" The tables of {}, side by side, as they are read.", names.join(", "));
        let [curves, rows] = [tables.len(), nodes.count].map(Literal::usize_unsuffixed);
        let terms = tables.iter().map(|(motion, place)| {
            let (name, place) = (&motion.name, Literal::usize_unsuffixed(*place));
            quote! { &Self::#name[#place] }
        });
        quote! {
            #[doc = #about]
            const #name: ::abbe_runtime::Bundle<#curves, #rows> = match ::abbe_runtime::Bundle::new([#(#terms),*]) {
                Ok(bundle) => bundle,
                Err(_) => panic!("tables that are not side by side"),
            };
        }
    }

    fn unpacked(&self, read: impl Fn(&WrittenMotion) -> bool) -> TokenStream {
        let name = &self.name;
        let values = self.tables.iter().map(|(motion, place)| match read(motion) {
            true => motion.term_name(*place),
            false => format_ident!("_"),
        });
        quote! { let [#(#values),*] = from.bundle(&Self::#name)?; }
    }
}

/// The name of the next bundle over an axis.
fn name(equations: &Equations, axis: usize, before: &[Bundle<'_>]) -> Ident {
    let letter = equations.axes.get(axis).map_or("", |axis| &axis.letter).to_ascii_uppercase();
    match before.iter().filter(|bundle| bundle.nodes.axis == axis).count() {
        0 => format_ident!("TABLES_OVER_{letter}"),
        others => format_ident!("TABLES_OVER_{letter}_{}", others.saturating_add(1)),
    }
}
