//! Where the ends of a table may lie.

use super::*;

#[test]
fn a_table_ends_at_nodes_at_which_something_is_fitted() {
    let nodes = [0.0, 10.0, 20.0, 30.0, 50.0];
    let cut = |places: &[f64]| within(nodes.to_vec(), places);
    assert_eq!(cut(&[0.0, 12.0, 50.0]), nodes);
    assert_eq!(cut(&[5.0, 12.0, 40.0]), nodes, "half of the way to the next node");
    assert_eq!(cut(&[6.0, 39.0]), nodes[1..4], "nearer to the next nodes");
    assert_eq!(cut(&[18.0, 22.0]), [20.0], "in the middle alone");
    assert_eq!(cut(&[]).len(), 1);
}
