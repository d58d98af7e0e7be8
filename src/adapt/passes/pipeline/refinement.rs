//! Refinement: long edges are split, or points are created in another way, as long as the mesh may grow.
use super::{OUT_OF_ORDER, Pipeline};
use crate::adapt::core::edge_list;
use crate::adapt::core::edge_list::{EdgeItem, Wanted};
use crate::adapt::operations::insertion::centroid::InsertCentroids;
use crate::adapt::operations::insertion::centroid::{self, PointCreation};
use crate::adapt::operations::insertion::edge_split::Split;
use crate::adapt::operations::insertion::metric_orthogonal;
use crate::adapt::operations::insertion::metric_orthogonal::InsertMetricOrthogonal;
use crate::adapt::schedule::work::Kind;

impl Pipeline<'_, '_> {
    /// Splits long edges, or refines in another way, and reconnects.
    pub(super) fn refine(&mut self) {
        if !self.may_grow() {
            return;
        }
        let refined = match self.points {
            PointCreation::Edge => false,
            PointCreation::Centroid => self.create(),
            PointCreation::Eigenvector => self.extend(),
        };
        if refined {
            return;
        }
        self.split();
        self.split_deviating();
        self.reconnect(self.criterion, 1);
    }

    /// Splits long edges, and projects the new vertices that are not on the model yet.
    pub(super) fn split(&mut self) {
        if !self.may_grow() {
            return;
        }
        self.keep_order(OUT_OF_ORDER);
        let mut items = self.long_edges();
        self.no_more_than_allowed(&mut items);
        if !self.observer.stop() && self.sweep(Kind::Split, &Split, &items).done > 0 {
            self.project();
        }
    }

    /// Refines at centroids. Returns whether that changed much; then edges need not be split yet.
    fn create(&mut self) -> bool {
        if self.observer.stop() {
            return false;
        }
        let mut items = centroid::active_tets(self.team(), self.context);
        self.no_more_than_allowed(&mut items);
        let done = self.sweep(Kind::Split, &InsertCentroids, &items).done;
        self.project();
        self.reconnect(self.criterion, 1);
        !self.is_little(done)
    }

    /// Splits edges so long that a point at unit distance from one end would leave bad tetrahedra, and all long edges on the model. Then
    /// creates points along eigenvectors. Returns whether that changed much; then no other edges need be split yet.
    fn extend(&mut self) -> bool {
        let long = self.context.limits.long;
        self.context.limits.long = metric_orthogonal::FAR * long;
        self.split();
        self.context.limits.long = long;
        self.looked[Kind::Split as usize] = 0;
        let mut items = self.long_edges();
        let store = &self.context.store;
        items.retain(|edge| store.dimension(edge.a).max(store.dimension(edge.b)) < 3);
        self.no_more_than_allowed(&mut items);
        if !self.observer.stop() && self.sweep(Kind::Split, &Split, &items).done > 0 {
            self.project();
        }
        self.looked[Kind::Split as usize] = 0;
        self.reconnect(self.criterion, 1);
        if self.observer.stop() {
            return false;
        }
        let mut items = metric_orthogonal::active_vertices(self.team(), self.context);
        self.no_more_than_allowed(&mut items);
        let done = self.sweep(Kind::Split, &InsertMetricOrthogonal, &items).done;
        self.reconnect(self.criterion, 1);
        !self.is_little(done)
    }

    /// Edges to be split: first those on edges of the model, then those on its faces, then those inside; each time the longest first.
    fn long_edges(&mut self) -> Vec<EdgeItem> {
        let since = self.begin(Kind::Split);
        let (store, limit) = (&self.context.store, self.context.limits.long);
        let found = edge_list::listed(self.team(), store, since, Wanted::Longer(limit));
        let dimension = |item: &EdgeItem| store.dimension(item.a).max(store.dimension(item.b));
        edge_list::in_order(self.team(), &found, |edge| {
            (dimension(&edge.item) + 1) * edge_list::CLASSES - 1 - u32::from(edge.class)
        })
    }
}
