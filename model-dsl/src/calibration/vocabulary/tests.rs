//! The laws of the table. In: its entries. Out: what holds for all of them.

use super::*;
