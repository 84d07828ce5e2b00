//! Compensation tables of controllers. In: a calibrated machine. Out: files in the controller's own form, and what of the model
//! they cannot carry.
