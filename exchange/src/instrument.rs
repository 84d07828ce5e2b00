//! Measurements as instruments write them. In: the text of a file. Out: runs of readings over targets, in mm and rad.
