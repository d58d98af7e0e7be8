//! Chains of mesh edges between corners.

/// A run of mesh edges without a branch or corner inside.
pub(crate) struct Chain {
    /// Mesh vertices along the chain; a closed chain repeats its first at the end.
    pub vertices: Vec<u32>,
    /// For each step the index of its edge in the list given to [`trace_chains`].
    pub edges: Vec<u32>,
}

impl Chain {
    /// Whether the chain ends where it began.
    pub fn is_closed(&self) -> bool {
        self.vertices.first() == self.vertices.last()
    }
}

/// Joins edges to chains. Vertices with `corner` end a chain; every vertex where not exactly two edges meet
/// must be one. Closed chains without a corner start at their first edge.
pub(crate) fn trace_chains(edges: &[[u32; 2]], corner: impl Fn(u32) -> bool) -> Vec<Chain> {
    let at = Incidence::new(edges);
    let mut used = vec![false; edges.len()];
    let mut chains = Vec::new();
    let from_corners = (0..edges.len()).flat_map(|e| [(e, 0), (e, 1)]).filter(|&(e, end)| corner(edges[e][end]));
    let closed = (0..edges.len()).map(|e| (e, 0));
    for (first, end) in from_corners.chain(closed) {
        if used[first] {
            continue;
        }
        let start = edges[first][end];
        let mut chain = Chain { vertices: vec![start], edges: Vec::new() };
        let (mut edge, mut vertex) = (first, start);
        loop {
            used[edge] = true;
            vertex ^= edges[edge][0] ^ edges[edge][1];
            chain.vertices.push(vertex);
            chain.edges.push(edge as u32);
            if corner(vertex) {
                break;
            }
            let Some(next) = at.edges(vertex).find(|&e| !used[e]) else { break };
            edge = next;
        }
        chains.push(chain);
    }
    chains
}

/// Edges at each vertex, by binary search in a sorted list: chains are few among the vertices of a mesh.
struct Incidence(Vec<(u32, u32)>);

impl Incidence {
    fn new(edges: &[[u32; 2]]) -> Self {
        let mut pairs: Vec<(u32, u32)> =
            edges.iter().enumerate().flat_map(|(e, nodes)| nodes.map(|v| (v, e as u32))).collect();
        pairs.sort_unstable();
        Self(pairs)
    }

    fn edges(&self, vertex: u32) -> impl Iterator<Item = usize> + '_ {
        let first = self.0.partition_point(|pair| pair.0 < vertex);
        self.0[first..].iter().take_while(move |pair| pair.0 == vertex).map(|pair| pair.1 as usize)
    }
}
