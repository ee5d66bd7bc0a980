// Counts work where that is asked for: reads of shadow maps and leaves, and of nodes of trees. Elsewhere these functions are
// empty and there is no buffer: it would be one more than the eight that every device binds.

@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>, 2>;
var<private> reads_here: u32;
var<private> nodes_here: u32;

fn count_reads(n: u32) {
    reads_here += n;
}

fn count_nodes(n: u32) {
    nodes_here += n;
}

fn report_counts() {
    atomicAdd(&counts[0], reads_here);
    atomicAdd(&counts[1], nodes_here);
}
